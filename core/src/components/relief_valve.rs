//! Relief valve: opens at its crack pressure and closes again at its lower reseat pressure.
//!
//! Open `p_in − p_out = R·w·|w|`, or isentropic flow through an effective area, choked to a vacuum
//! ([`super::isentropic`]); closed, and for reverse flow, the same with R/C² or C times the area, C the opening that leaks.
//! It looks at the pressures at its own ends once a step and stands as it is within one.
//!
//! Source: the two pressures of any relief valve's data sheet; a pop action without travel time [assumed].

use super::{isentropic, loss, orifice, seat};
use crate::component::{Component, Draft};
use crate::control::ActuatorFault;
use crate::law::{Law, Operating};
use crate::limits::SOME_PRESSURE;
use crate::math;
use crate::parameter::{InputSpec, Key, Keys, ParameterError, Presence, Reason};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one relief valve. Memory: 0 closed, 1 open.
    pub struct ReliefValve {
        /// Pressure difference at and above which it opens [Pa]; finite and > 0.
        pub crack_pa: f32,
        /// Pressure difference at and below which it closes [Pa]; ≥ 0 and below the crack pressure.
        pub reseat_pa: f32,
        /// Resistance R when open [Pa·s²/kg²] at the line's reference density; finite and > 0, and 0 for one of an area.
        pub resistance_pa_s2_kg2: f32,
        /// Effective area `C_d·A` when open [m²], 1e-15 … 1e4, of one with isentropic flow; 0 for one of a resistance.
        pub effective_area_m2: f32,
        /// Opening that remains when closed, C [1]; 1e-18 … 1.
        pub leakage_opening: f32,
    }
}

impl ReliefValve {
    fn is_isentropic(&self) -> bool {
        self.effective_area_m2 > 0.0
    }

    fn law_at(&self, at: &Operating<'_>, opening: f32) -> Law {
        Law::closing(if self.is_isentropic() {
            let area = math::larger(self.effective_area_m2 * opening, orifice::SMALLEST_AREA_M2);
            isentropic::resistance_pa_s2_kg2(area, at.inlet_pa, at.outlet_pa, at.temperature_k)
        } else {
            self.resistance_pa_s2_kg2 / (opening * opening) / at.density_ratio
        })
    }
}

impl Component for ReliefValve {
    const KIND: &'static str = "relief_valve";
    const ABOUT: &'static str = "Opens at one pressure difference and closes at a lower one.";
    const KEYS: Keys = &[
        loss::KEYS,
        &[
            Key { presence: Presence::Optional, ..orifice::DISCHARGE },
            Key::required("crack_pa", "Pa", SOME_PRESSURE, "Pressure difference at which it opens."),
            Key::required("reseat_pa", "Pa", (0.0, 1e7), "Pressure difference at which it closes."),
        ],
        seat::KEYS,
    ];
    const INPUTS: &'static [InputSpec] = &[InputSpec::FAULT];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        let isentropic = draft.optional("discharge_coefficient").is_some();
        let (resistance_pa_s2_kg2, effective_area_m2) = if isentropic {
            (loss::none(draft), orifice::effective_area(draft))
        } else {
            (loss::resistance(draft), 0.0)
        };
        Self {
            crack_pa: draft.single("crack_pa"),
            reseat_pa: draft.single("reseat_pa"),
            resistance_pa_s2_kg2,
            effective_area_m2,
            leakage_opening: if isentropic {
                seat::of_area(draft, effective_area_m2)
            } else {
                seat::of_loss(draft, resistance_pa_s2_kg2, 2.0)
            },
        }
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
        *open = match ActuatorFault::of_inputs(at.inputs) {
            ActuatorFault::Open => 1.0,
            ActuatorFault::Closed => 0.0,
            ActuatorFault::None if difference >= self.crack_pa => 1.0,
            ActuatorFault::None if difference <= self.reseat_pa => 0.0,
            ActuatorFault::None | ActuatorFault::Stuck => return,
        };
    }

    fn law(&self, at: &Operating<'_>) -> Law {
        let open = at.memory.first().is_some_and(|open| *open > 0.5);
        self.law_at(at, if open { 1.0 } else { self.leakage_opening })
    }

    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        let open = ActuatorFault::of_inputs(at.inputs) == ActuatorFault::Open;
        self.law_at(at, if open { 1.0 } else { self.leakage_opening })
    }

    fn needs_both_ends(&self) -> bool {
        self.is_isentropic()
    }

    fn chord_over_secant(&self) -> f32 {
        if self.is_isentropic() { isentropic::CHORD_OVER_SECANT } else { 1.207_107 }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("crack_pa", self.crack_pa)?;
        ParameterError::unless_not_negative("reseat_pa", self.reseat_pa)?;
        if self.reseat_pa >= self.crack_pa {
            return Err(ParameterError { parameter: "reseat_pa", reason: Reason::OutsideValidity });
        }
        if self.is_isentropic() {
            orifice::check_area(self.effective_area_m2)?;
            return seat::check(self.leakage_opening);
        }
        ParameterError::unless_not_negative("effective_area_m2", self.effective_area_m2)?;
        ParameterError::unless_positive("resistance_pa_s2_kg2", self.resistance_pa_s2_kg2)?;
        seat::check_closed(self.leakage_opening, self.resistance_pa_s2_kg2)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: ReliefValve = ReliefValve {
        crack_pa: 3_000.0,
        reseat_pa: 2_500.0,
        resistance_pa_s2_kg2: 1e5,
        effective_area_m2: 0.0,
        leakage_opening: 1e-3,
    };

    #[test]
    fn one_of_an_area_is_choked_to_a_vacuum_and_a_plain_loss_is_not() {
        let area = ReliefValve { resistance_pa_s2_kg2: 0.0, effective_area_m2: 1e-4, ..VALVE };
        area.check().unwrap();
        let flow = |valve: &ReliefValve, outlet_pa: f32| {
            let at = Operating { inlet_pa: 1e5, outlet_pa, memory: &[1.0], ..Operating::plain(&[0.0], 1.0) };
            ((1e5 - outlet_pa) / valve.law(&at).resistance).sqrt()
        };
        // 0.6847·A·p/√(Rg·T) below the critical ratio, whatever lies behind.
        let choked = 0.684_7 * 1e-4 * 1e5 / (287.05f32 * 293.15).sqrt();
        for outlet_pa in [0.0, 2e4, 5e4] {
            assert!((flow(&area, outlet_pa) / choked - 1.0).abs() < 1e-4);
        }
        assert!(flow(&area, 9e4) < 0.9 * choked);
        // A loss that lets as much through at a small difference lets twice as much out into the vacuum, √2/0.6847.
        let resistance_pa_s2_kg2 = 100.0 / flow(&area, 99_900.0).powi(2);
        let loss = ReliefValve { resistance_pa_s2_kg2, ..VALVE };
        assert!((flow(&loss, 0.0) / choked - 2.065).abs() < 0.01, "{}", flow(&loss, 0.0));
    }

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
