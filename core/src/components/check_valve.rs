//! Check valve: passes forward flow, and of reverse flow only what its seat leaks.
//!
//! Forward `p_in − p_out = R·w·|w|`, reverse `p_in − p_out = L·w`.
//!
//! Source: the forward loss is that of a pipe; the leak of a seat is flow through a gap so narrow that it is
//! laminar, linear in pressure [assumed], and given by one measurement. The disc has no mass and no spring.

use super::loss;
use crate::component::{Component, Draft};
use crate::control::ActuatorFault;
use crate::law::{Law, Operating};
use crate::limits::SOME_PRESSURE;
use crate::parameter::{InputSpec, Key, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one check valve.
    pub struct CheckValve {
        /// Quadratic resistance R to forward flow [Pa·s²/kg²] at the line's reference density; finite and > 0.
        pub resistance_pa_s2_kg2: f32,
        /// Linear resistance L to reverse flow [Pa·s/kg]: pressure over leak; finite and > 0.
        pub reverse_pa_s_kg: f32,
    }
}

impl CheckValve {
    fn open(self, at: &Operating<'_>) -> Law {
        Law::quadratic(self.resistance_pa_s2_kg2 / at.density_ratio)
    }

    fn seated(self) -> Law {
        Law { resistance: 0.0, linear: self.reverse_pa_s_kg, head: 0.0 }
    }
}

impl Component for CheckValve {
    const KIND: &'static str = "check_valve";
    const ABOUT: &'static str = "Passes forward flow only, but for the leak of its seat.";
    const KEYS: Keys = &[
        loss::KEYS,
        &[
            Key::required("reverse_leak_kg_s", "kg/s", (1e-12, 1.0), "Leak in reverse."),
            Key::required("reverse_pressure_pa", "Pa", SOME_PRESSURE, "Pressure difference of that leak."),
        ],
    ];
    const INPUTS: &'static [InputSpec] = &[InputSpec::FAULT];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let reverse = draft.number("reverse_pressure_pa") / draft.number("reverse_leak_kg_s");
        Self {
            resistance_pa_s2_kg2: loss::resistance(draft),
            reverse_pa_s_kg: draft.fit("reverse_leak_kg_s", reverse, (1e-3, 1e19), "Pa·s/kg"),
        }
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
        if ActuatorFault::of_inputs(at.inputs) == ActuatorFault::Closed { self.seated() } else { self.open(at) }
    }

    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        if ActuatorFault::of_inputs(at.inputs) == ActuatorFault::Open { self.open(at) } else { self.seated() }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        ParameterError::unless_positive("reverse_pa_s_kg", self.reverse_pa_s_kg)
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
