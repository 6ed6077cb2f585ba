//! Points, rectangles and texts of a drawing, in whole pixels.

/// Distance between two wires, and what every coordinate of a wire is a multiple of [px].
pub const GRID: i32 = 10;

/// A point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct At {
    /// To the right [px].
    pub x: i32,
    /// Downwards [px].
    pub y: i32,
}

/// A rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Left edge [px].
    pub x: i32,
    /// Upper edge [px].
    pub y: i32,
    /// Width [px].
    pub width: i32,
    /// Height [px].
    pub height: i32,
}

impl Rect {
    /// Right edge [px].
    pub fn right(&self) -> i32 {
        self.x + self.width
    }

    /// Lower edge [px].
    pub fn bottom(&self) -> i32 {
        self.y + self.height
    }

    /// Whether both share some area; a common edge is none.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right() && other.x < self.right() && self.y < other.bottom() && other.y < self.bottom()
    }

    /// Whether `other` lies inside, edges included.
    pub fn holds(&self, other: &Self) -> bool {
        self.x <= other.x
            && self.y <= other.y
            && other.right() <= self.right()
            && other.bottom() <= self.bottom()
    }

    /// Whether a horizontal or vertical stretch runs through the inside.
    pub fn is_cut_by(&self, a: At, b: At) -> bool {
        let (left, right) = (a.x.min(b.x), a.x.max(b.x));
        let (top, bottom) = (a.y.min(b.y), a.y.max(b.y));
        left < self.right() && self.x < right.max(left + 1) && top < self.bottom() && self.y < bottom.max(top + 1)
            // A stretch on an edge touches only.
            && !(left == right && (left <= self.x || left >= self.right()))
            && !(top == bottom && (top <= self.y || top >= self.bottom()))
    }
}

/// Where a text hangs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hang {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// A text with the room that is kept for it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// What is shown.
    pub text: String,
    /// Point on its base line.
    pub at: At,
    /// Where it hangs.
    pub hang: Hang,
    /// Height of the type [px].
    pub px: i32,
    /// Room for the longest text that may stand there [px].
    pub room: i32,
}

impl Label {
    /// The room that is kept.
    pub fn rect(&self) -> Rect {
        let x = match self.hang {
            Hang::Start => self.at.x,
            Hang::Middle => self.at.x - self.room / 2,
            Hang::End => self.at.x - self.room,
        };
        // Letters rise by 0.8 of their height above the base line and hang by 0.25 below it.
        let rise = (self.px * 4 + 4) / 5;
        Rect { x, y: self.at.y - rise, width: self.room, height: rise + (self.px + 3) / 4 }
    }
}

/// Width of `text` at `px` [px], estimated wide: a drawing is laid out without looking at any installed font.
pub fn text_width(text: &str, px: i32) -> i32 {
    let length = i32::try_from(text.chars().count()).unwrap_or(i32::MAX / 64);
    (length * px * 62 + 99) / 100
}

/// Shortens `text` to what fits into `room` at `px`.
pub fn fit(text: &str, px: i32, room: i32) -> String {
    if text_width(text, px) <= room {
        return text.to_owned();
    }
    let mut short: String = text.to_owned();
    while short.pop().is_some() {
        let shown = format!("{short}…");
        if text_width(&shown, px) <= room {
            return shown;
        }
    }
    String::new()
}

/// The next multiple of the grid that is not smaller.
pub fn up(length: i32) -> i32 {
    (length + GRID - 1).div_euclid(GRID) * GRID
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_touch_and_insides_overlap() {
        let one = Rect { x: 0, y: 0, width: 10, height: 10 };
        assert!(!one.overlaps(&Rect { x: 10, ..one }) && one.overlaps(&Rect { x: 9, ..one }));
        let at = |x, y| At { x, y };
        assert!(one.is_cut_by(at(5, -5), at(5, 20)) && one.is_cut_by(at(-5, 3), at(3, 3)));
        assert!(!one.is_cut_by(at(0, -5), at(0, 20)) && !one.is_cut_by(at(-5, 5), at(0, 5)));
        assert!(!one.is_cut_by(at(11, 0), at(11, 9)) && !one.is_cut_by(at(-9, 10), at(20, 10)));
    }

    #[test]
    fn what_is_too_long_is_cut_with_a_mark() {
        assert_eq!(fit("valve", 10, 40), "valve");
        let short = fit("a_very_long_name", 10, 40);
        assert!(short.ends_with('…') && text_width(&short, 10) <= 40, "{short}");
        assert_eq!(fit("abc", 10, 3), "");
    }
}
