//! Water separator behind a condensing coil: carry-over and discharge.
//!
//! Water that a coil's films cannot hold drains into a separator, which keeps the share ε and loses the rest into the
//! air stream. It collects until the next discharge to the condensate tank; water that comes while it is full is lost as
//! well. Lost water gathers into a slug and leaves for the volume behind the coil when the slug is whole: there it
//! lies free and evaporates.
//!
//! Source: P. Wieland, NASA TM-1998-206956 p. 104, and V-HAB: slurper and separator, discharge about every 75 min.
//! Hold-up, slug and discharge behaviour in microgravity are known in words only; their figures are parameters.

use super::coil::Drained;
use crate::math;

/// Fixed data of one separator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separator {
    /// Water that it holds between two discharges [kg]; finite and > 0.
    pub separator_kg: f32,
    /// Time between two discharges [s]; finite and > 0.
    pub discharge_s: f32,
    /// Water that leaves at once [kg]; finite and > 0.
    pub slug_kg: f32,
}

/// Stored figures of the water, each followed by its carry: separator, tank, slug [kg]; energy of separator and tank, of
/// the slug [J]; time since the last discharge [s].
pub(super) const STORES: usize = 12;

/// Moves the drained water of the coil into separator and slug, and discharges when it is time and `discharges`;
/// otherwise that discharge is missed. Returns the water that leaves for the volume behind.
pub(super) fn separate(
    exchanger: &Separator,
    stores: &mut [f32; STORES],
    drained: Drained,
    efficiency: f32,
    discharges: bool,
    step_s: f32,
) -> Drained {
    let [separator, s, tank, t, slug, l, kept_j, k, slug_j, j, time, c] = stores;
    let room = math::larger(exchanger.separator_kg - *separator, 0.0);
    let kept = math::smaller(efficiency * drained.water_kg, room);
    // Energy goes with the water.
    let share = if drained.water_kg > 0.0 { kept / drained.water_kg } else { 0.0 };
    let kept_energy = share * drained.energy_j;
    math::compensated_add(separator, s, kept);
    math::compensated_add(kept_j, k, kept_energy);
    math::compensated_add(slug, l, drained.water_kg - kept);
    math::compensated_add(slug_j, j, drained.energy_j - kept_energy);
    math::compensated_add(time, c, step_s);
    if *time >= exchanger.discharge_s {
        math::compensated_add(time, c, -exchanger.discharge_s);
        let discharged = if discharges { *separator } else { 0.0 };
        math::compensated_add(separator, s, -discharged);
        math::compensated_add(tank, t, discharged);
    }
    if *slug < exchanger.slug_kg {
        return Drained::default();
    }
    let released = Drained { water_kg: *slug, energy_j: *slug_j };
    math::compensated_add(slug, l, -released.water_kg);
    math::compensated_add(slug_j, j, -released.energy_j);
    released
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXCHANGER: Separator = Separator { separator_kg: 0.5, discharge_s: 100.0, slug_kg: 0.05 };

    fn run(efficiency: f32, seconds: u32) -> ([f32; STORES], f32, u32) {
        let (mut stores, mut released, mut slugs) = ([0.0; STORES], 0.0, 0);
        for _ in 0..10 * seconds {
            let drained = Drained { water_kg: 1e-3, energy_j: -2e3 };
            let out = separate(&EXCHANGER, &mut stores, drained, efficiency, true, 0.1);
            assert!(
                out.water_kg.abs() < f32::MIN_POSITIVE || (out.energy_j / out.water_kg + 2e6).abs() < 10.0
            );
            released += out.water_kg;
            slugs += u32::from(out.water_kg > 0.0);
        }
        (stores, released, slugs)
    }

    #[test]
    fn a_good_separator_discharges_by_the_clock_and_loses_nothing() {
        let (stores, released, _) = run(1.0, 40);
        assert!(released.abs() < f32::MIN_POSITIVE && (stores[0] - 0.4).abs() < 1e-4);
        // 10 g/s fill the separator in 50 s; what comes until the discharge at 100 s is lost.
        let ([separator, _, tank, _, slug, ..], released, _) = run(1.0, 101);
        assert!((tank - 0.5).abs() < 1e-3 && separator < 0.02, "{tank} {separator}");
        assert!((slug + released - 0.5).abs() < 2e-3, "{slug} {released}");
    }

    #[test]
    fn what_is_lost_leaves_in_slugs_and_nothing_vanishes() {
        let (stores, released, slugs) = run(0.6, 60);
        let [separator, _, tank, _, slug, ..] = stores;
        assert!((separator + tank + slug + released - 0.6).abs() < 1e-5);
        assert!(slugs >= 4, "{slugs}");
        assert!(slug < EXCHANGER.slug_kg);
    }
}
