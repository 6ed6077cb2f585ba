//! Relief valve: opens at its crack pressure and closes again at its lower reseat pressure.
//!
//! Open `p_in − p_out = R·w·|w|`; closed, and for reverse flow, the same with R/C², C the opening that leaks.
//! It looks at the pressures at its own ends once a step and stands as it is within one.
//!
//! Source: the two pressures of any relief valve's data sheet; a pop action without travel time [assumed].

use super::{Element, InputSpec, Law, Operating, ParameterError, Reason};
use crate::Fingerprint;

/// Fixed data of one relief valve. Memory: 0 closed, 1 open.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReliefValve {
    /// Pressure difference at and above which it opens [Pa]; finite and > 0.
    pub crack_pa: f32,
    /// Pressure difference at and below which it closes [Pa]; ≥ 0 and below the crack pressure.
    pub reseat_pa: f32,
    /// Resistance R when open [Pa·s²/kg²] at the line's reference density; finite and > 0.
    pub resistance_pa_s2_kg2: f32,
    /// Opening that remains when closed, C [1]; 1e-4 … 1.
    pub leakage_opening: f32,
}

impl ReliefValve {
    fn closed(&self) -> f32 {
        self.resistance_pa_s2_kg2 / (self.leakage_opening * self.leakage_opening)
    }
}

impl Element for ReliefValve {
    fn input_spec(&self, _index: usize) -> Option<InputSpec> {
        None
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    fn responds(&self) -> bool {
        true
    }

    fn memory(&self) -> usize {
        1
    }

    fn advance(&self, at: &Operating<'_>, _step_s: f32, memory: &mut [f32]) {
        let Some(open) = memory.first_mut() else { return };
        let difference = at.inlet_pa - at.outlet_pa;
        if difference >= self.crack_pa {
            *open = 1.0;
        } else if difference <= self.reseat_pa {
            *open = 0.0;
        }
    }

    fn law(&self, at: &Operating<'_>) -> Law {
        let open = at.memory.first().is_some_and(|open| *open > 0.5);
        let resistance = if open { self.resistance_pa_s2_kg2 } else { self.closed() };
        Law::quadratic(resistance / at.density_ratio)
    }

    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.closed() / at.density_ratio)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("crack_pa", self.crack_pa)?;
        ParameterError::unless_not_negative("reseat_pa", self.reseat_pa)?;
        if self.reseat_pa >= self.crack_pa {
            return Err(ParameterError { parameter: "reseat_pa", reason: Reason::OutsideValidity });
        }
        ParameterError::unless_positive("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        super::hatch::check_leakage(self.leakage_opening, self.resistance_pa_s2_kg2)
    }

    fn feed(&self, hash: &mut Fingerprint) {
        hash.word(10);
        let Self { crack_pa, reseat_pa, resistance_pa_s2_kg2, leakage_opening } = *self;
        hash.values(&[crack_pa, reseat_pa, resistance_pa_s2_kg2, leakage_opening]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: ReliefValve = ReliefValve {
        crack_pa: 3_000.0,
        reseat_pa: 2_500.0,
        resistance_pa_s2_kg2: 1e5,
        leakage_opening: 1e-3,
    };

    #[test]
    fn it_opens_at_crack_and_closes_at_reseat() {
        let mut memory = [0.0];
        let mut opens = std::vec::Vec::new();
        let up = (0..=40).map(|step| 100.0 * step as f32);
        for difference in up.clone().chain(up.rev()) {
            let at = Operating { inlet_pa: 1e5 + difference, outlet_pa: 1e5, ..Operating::plain(&[], 0.0) };
            let before = memory[0];
            VALVE.advance(&at, 1e-3, &mut memory);
            if (memory[0] - before).abs() > 0.5 {
                opens.push((difference, memory[0] > 0.5));
            }
        }
        assert_eq!(opens, [(3_000.0, true), (2_500.0, false)]);
    }

    #[test]
    fn open_it_resists_little_and_never_passes_reverse_flow() {
        let law = |memory: &[f32]| {
            let at = Operating { memory, ..Operating::plain(&[], 0.0) };
            (VALVE.law(&at).resistance, VALVE.reverse_law(&at).resistance)
        };
        assert_eq!(law(&[1.0]).0.to_bits(), 1e5f32.to_bits());
        for (found, exact) in [(law(&[0.0]).0, 1e11), (law(&[0.0]).1, 1e11), (law(&[1.0]).1, 1e11f32)] {
            assert!((found / exact - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_reseat_that_is_no_lower_is_refused() {
        assert_eq!(ReliefValve { reseat_pa: 3_000.0, ..VALVE }.check().unwrap_err().parameter, "reseat_pa");
        assert_eq!(ReliefValve { crack_pa: 0.0, ..VALVE }.check().unwrap_err().parameter, "crack_pa");
        assert!(VALVE.check().is_ok());
    }
}
