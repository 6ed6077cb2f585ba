//! Fan and pump: raise the pressure by a head curve that falls with volume flow.
//!
//! Source: Qiu et al. 2017, pressurisation component; law and validity in [`HeadCurve`]. A fan moves a gas and a
//! pump a liquid; their law is the same.

use super::{Element, HeadCurve, InputSpec, Law, Operating, ParameterError};
use crate::Fingerprint;

/// Writes one kind of machine; `$kind` is its word in network ids.
macro_rules! machine {
    ($(#[$doc:meta])* $name:ident, $kind:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct $name {
            /// Head curve at rated speed.
            pub curve: HeadCurve,
        }

        impl Element for $name {
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
                hash.word($kind);
                self.curve.feed(hash);
            }
        }
    };
}

machine! {
    /// Fixed data of one fan.
    Fan, 4
}
machine! {
    /// Fixed data of one pump.
    Pump, 5
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: HeadCurve = HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 13e3 };

    #[test]
    fn a_stopped_machine_is_a_plain_resistance() {
        let stopped = Operating::plain(&[0.0], 0.01);
        assert_eq!(Fan { curve: CURVE }.law(&stopped), Law::quadratic(13e3));
        assert_eq!(Pump { curve: CURVE }.law(&stopped), Law::quadratic(13e3));
    }

    #[test]
    fn a_fan_is_no_pump_to_the_network_id() {
        let id = |feed: &dyn Fn(&mut Fingerprint)| {
            let mut hash = Fingerprint::default();
            feed(&mut hash);
            hash.finish()
        };
        assert_ne!(id(&|hash| Fan { curve: CURVE }.feed(hash)), id(&|hash| Pump { curve: CURVE }.feed(hash)));
    }
}
