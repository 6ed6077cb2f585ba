//! One look for all plots: colours that colour-blind readers can tell apart, sizes, fonts.
//!
//! Colours: M. Okabe and K. Ito, "Color Universal Design", 2008. Curves differ in dash as well as in colour.

use plotters::style::RGBColor;

/// A colour.
pub type Colour = RGBColor;

/// Text, axes.
pub const INK: Colour = RGBColor(38, 38, 38);
/// Tick labels, subtitles.
pub const FAINT_INK: Colour = RGBColor(96, 96, 96);
/// Grid lines.
pub const GRID: Colour = RGBColor(228, 228, 228);
/// Background.
pub const PAPER: Colour = RGBColor(255, 255, 255);
/// The product's own curve.
pub const BLUE: Colour = RGBColor(0, 114, 178);
/// What it is compared with.
pub const VERMILION: Colour = RGBColor(213, 94, 0);
/// Third curve.
pub const GREEN: Colour = RGBColor(0, 158, 115);
/// Fourth curve.
pub const ORANGE: Colour = RGBColor(230, 159, 0);
/// Fifth curve.
pub const PURPLE: Colour = RGBColor(204, 121, 167);
/// Sixth curve.
pub const SKY: Colour = RGBColor(86, 180, 233);
/// Reference curves and limits.
pub const BLACK: Colour = RGBColor(0, 0, 0);

/// Curves without a colour of their own take these in turn.
pub const CYCLE: [Colour; 7] = [BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK];

/// Font family; the reader's own sans-serif.
pub const FONT: &str = "sans-serif";
/// Figure title [px].
pub const TITLE_PX: i32 = 20;
/// Panel titles [px].
pub const PANEL_PX: i32 = 15;
/// Axis labels and legends [px].
pub const LABEL_PX: i32 = 14;
/// Tick labels and notes [px].
pub const TICK_PX: i32 = 13;

/// Colours from dark blue to yellow for `part` in 0…1, evenly spaced for the eye (samples of viridis).
pub fn scale(part: f64) -> Colour {
    const STOPS: [(f64, f64, f64); 6] = [
        (68.0, 1.0, 84.0),
        (65.0, 68.0, 135.0),
        (42.0, 120.0, 142.0),
        (34.0, 168.0, 132.0),
        (122.0, 209.0, 81.0),
        (240.0, 220.0, 30.0),
    ];
    let place = part.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let index = (place as usize).min(STOPS.len() - 2);
    let between = place - index as f64;
    let (low, high) = (STOPS[index], STOPS[index + 1]);
    let mix = |a: f64, b: f64| (a + (b - a) * between).round() as u8;
    RGBColor(mix(low.0, high.0), mix(low.1, high.1), mix(low.2, high.2))
}

/// Width of `text` at `px` [px], estimated: plots are laid out without looking at any installed font.
pub fn text_width(text: &str, px: i32) -> i32 {
    (text.chars().count() as f64 * f64::from(px) * 0.56).ceil() as i32
}
