//! Check valve: passes forward flow, and of reverse flow only what its seat leaks.
//!
//! Forward `p_in − p_out = R·w·|w|`, reverse `p_in − p_out = L·w`.
//!
//! Source: the forward loss is that of a pipe; the leak of a seat is flow through a gap so narrow that it is
//! laminar, linear in pressure [assumed], and given by one measurement. The disc has no mass and no spring.

use super::{Element, FAULT, InputSpec, Law, Operating, ParameterError, fault};
use crate::Fingerprint;
use crate::control::ActuatorFault;

/// Fixed data of one check valve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CheckValve {
    /// Quadratic resistance R to forward flow [Pa·s²/kg²] at the line's reference density; finite and > 0.
    pub resistance_pa_s2_kg2: f32,
    /// Linear resistance L to reverse flow [Pa·s/kg]: pressure over leak; finite and > 0.
    pub reverse_pa_s_kg: f32,
}

impl CheckValve {
    fn open(self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    fn seated(self) -> Law {
        Law { resistance: 0.0, linear: self.reverse_pa_s_kg, head: 0.0 }
    }
}

impl Element for CheckValve {
    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        (index == 0).then_some(FAULT)
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    fn responds(&self) -> bool {
        true
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        if fault(at.inputs) == ActuatorFault::Closed { self.seated() } else { self.open(at) }
    }

    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        if fault(at.inputs) == ActuatorFault::Open { self.open(at) } else { self.seated() }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        ParameterError::unless_positive("reverse_pa_s_kg", self.reverse_pa_s_kg)
    }

    fn feed(&self, hash: &mut Fingerprint) {
        hash.word(9);
        hash.values(&[self.resistance_pa_s2_kg2, self.reverse_pa_s_kg]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_leak_is_the_measured_one() {
        // 2 mg/s at 500 Pa.
        let valve = CheckValve { resistance_pa_s2_kg2: 4e3, reverse_pa_s_kg: 500.0 / 2e-6 };
        let law = valve.reverse_law(&Operating::plain(&[], -1e-6));
        assert!((500.0 / (law.linear * 2e-6) - 1.0).abs() < 1e-6 && law.resistance <= 0.0);
        assert!(valve.check().is_ok());
        assert!(CheckValve { reverse_pa_s_kg: 0.0, ..valve }.check().is_err());
        assert!(CheckValve { resistance_pa_s2_kg2: 0.0, ..valve }.check().is_err());
    }
}
