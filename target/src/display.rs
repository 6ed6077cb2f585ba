//! Conversions for what a person reads. Nothing here ever feeds the state.
//!
//! This is the place of `micromath`: a few instructions per function for an error that no reader of a log can
//! see, because levels are shown in whole decibels. Its functions are called by their full names: on a host the
//! standard library's exact ones would quietly stand in for them.

/// What counts as zero \[1\]: the smallest level is −200 dB.
const ZERO: f32 = 1e-10;

/// Largest error of [`level_db`] \[dB\].
pub const LEVEL_ERROR_DB: f32 = 1.1;

/// Returns `ratio` as a level \[dB\], 20·log₁₀, within [`LEVEL_ERROR_DB`]; −200 dB for anything not above 1e-10.
pub fn level_db(ratio: f32) -> f32 {
    if ratio > ZERO { 20.0 * micromath::F32Ext::log10(ratio) } else { -200.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_within_its_documented_error() {
        let mut worst = 0.0_f64;
        for step in 0..400_000 {
            let ratio = 10_f64.powf(-9.999 + f64::from(step) * 13e-3 / 400.0) as f32;
            let exact = 20.0 * f64::from(ratio).log10();
            worst = worst.max((f64::from(level_db(ratio)) - exact).abs());
        }
        println!("level: largest error {worst:.4} dB");
        assert!(worst < f64::from(LEVEL_ERROR_DB), "{worst} dB");
        assert!(worst > 1e-6, "an exact logarithm stood in for micromath's");
    }

    #[test]
    fn nothing_is_minus_two_hundred() {
        for ratio in [0.0, -1.0, f32::NAN] {
            assert!((level_db(ratio) + 200.0).abs() < 1e-3);
        }
    }
}
