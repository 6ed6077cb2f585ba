//! Cuts curves at the edge of a panel and thins them to what a picture can show.

/// A point in data units.
pub type Point = (f64, f64);

/// A panel's range in data units: x from, x to, y from, y to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Left edge.
    pub left: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
    /// Upper edge.
    pub top: f64,
}

impl Window {
    /// Whether a point lies inside or on the edge.
    pub(super) fn holds(&self, (x, y): Point) -> bool {
        (self.left..=self.right).contains(&x) && (self.bottom..=self.top).contains(&y)
    }

    /// The part of the straight line from `a` to `b` inside (Liang and Barsky).
    fn part(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        let edges =
            [(-dx, a.0 - self.left), (dx, self.right - a.0), (-dy, a.1 - self.bottom), (dy, self.top - a.1)];
        for (direction, distance) in edges {
            if direction == 0.0 {
                if distance < 0.0 {
                    return None;
                }
            } else if direction < 0.0 {
                enter = enter.max(distance / direction);
            } else {
                leave = leave.min(distance / direction);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (enter <= leave).then(|| (at(enter), at(leave)))
    }

    /// The pieces of a curve that lie inside. Points that are not finite interrupt it.
    pub(super) fn clip(&self, curve: &[Point]) -> Vec<Vec<Point>> {
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        let mut open = false;
        for pair in curve.windows(2) {
            let &[a, b] = pair else { continue };
            let finite = [a.0, a.1, b.0, b.1].iter().all(|value| value.is_finite());
            let Some((from, to)) = finite.then(|| self.part(a, b)).flatten() else {
                open = false;
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if open && from == a => piece.push(to),
                _ => pieces.push(vec![from, to]),
            }
            open = to == b;
        }
        pieces
    }
}

/// Keeps first, lowest, highest and last point of each of `buckets` parts of a curve that runs in x.
pub fn thin(curve: &[Point], buckets: usize) -> Vec<Point> {
    let size = curve.len() / buckets.max(1);
    if size <= 4 {
        return curve.to_vec();
    }
    let mut kept = Vec::with_capacity(4 * buckets);
    for bucket in curve.chunks(size) {
        let order = |a: &usize, b: &usize| bucket[*a].1.total_cmp(&bucket[*b].1);
        let low = (0..bucket.len()).min_by(order).unwrap_or(0);
        let high = (0..bucket.len()).max_by(order).unwrap_or(0);
        let mut places = [0, low, high, bucket.len() - 1];
        places.sort_unstable();
        let mut last = None;
        for place in places {
            if last != Some(place) {
                kept.push(bucket[place]);
            }
            last = Some(place);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Window = Window { left: 0.0, right: 1.0, bottom: 0.0, top: 1.0 };

    #[test]
    fn a_curve_is_cut_exactly_at_the_edge() {
        let pieces = UNIT.clip(&[(0.0, 0.5), (0.5, 0.5), (0.5, 2.5), (1.0, 0.5)]);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0], [(0.0, 0.5), (0.5, 0.5), (0.5, 1.0)]);
        assert!((pieces[1][0].1 - 1.0).abs() < 1e-12 && pieces[1][1] == (1.0, 0.5));
    }

    #[test]
    fn what_is_not_finite_interrupts() {
        let pieces = UNIT.clip(&[(0.0, 0.5), (0.2, 0.5), (0.4, f64::NAN), (0.6, 0.5), (0.8, 0.5)]);
        assert_eq!(pieces, [vec![(0.0, 0.5), (0.2, 0.5)], vec![(0.6, 0.5), (0.8, 0.5)]]);
    }

    #[test]
    fn thinning_keeps_the_extremes() {
        let curve: Vec<Point> =
            (0..10_000).map(|k| (f64::from(k), if k == 4_321 { 9.0 } else { 0.0 })).collect();
        let thinned = thin(&curve, 100);
        assert!(thinned.len() <= 404 && thinned.contains(&(4_321.0, 9.0)));
        assert_eq!(thinned.last(), curve.last());
    }
}
