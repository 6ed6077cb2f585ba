//! Fan: raises the pressure of a gas by a head curve that falls with volume flow.
//!
//! Source: Qiu et al. 2017, pressurisation component; law and validity in [`HeadCurve`].

use super::{Element, HeadCurve, InputSpec, Law, Operating, ParameterError};
use crate::Fingerprint;

/// Fixed data of one fan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fan {
    /// Head curve at rated speed.
    pub curve: HeadCurve,
}

impl Element for Fan {
    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        let speed = InputSpec { name: "speed", unit: "1", min: 0.0, max: 2.0, default: 1.0 };
        (index == 0).then_some(speed)
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    #[inline]
    fn may_be_linear(&self) -> bool {
        self.curve.linear_pa_s_kg > 0.0
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        self.curve.law(at.inputs.first().copied().unwrap_or(1.0), at.density_ratio)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.curve.check()
    }

    fn feed(&self, hash: &mut Fingerprint) {
        hash.word(4);
        self.curve.feed(hash);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stopped_fan_is_a_plain_resistance() {
        let fan =
            Fan { curve: HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 13e3 } };
        let law = fan.law(&Operating { inputs: &[0.0], mass_flow_kg_s: 0.01, density_ratio: 1.0 });
        assert_eq!(law, Law::quadratic(13e3));
    }
}
