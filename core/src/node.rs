//! Cabin node: a gas volume whose pressure follows its mass balance, or a boundary that is held.
//!
//! `V/(Rg·T) · dp/dt = Σw_in − Σw_out` (isothermal).
//!
//! Source: Qiu et al. 2017, cabin equation. Valid while T changes slowly against the step.
//!
//! A node stores the deviation of its mass from the mass at the start; the pressure follows from it. Written
//! that way, what a line takes from one node and gives to the next is the same number.

use crate::parameter::{ParameterError, Reason};
use crate::{Fingerprint, air};

/// What a node does with the flows that reach it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NodeKind {
    /// A well-mixed gas volume: cabin, module, plenum.
    Cabin {
        /// Free gas volume V [m³], finite and > 0.
        volume_m3: f32,
    },
    /// A volume of liquid that keeps its density: pipe, tank, or accumulator with a spring; only the implicit methods
    /// take it.
    Liquid {
        /// Mass that a pascal more presses in, V·ρ/K of a full volume or an accumulator's own [kg/Pa]; finite and > 0.
        capacity_kg_pa: f32,
    },
    /// A point without volume where lines meet; only the implicit methods take it.
    Junction,
    /// Held at its start pressure whatever flows: supply, space vacuum.
    Boundary,
}

/// Fixed data of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Node {
    /// Volume or boundary.
    pub kind: NodeKind,
    /// Pressure at the start as deviation from the network's reference pressure [Pa], finite.
    pub start_gauge_pa: f32,
    /// Gas temperature T [K], finite and > 0.
    pub temperature_k: f32,
}

impl Node {
    /// Returns dp/dm = Rg·T/V [Pa/kg]; 0 for a boundary, which no flow can move, and for a junction, whose
    /// pressure does not follow from its mass.
    pub fn pressure_per_mass_pa_kg(&self) -> f32 {
        match self.kind {
            NodeKind::Cabin { volume_m3 } => air::pressure_per_mass_pa_kg(volume_m3, self.temperature_k),
            NodeKind::Liquid { capacity_kg_pa } => 1.0 / capacity_kg_pa,
            NodeKind::Junction | NodeKind::Boundary => 0.0,
        }
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("start_gauge_pa", self.start_gauge_pa)?;
        ParameterError::unless_positive("temperature_k", self.temperature_k)?;
        if let NodeKind::Liquid { capacity_kg_pa } = self.kind {
            ParameterError::unless_positive("capacity_kg_pa", capacity_kg_pa)?;
            if !self.pressure_per_mass_pa_kg().is_finite() {
                return Err(ParameterError { parameter: "capacity_kg_pa", reason: Reason::NotPositive });
            }
        }
        if let NodeKind::Cabin { volume_m3 } = self.kind {
            ParameterError::unless_positive("volume_m3", volume_m3)?;
            if !self.pressure_per_mass_pa_kg().is_finite() {
                return Err(ParameterError { parameter: "volume_m3", reason: Reason::NotPositive });
            }
        }
        Ok(())
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        match self.kind {
            NodeKind::Cabin { volume_m3 } => {
                hash.word(1);
                hash.value(volume_m3);
            }
            NodeKind::Liquid { capacity_kg_pa } => {
                hash.word(4);
                hash.value(capacity_kg_pa);
            }
            NodeKind::Boundary => hash.word(2),
            NodeKind::Junction => hash.word(3),
        }
        hash.values(&[self.start_gauge_pa, self.temperature_k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_boundary_is_not_moved_by_any_flow() {
        let node = Node { kind: NodeKind::Boundary, start_gauge_pa: 0.0, temperature_k: 295.15 };
        assert!(node.pressure_per_mass_pa_kg().abs() < f32::MIN_POSITIVE);
    }

    #[test]
    fn bad_parameters_are_named() {
        let node = |volume_m3, temperature_k| Node {
            kind: NodeKind::Cabin { volume_m3 },
            start_gauge_pa: 0.0,
            temperature_k,
        };
        assert_eq!(node(0.0, 295.0).check().unwrap_err().parameter, "volume_m3");
        assert_eq!(node(f32::NAN, 295.0).check().unwrap_err().parameter, "volume_m3");
        assert_eq!(node(1.0, -1.0).check().unwrap_err().parameter, "temperature_k");
        assert!(node(1.0, 295.0).check().is_ok());
    }
}
