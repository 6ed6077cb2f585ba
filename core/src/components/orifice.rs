//! Orifice: leak or opening through which air flows as fast as its pressures make it, choked to a vacuum.
//!
//! Law and source in [`super::isentropic`]: R = y/w² at the pressures of the step's start.

use super::isentropic;
use crate::component::{Component, Draft};
use crate::law::{Law, Operating};
use crate::math;
use crate::parameter::{InputSpec, Key, Keys, ParameterError, Reason};
use crate::component_parameters;

/// Smallest effective area [m²], that of a closed opening: 1 bar drives 2e-8 kg/d of air through it. Its square is a
/// normal number of single precision.
pub(super) const SMALLEST_AREA_M2: f32 = 1e-15;

component_parameters! {
    /// Fixed data of one orifice. Input: share of its area that is open.
    pub struct Orifice {
        /// Effective area `C_d·A` [m²]; 1e-15 … 1e4.
        pub effective_area_m2: f32,
    }
}

/// Discharge coefficient on the component's own area.
pub(super) const DISCHARGE: Key =
    Key::required("discharge_coefficient", "1", (1e-3, 1.0), "Discharge coefficient on the component's own area.");

/// Effective areas of openings [m²].
pub(super) const EFFECTIVE_AREA: (f64, f64) = (1e-15, 1e4);

/// Returns the effective area `C_d·A` of a table with a [`DISCHARGE`].
pub(super) fn effective_area(draft: &mut Draft<'_>) -> f32 {
    let key = "discharge_coefficient";
    let area = draft.area(key) * draft.number(key);
    draft.fit(key, area, EFFECTIVE_AREA, "m²")
}

/// Refuses an effective area outside its range.
pub(super) fn check_area(area_m2: f32) -> Result<(), ParameterError> {
    ParameterError::unless_positive("effective_area_m2", area_m2)?;
    if (SMALLEST_AREA_M2..=1e4).contains(&area_m2) {
        Ok(())
    } else {
        Err(ParameterError { parameter: "effective_area_m2", reason: Reason::OutsideValidity })
    }
}

impl Component for Orifice {
    const KIND: &'static str = "orifice";
    const ABOUT: &'static str = "Opening of its own area with isentropic, choked flow.";
    const KEYS: Keys = &[&[DISCHARGE]];
    const INPUTS: &'static [InputSpec] = &[InputSpec::OPENING];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self { effective_area_m2: effective_area(draft) }
    }

    #[inline]
    fn is_active(&self) -> bool {
        true
    }

    fn responds(&self) -> bool {
        true
    }

    fn needs_both_ends(&self) -> bool {
        true
    }

    fn chord_over_secant(&self) -> f32 {
        isentropic::CHORD_OVER_SECANT
    }

    #[inline]
    fn law(&self, at: &Operating<'_>) -> Law {
        let opening = at.inputs.first().copied().unwrap_or(1.0);
        Law::closing(isentropic::resistance_pa_s2_kg2(
            math::larger(self.effective_area_m2 * opening, SMALLEST_AREA_M2),
            at.inlet_pa,
            at.outlet_pa,
            at.temperature_k,
        ))
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_area(self.effective_area_m2)
    }

}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_area_carries_twice_the_flow() {
        let at = Operating { inlet_pa: 1e5, outlet_pa: 2e4, ..Operating::plain(&[], 0.0) };
        let flow = |effective_area_m2| (8e4 / Orifice { effective_area_m2 }.law(&at).resistance).sqrt();
        assert!((flow(2e-6) / flow(1e-6) - 2.0).abs() < 1e-6);
    }

    /// Closed it lets less than a milligram a year out of a cabin, and is a number between two vacua.
    #[test]
    fn closed_it_is_tight() {
        let orifice = Orifice { effective_area_m2: 1e-2 };
        let at = Operating { inlet_pa: 1e5, outlet_pa: 0.0, ..Operating::plain(&[0.0], 0.0) };
        let kg_a_year = (1e5 / orifice.law(&at).resistance).sqrt() * 3.156e7;
        assert!(kg_a_year < 1e-5, "{kg_a_year:e}");
        let vacua = Operating { inlet_pa: 0.0, ..at };
        assert!((orifice.law(&vacua).resistance * 1e6).is_finite());
    }

    #[test]
    fn areas_without_a_square_are_refused() {
        for effective_area_m2 in [0.0, -1e-6, 1e-16, 2e4, f32::NAN, f32::INFINITY] {
            assert!(Orifice { effective_area_m2 }.check().is_err(), "{effective_area_m2}");
        }
        assert!(Orifice { effective_area_m2: 1.1e-8 }.check().is_ok());
    }
}
