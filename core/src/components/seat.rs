//! Seats of valves, regulators and hatches: the opening that remains when they are closed.
//!
//! A seat is tight unless the file states its leak, as kilograms a day at a pressure difference or as an opening.

use super::isentropic::flow_per_area;
use crate::component::Draft;
use crate::law::Law;
use crate::limits::SOME_PRESSURE;
use crate::parameter::{Key, ParameterError, Reason};

/// Smallest share of an opening that may remain when closed [1]: its square is still a normal number.
pub(super) const LEAST_LEAKAGE: f32 = 1e-18;
/// Share that remains of a tight one [1]; of a quadratic loss [`Law::TIGHT_PA_S2_KG2`] is left.
const TIGHT: f64 = 1.001e-18;
/// Seconds of a day.
const SECONDS_A_DAY: f64 = 86_400.0;

/// Keys of a seat.
pub(super) const KEYS: &[Key] = &[
    Key::optional(
        "leakage_opening",
        "1",
        (1e-12, 1.0),
        "Opening that remains when closed; tight when absent.",
    ),
    Key::optional(
        "seat_leak_kg_d",
        "kg/d",
        (0.0, 1e6),
        "Leak of the closed seat, instead; with its pressure.",
    ),
    Key::optional("seat_leak_pressure_pa", "Pa", SOME_PRESSURE, "Pressure difference of that leak."),
];

/// A leak as a file gives it.
enum Leak {
    /// Share of the opening that remains [1].
    Opening(f64),
    /// Leak [kg/s] at a pressure difference [Pa].
    Measured(f64, f64),
    Tight,
}

fn leak(draft: &mut Draft<'_>) -> Leak {
    let (opening, measured) = (draft.optional("leakage_opening"), draft.optional("seat_leak_kg_d"));
    let pressure = draft.optional("seat_leak_pressure_pa");
    if opening.is_some() && measured.is_some() {
        let reason = "as `seat_leak_kg_d`, or as `leakage_opening`";
        draft.refuse("seat_leak_kg_d", format_args!("give the leak of the seat once: {reason}"));
    }
    let pair = [("seat_leak_kg_d", "seat_leak_pressure_pa"), ("seat_leak_pressure_pa", "seat_leak_kg_d")];
    for (key, other) in pair {
        if draft.optional(key).is_some() && draft.optional(other).is_none() {
            draft.refuse(key, format_args!("`{key}` needs `{other}`: a leak at a pressure"));
        }
    }
    match (opening, measured, pressure) {
        (Some(opening), ..) => Leak::Opening(opening),
        (None, Some(leak_kg_d), Some(pressure_pa)) => Leak::Measured(leak_kg_d / SECONDS_A_DAY, pressure_pa),
        _ => Leak::Tight,
    }
}

/// Returns the opening that a closed loss k·C⁻ⁿ keeps: with the measured leak m at Δp it resists Δp/m².
pub(super) fn of_loss(draft: &mut Draft<'_>, open_resistance: f32, exponent: f64) -> f32 {
    let tight = f64::from(Law::TIGHT_PA_S2_KG2);
    let closed = match leak(draft) {
        Leak::Opening(opening) => return opening as f32,
        Leak::Measured(leak_kg_s, pressure_pa) if leak_kg_s > 0.0 => {
            let resistance = pressure_pa / (leak_kg_s * leak_kg_s);
            if resistance < tight { resistance } else { tight }
        }
        Leak::Measured(..) | Leak::Tight => tight,
    };
    // A loss that no opening changes never closes.
    let open = f64::from(open_resistance);
    let opening = if exponent > 0.0 { libm::pow(open / closed, 1.0 / exponent) } else { 1.0 };
    remaining(draft, opening)
}

/// Returns the opening that a closed area keeps.
pub(super) fn of_area(draft: &mut Draft<'_>, open_area_m2: f32) -> f32 {
    match leak(draft) {
        Leak::Opening(opening) => opening as f32,
        Leak::Measured(leak_kg_s, pressure_pa) => {
            let high = if draft.line.high_pa > pressure_pa { draft.line.high_pa } else { pressure_pa };
            let per_area = flow_per_area(high, high - pressure_pa, draft.line.high_k);
            remaining(draft, leak_kg_s / per_area / f64::from(open_area_m2))
        }
        Leak::Tight => TIGHT as f32,
    }
}

fn remaining(draft: &mut Draft<'_>, opening: f64) -> f32 {
    if opening > 1.0 && draft.optional("seat_leak_kg_d").is_some() {
        let reason = "the closed seat would let more through than the open element";
        draft.refuse("seat_leak_kg_d", format_args!("{reason}"));
    }
    opening.clamp(TIGHT, 1.0) as f32
}

/// Refuses a leakage opening outside 1e-18 … 1.
pub(super) fn check(opening: f32) -> Result<(), ParameterError> {
    ParameterError::unless_fraction("leakage_opening", opening)?;
    if opening < LEAST_LEAKAGE {
        return Err(ParameterError { parameter: "leakage_opening", reason: Reason::OutsideValidity });
    }
    Ok(())
}

/// Refuses a leakage opening of a quadratic loss whose closed resistance has no finite square.
pub(super) fn check_closed(opening: f32, open_resistance: f32) -> Result<(), ParameterError> {
    check(opening)?;
    // R·w² with w ≤ 1e3 kg/s.
    if (open_resistance / (opening * opening) * 1e6).is_finite() {
        return Ok(());
    }
    Err(ParameterError { parameter: "leakage_opening", reason: Reason::OutsideValidity })
}
