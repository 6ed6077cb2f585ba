//! Pressure law of a component and the operating point at which it is stated.

use crate::math;

/// Pressure law of a component around its present flow:
/// `p_in − p_out = resistance·w·|w| + linear·w − head`.
///
/// A component whose law has another form states the one that matches its own in value and slope at the present flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Quadratic flow resistance R [Pa·s²/kg²], ≥ 0.
    pub resistance: f32,
    /// Linear (laminar) flow resistance [Pa·s/kg], ≥ 0.
    pub linear: f32,
    /// Head at zero flow [Pa], positive in the direction from `from` to `to`.
    pub head: f32,
}

impl Law {
    /// Resistance of a closed seat [Pa·s²/kg²], and the largest of any: 1 bar drives 3e-8 kg/d through it. R·w² at
    /// 1000 kg/s and 4·R·Δp at 60 megapascals stay within single precision.
    pub const TIGHT_PA_S2_KG2: f32 = 1e30;

    /// Linear resistance of a source of flow [Pa·s/kg]: 1 bar adds 1e-13 kg/s to what it carries.
    pub const SOURCE_PA_S_KG: f32 = 1e18;

    /// Returns the law of a source of flow, whatever the pressures.
    pub fn source(flow_kg_s: f32) -> Self {
        Self { resistance: 0.0, linear: Self::SOURCE_PA_S_KG, head: Self::SOURCE_PA_S_KG * flow_kg_s }
    }

    /// Whether pressures have no say in the flow: that of a source, or none through a seat as tight as one.
    pub fn is_source(&self) -> bool {
        self.resistance <= 0.0 && self.linear >= Self::SOURCE_PA_S_KG
    }

    /// Whether it is that of a closed seat, through which nothing measurable passes.
    pub fn is_tight(&self) -> bool {
        self.resistance >= 0.5 * Self::TIGHT_PA_S2_KG2
    }

    /// Returns a law with a quadratic loss that grows without end as an opening closes: held at
    /// [`Self::TIGHT_PA_S2_KG2`].
    pub fn closing(resistance: f32) -> Self {
        Self::quadratic(math::smaller(resistance, Self::TIGHT_PA_S2_KG2))
    }

    /// Returns a law with a quadratic loss only.
    pub const fn quadratic(resistance: f32) -> Self {
        Self { resistance, linear: 0.0, head: 0.0 }
    }
}

/// Operating point of a component that states its [`Law`].
#[derive(Debug, Clone, Copy)]
pub struct Operating<'a> {
    /// Inputs in the order of [`crate::Component::input_spec`].
    pub inputs: &'a [f32],
    /// Present mass flow at the inlet [kg/s].
    pub mass_flow_kg_s: f32,
    /// Present inlet density over the density for which the parameters hold, > 0; 1 where density is fixed.
    pub density_ratio: f32,
    /// Absolute pressure at the inlet [Pa], ≥ 0; given only to a component that [`crate::Component::responds`].
    pub inlet_pa: f32,
    /// Absolute pressure at the outlet [Pa], ≥ 0; given to the same components.
    pub outlet_pa: f32,
    /// Virtual temperature of the gas upstream [K], > 0: that of dry air of the same pressure and density; given to the
    /// same components.
    pub temperature_k: f32,
    /// Own memory, [`crate::Component::memory`] slots; given to the same components.
    pub memory: &'a [f32],
}

impl<'a> Operating<'a> {
    /// Returns the operating point of a component whose law depends on inputs and flow only: fixed density, sea-level
    /// pressure on both sides.
    pub const fn plain(inputs: &'a [f32], mass_flow_kg_s: f32) -> Self {
        Self {
            inputs,
            mass_flow_kg_s,
            density_ratio: 1.0,
            inlet_pa: 101_325.0,
            outlet_pa: 101_325.0,
            temperature_k: 293.15,
            memory: &[],
        }
    }
}
