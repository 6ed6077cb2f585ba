//! A value that moves by small steps, none of which is lost in rounding.
//!
//! A rate of 0.001 K/s is 1e-6 K in a tick of a millisecond, and the last digit of 290 K is 3e-5 K: added to the plain
//! value it would never get anywhere. What a sum could not hold is carried to the next one (W. Kahan, "Further remarks
//! on reducing truncation errors", 1965).

/// A value and what rounding has kept from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mover {
    value: f32,
    carry: f32,
}

impl Mover {
    /// At `value`.
    pub(super) const fn at(value: f32) -> Self {
        Self { value, carry: 0.0 }
    }

    /// Where it is.
    pub(super) fn value(self) -> f32 {
        self.value
    }

    /// Adds a step, small beside the value or not.
    pub(super) fn add(&mut self, step: f32) {
        let step = step + self.carry;
        let next = self.value + step;
        self.carry = step - (next - self.value);
        self.value = next;
    }

    /// Moves towards `to` by at most `most` (≥ 0, may be infinite); returns whether it is there.
    pub(super) fn towards(&mut self, to: f32, most: f32) -> bool {
        let way = to - self.value;
        let there = way.abs() <= most;
        if !there {
            self.add(if way > 0.0 { most } else { -most });
            // What was carried may lead a last digit too far.
            let past = if way > 0.0 { self.value > to } else { self.value < to };
            if !past {
                return false;
            }
        }
        *self = Self::at(to);
        true
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values that must come through unchanged")]
mod tests {
    use super::*;

    #[test]
    fn it_arrives_exactly_and_never_beyond() {
        for (from, to, most) in
            [(0.0, 1.0, 0.3), (290.0, 290.001, 1e-6), (1.0, -1e-9, 0.25), (3e38, -3e38, 1e38)]
        {
            let mut mover = Mover::at(from);
            let mut steps = 0;
            while !mover.towards(to, most) {
                steps += 1;
                assert!(steps < 2_000, "{from} never gets to {to}");
                assert!((mover.value() - to) * (from - to) >= 0.0, "{from} beyond {to}");
            }
            assert_eq!(mover.value(), to);
        }
        let mut mover = Mover::at(5.0);
        assert!(mover.towards(-7.0, f32::INFINITY) && mover.value() == -7.0);
    }
}
