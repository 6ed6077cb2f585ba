//! Surroundings of a component in a step.

use crate::fluid::medium;
use crate::fluid::{Medium, PARTS, Parts};

/// Quantities that are the same for all components in a step.
#[derive(Debug, Clone, Copy)]
pub struct StepContext<'s> {
    /// Step [s].
    pub step_s: f32,
    /// Temperature from which energies count [K].
    pub reference_k: f32,
    /// Cabin air.
    pub air: &'s Medium,
    /// The coolant.
    pub coolant: &'s Medium,
    /// Values of all inputs.
    pub inputs: &'s [f32],
}

impl<'s> StepContext<'s> {
    /// Returns the inputs from slot `first` on.
    #[inline]
    pub fn inputs_from(&self, first: u32) -> &'s [f32] {
        self.inputs.get(first as usize..).unwrap_or(&[])
    }

    /// Returns the inputs of a component that has `N`, from slot `first` on; zeros where there are none.
    #[inline]
    pub fn inputs_of<const N: usize>(&self, first: u32) -> [f32; N] {
        self.inputs_from(first).first_chunk().copied().unwrap_or([0.0; N])
    }
}

/// State of the volume around a component, at the end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct VolumeView<'s> {
    /// Temperature over the reference [K].
    pub theta_k: f32,
    /// Absolute pressure [Pa].
    pub pressure_pa: f32,
    /// Mass [kg].
    pub mass_kg: f32,
    /// Mass fractions [1].
    pub fractions: &'s Parts,
}

impl VolumeView<'_> {
    /// Partial pressure of a part [Pa].
    #[inline]
    pub fn partial_pa(&self, part: usize) -> f32 {
        medium::partial_pressure_pa(part, self.fractions, self.pressure_pa)
    }
}

/// Volumes at the end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct Volumes<'s> {
    /// Temperature over the reference [K], absolute pressure [Pa] and mass [kg] stand first.
    pub(crate) figures: &'s [[f32; 6]],
    pub(crate) fractions: &'s [Parts],
}

impl<'s> Volumes<'s> {
    /// Returns the volume of a node; an empty one for a node that does not exist.
    #[inline]
    pub(crate) fn view(self, node: u32) -> VolumeView<'s> {
        let [theta_k, pressure_pa, mass_kg, ..] =
            self.figures.get(node as usize).copied().unwrap_or([0.0; 6]);
        let fractions = self.fractions.get(node as usize).unwrap_or(&[0.0; PARTS]);
        VolumeView { theta_k, pressure_pa, mass_kg, fractions }
    }
}

/// Passage of a stream through a component.
#[derive(Debug, Clone, Copy)]
pub struct Passing<'s> {
    /// Side of the component: 0 its own line, 1 the line of its coolant.
    pub side: u8,
    /// Medium of the stream.
    pub medium: &'s Medium,
    /// Pressure of the volume upstream [Pa].
    pub pressure_pa: f32,
    /// Whether it flows against the line's direction.
    pub reversed: bool,
}

/// Heat of a component into a stream in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Heat {
    /// Energy that came from outside the network [J].
    pub outside_j: f32,
    /// Part of it that the stream could not carry [J].
    pub left_j: f32,
}

/// State and scratch of one component.
#[derive(Debug)]
pub struct Block<'b> {
    /// Numbers that last, [`crate::Component::STATE`] of them.
    pub state: &'b mut [f32],
    /// Numbers that a step derives, [`crate::Component::SCRATCH`] of them.
    pub scratch: &'b mut [f32],
}

/// State and scratch of one component, for reading.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'b> {
    /// Numbers that last, [`crate::Component::STATE`] of them.
    pub state: &'b [f32],
    /// Numbers that a step derives, [`crate::Component::SCRATCH`] of them.
    pub scratch: &'b [f32],
}
