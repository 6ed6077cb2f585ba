//! Measured line: a real fan, duct or valve between two nodes of the plant, whose mass flow comes in as an input.
//!
//! `w = w_measured`, written as the law of a source with a resistance so large that no pressure moves the flow:
//! `p_in − p_out = L·w − L·w_measured`, L = 1e18 Pa·s/kg. A pressure difference of 1 bar adds 1e-13 kg/s, less than
//! a rounding of any flow that is measured: the flow that is measured is the flow, and the mass that leaves one node is
//! the mass that enters the other.
//!
//! Source: the Norton equivalent of a source; assumed. The plant gives out the pressures of both nodes, hardware
//! answers with its flow a little later: `eclss-rt check --hil` says whether that loop is stable. Not for
//! `relaxation` and `euler`, whose flow rows would take 1e18 s to follow.

use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::parameter::{InputSpec, Key, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one measured line.
    pub struct Measured {
        /// Largest flow in either direction that is believed [kg/s]; finite and > 0.
        pub largest_flow_kg_s: f32,
        /// How strongly the hardware's flow answers to pressure, |dw/dp| at most [kg/(s·Pa)]; finite and > 0. The step
        /// does not use it, the check of the coupling does.
        pub slope_kg_s_pa: f32,
    }
}

impl Component for Measured {
    const KIND: &'static str = "measured";
    const ABOUT: &'static str = "Real hardware between two nodes, whose mass flow is an input.";
    const KEYS: Keys = &[&[
        Key::required("largest_flow_kg_s", "kg/s", (1e-6, 100.0), "Largest flow that is believed."),
        Key::required("slope_kg_s_pa", "kg/(s·Pa)", (1e-9, 1e3), "How strongly its flow answers to pressure, at most."),
    ]];
    const INPUTS: &'static [InputSpec] =
        &[InputSpec { name: "measured_flow", unit: "kg/s", min: -100.0, max: 100.0, default: 0.0 }];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self {
            largest_flow_kg_s: draft.single("largest_flow_kg_s"),
            slope_kg_s_pa: draft.single("slope_kg_s_pa"),
        }
    }

    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        let (min, max) = (-self.largest_flow_kg_s, self.largest_flow_kg_s);
        Some(InputSpec { min, max, ..*Self::INPUTS.get(index)? })
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        Law::source(at.inputs.first().copied().unwrap_or(0.0))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("largest_flow_kg_s", self.largest_flow_kg_s)?;
        ParameterError::unless_positive("slope_kg_s_pa", self.slope_kg_s_pa)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: Measured = Measured { largest_flow_kg_s: 0.2, slope_kg_s_pa: 1e-3 };

    /// The law gives the measured flow at every pressure difference, and no flow where none was measured.
    #[test]
    fn the_flow_is_the_measured_one() {
        for flow in [-0.2f32, -0.01, 0.0, 0.0865, 0.2] {
            for drop_pa in [-1e7f32, -1_000.0, 0.0, 101_325.0] {
                let law = RIG.law(&Operating::plain(&[flow], 0.1));
                let driven = (drop_pa + law.head) / law.linear;
                assert!((driven - flow).abs() <= 2.0 * f32::EPSILON * flow.abs() + 1.1e-11, "{driven}");
            }
        }
    }

    #[test]
    fn parameters_are_checked() {
        assert_eq!(RIG.check(), Ok(()));
        for wrong in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Measured { largest_flow_kg_s: wrong, ..RIG }.check().is_err());
            assert!(Measured { slope_kg_s_pa: wrong, ..RIG }.check().is_err());
        }
    }
}
