//! Coolant side of a condensing or interface heat exchanger, in a line of its own.
//!
//! `p_in − p_out = R·w·|w|`; the heat is that of the exchanger.

use super::loss::{self, Loss, loss_face};
use crate::component::{Component, Draft};
use crate::parameter::{Key, Keys, ParameterError};
use crate::component_parameters;

component_parameters! {
    /// Fixed data of one coolant side.
    pub struct CoolantSide {
        /// Quadratic flow resistance R [Pa·s²/kg²] at the line's reference density; finite and ≥ 0.
        pub resistance_pa_s2_kg2: f32,
        /// Free share of the area that remains when blocked [1]; 0 for a side that cannot be blocked.
        pub least_opening: f32,
    }
}

impl CoolantSide {
    fn loss(self) -> Loss {
        let Self { resistance_pa_s2_kg2, least_opening } = self;
        Loss { resistance_pa_s2_kg2, least_opening }
    }
}

impl Component for CoolantSide {
    const KIND: &'static str = "coolant_side";
    const ABOUT: &'static str = "Coolant side of a `condenser` or `interface_exchanger`; needs `[air]`.";
    const KEYS: Keys = &[loss::KEYS, loss::BLOCKAGE, &[Key::component("condenser", "Id of the exchanger.")]];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        draft.needs_air();
        let Loss { resistance_pa_s2_kg2, least_opening } = Loss::from_file(draft);
        Self { resistance_pa_s2_kg2, least_opening }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.loss().check()
    }

    loss_face!();
}
