//! A monotone curve through points: two make a straight line, more a calibration table.

use crate::Fingerprint;
use crate::parameter::{ParameterError, Reason};

/// Straight lines from point to point, going on beyond the outer ones. No point at all stands for y = x.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Curve<'a> {
    /// Pairs (x, y); x rises, y rises or falls strictly.
    pub points: &'a [[f32; 2]],
}

impl Curve<'_> {
    /// y = x.
    pub const IDENTITY: Self = Curve { points: &[] };

    /// Checks that the curve can be followed in both directions.
    pub fn check(&self, parameter: &'static str) -> Result<(), ParameterError> {
        let error = |reason| Err(ParameterError { parameter, reason });
        if self.points.iter().flatten().any(|value| !value.is_finite()) {
            return error(Reason::NotFinite);
        }
        if self.points.len() == 1 {
            return error(Reason::OutsideValidity);
        }
        let rising = matches!(self.points, [[_, first], [_, second], ..] if second > first);
        let follows = |pair: &[[f32; 2]]| {
            let [[x0, y0], [x1, y1]] = pair else { return false };
            let finite = ((y1 - y0) / (x1 - x0)).is_finite() && ((x1 - x0) / (y1 - y0)).is_finite();
            x1 > x0 && finite && if rising { y1 > y0 } else { y1 < y0 }
        };
        if self.points.windows(2).all(follows) { Ok(()) } else { error(Reason::OutsideValidity) }
    }

    /// Returns y at `x`.
    pub fn forward(&self, x: f32) -> f32 {
        self.follow(x, |[x, y]| (x, y), true)
    }

    /// Returns x at `y`.
    pub fn backward(&self, y: f32) -> f32 {
        let rising = matches!(self.points, [[_, first], [_, second], ..] if second > first);
        self.follow(y, |[x, y]| (y, x), rising)
    }

    /// The value on the straight line of the interval that holds `at`, or of the outer one beyond it.
    fn follow(&self, at: f32, axes: fn([f32; 2]) -> (f32, f32), rising: bool) -> f32 {
        let mut result = at;
        // Every interval up to the one that holds `at` is a better answer than the one before.
        for (index, pair) in self.points.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let ((x0, y0), (x1, y1)) = (axes(*from), axes(*to));
            let reached = if rising { at >= x0 } else { at <= x0 };
            if index == 0 || reached {
                // Measured from the nearer end, so that both ends are met exactly.
                let slope = (y1 - y0) / (x1 - x0);
                result = if (at - x0).abs() <= (x1 - at).abs() {
                    y0 + (at - x0) * slope
                } else {
                    y1 - (x1 - at) * slope
                };
            }
        }
        result
    }

    pub(super) fn feed(&self, hash: &mut Fingerprint) {
        hash.word(self.points.len() as u32);
        for point in self.points {
            hash.values(point);
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that must come through unchanged")]
mod tests {
    use super::*;

    const LOOP_MA: Curve<'_> = Curve { points: &[[4.0, 0.0], [20.0, 0.1]] };
    const FALLING: Curve<'_> = Curve { points: &[[0.0, 10.0], [1.0, 8.0], [2.0, -3.0], [5.0, -4.0]] };

    #[test]
    fn ends_are_met_exactly_and_lines_go_on() {
        for curve in [LOOP_MA, FALLING] {
            for [x, y] in curve.points {
                assert_eq!((curve.forward(*x), curve.backward(*y)), (*y, *x));
            }
        }
        assert!((LOOP_MA.forward(12.0) - 0.05).abs() < 1e-8);
        assert!((LOOP_MA.forward(0.0) + 0.025).abs() < 1e-8, "below the first point");
        assert!((FALLING.forward(8.0) + 5.0).abs() < 1e-6, "beyond the last");
        assert_eq!(Curve::IDENTITY.forward(7.5), 7.5);
    }

    #[test]
    fn backward_undoes_forward() {
        for curve in [LOOP_MA, FALLING, Curve::IDENTITY] {
            for step in -40..80 {
                let x = 0.1 * step as f32;
                let back = curve.backward(curve.forward(x));
                assert!((back - x).abs() < 1e-5, "{x} came back as {back}");
            }
        }
    }

    #[test]
    fn a_curve_that_cannot_be_followed_is_refused() {
        let refused: [&[[f32; 2]]; 5] = [
            &[[1.0, 1.0]],
            &[[0.0, 0.0], [0.0, 1.0]],
            &[[0.0, 0.0], [1.0, 0.0]],
            &[[0.0, 0.0], [1.0, 1.0], [2.0, 0.5]],
            &[[0.0, f32::NAN], [1.0, 1.0]],
        ];
        for points in refused {
            assert!(Curve { points }.check("curve").is_err(), "{points:?}");
        }
        for curve in [LOOP_MA, FALLING, Curve::IDENTITY] {
            assert_eq!(curve.check("curve"), Ok(()));
        }
    }
}
