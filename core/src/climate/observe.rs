//! Reads what a climate holds and shows, for reports, records and ledgers.

use super::buffers::Seen;
use super::medium::{CARBON_DIOXIDE, LIQUID, NITROGEN, OXYGEN, TRACE, VAPOUR};
use super::monitor::{Broken, FOGGED, Limit};
use super::volume::{self, Contents, ENERGY, LEAST_FRACTION};
use super::{Climate, ExchangerReadings, Readings, condenser::Cells};
use crate::moist;
use crate::simulator::{Excursion, Strayed};

/// One ledger: what the network holds beyond its start, and what came from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ledger {
    /// What is counted.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Held by volumes, walls, films, separators and tanks beyond the start, owed by slowed volumes included.
    pub held: f64,
    /// Supplied from outside since the start.
    pub supplied: f64,
    /// All that was supplied or removed since the start, without sign.
    pub turned_over: f64,
}

impl Ledger {
    /// What arithmetic lost.
    pub fn gap(&self) -> f64 {
        self.held - self.supplied
    }
}

/// Reads a climate's buffers.
pub(crate) struct Observed<'o, 'n> {
    climate: &'o Climate<'n>,
    seen: Seen<'o>,
    step_s: f32,
}

impl<'o, 'n> Observed<'o, 'n> {
    pub(crate) fn of(climate: &'o Climate<'n>, state: &'o [f32], work: &'o [f32], step_s: f32) -> Self {
        Self { climate, seen: Seen::of(climate, state, work), step_s }
    }

    /// What a volume of air shows; `None` for one that does not exist or holds coolant.
    pub(crate) fn air(&self, node: usize) -> Option<Readings> {
        let volume = self.climate.volumes.get(node).filter(|volume| volume.contents == Contents::Air)?;
        let (figures, fractions) = (self.seen.figures.get(node)?, self.seen.fractions.get(node)?);
        let [inward, _] = *self.seen.passed.get(node)?;
        Some(Readings::of(volume, figures, fractions, self.climate.reference_k, inward / self.step_s))
    }

    /// Temperature of a volume [K].
    pub(crate) fn temperature_k(&self, node: usize) -> Option<f32> {
        self.seen.figures.get(node).map(|[theta, ..]| self.climate.reference_k + theta)
    }

    /// What of a volume left its range, if something did.
    pub(crate) fn excursion(&self, node: usize) -> Option<Excursion> {
        let volume = self.climate.volumes.get(node)?;
        let (figures, fractions) = (self.seen.figures.get(node)?, self.seen.fractions.get(node)?);
        let [theta, _, mass, ..] = *figures;
        let theta_range = [volume::LEAST_K, volume::MOST_K];
        if theta.is_nan() {
            let value = self.climate.reference_k + theta;
            return Some(Excursion { quantity: Strayed::Temperature, value, range: theta_range });
        }
        if !(f32::MIN_POSITIVE..=f32::MAX).contains(&mass) {
            return Some(Excursion { quantity: Strayed::Mass, value: mass, range: [0.0, f32::INFINITY] });
        }
        let (part, least) = (0u32..).zip(fractions).min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let value = least * mass;
        let range = [0.0, f32::INFINITY];
        (value < -LEAST_FRACTION * volume.start_kg).then_some(Excursion {
            quantity: Strayed::Part(part),
            value,
            range,
        })
    }

    /// What makes the figures of a volume doubtful, whoever is there: held temperature, fog, vacuum, ice.
    pub(crate) fn warnings(&self, node: usize) -> Broken {
        let mut broken = Broken::default();
        let (Some(volume), Some([_, _, mass, ..])) =
            (self.climate.volumes.get(node), self.seen.figures.get(node))
        else {
            return broken;
        };
        // A held temperature is the limit, but for rounding.
        let inside = volume::LEAST_K + 1e-3..volume::MOST_K - 1e-3;
        broken.set(Limit::Held, self.temperature_k(node).is_some_and(|kelvin| !inside.contains(&kelvin)));
        if volume.contents == Contents::Coolant {
            // A coolant with the specific heat of water is taken for water.
            let [heat, ..] = self.climate.coolant.flowing_j_kg_k;
            let water = (moist::LIQUID_HEAT_J_KG_K - 1.0..moist::LIQUID_HEAT_J_KG_K + 1.0).contains(&heat);
            let cold = self.temperature_k(node).is_some_and(|kelvin| kelvin < moist::ZERO_CELSIUS_K);
            broken.set(Limit::Ice, water && cold);
        }
        if let Some(air) = self.air(node) {
            broken.set(Limit::Fog, air.relative_humidity > FOGGED);
            broken.set(Limit::Vacuum, *mass <= 1.01 * volume::THIN * volume.start_kg);
        }
        broken
    }

    /// Storage factor φ of a volume's masses and energy in the last step [1].
    pub(crate) fn phi(&self, node: usize) -> Option<f32> {
        self.seen.figures.get(node).map(|[.., phi]| *phi)
    }

    /// Mass of a volume as deviation from the start [kg].
    pub(crate) fn mass_kg(&self, node: usize) -> Option<f64> {
        let (value, carry) = (self.seen.value.get(node)?, self.seen.carry.get(node)?);
        Some((NITROGEN..=LIQUID).map(|part| f64::from(value[part]) - f64::from(carry[part])).sum())
    }

    /// What an exchanger shows.
    pub(crate) fn exchanger(&self, index: usize) -> Option<ExchangerReadings> {
        let walls = self.seen.coils.get(index)?;
        let (stores, shown) = (self.seen.stores.get(index)?, self.seen.shown.get(index)?);
        Some(ExchangerReadings::of(stores, shown, walls, self.climate.reference_k, self.step_s))
    }

    /// The ledgers: gases, water, coolant, energy.
    pub(crate) fn ledgers(&self) -> [Ledger; 7] {
        let sum = |pair: &[f32]| {
            pair.first().map_or(0.0, |a| f64::from(*a)) - pair.get(1).map_or(0.0, |b| f64::from(*b))
        };
        let stored = |place: usize, contents: Option<Contents>| {
            let mut held = 0.0;
            for (index, volume) in self.climate.volumes.iter().enumerate() {
                let rows = [
                    (self.seen.value.get(index), 1.0),
                    (self.seen.carry.get(index), -1.0),
                    (self.seen.owed.get(index), 1.0),
                    (self.seen.owed_carry.get(index), -1.0),
                ];
                if contents.is_none_or(|contents| volume.contents == contents) {
                    for (row, sign) in rows {
                        held += sign * row.map_or(0.0, |row| f64::from(row[place]));
                    }
                }
            }
            held
        };
        let booked = |places: &[usize]| {
            let mut sums = [0.0; 2];
            if let [supplied, s, turned, t] = self.seen.ledger {
                for &place in places {
                    sums[0] += f64::from(supplied[place]) - f64::from(s[place]);
                    sums[1] += f64::from(turned[place]) - f64::from(t[place]);
                }
            }
            sums
        };
        let ledger = |name, unit, held, [supplied, turned_over]: [f64; 2]| Ledger {
            name,
            unit,
            held,
            supplied,
            turned_over,
        };
        let gas = |name, part| ledger(name, "kg", stored(part, Some(Contents::Air)), booked(&[part]));
        let of_cells = |[sums, carries]: [&Cells; 2]| {
            sums.iter().zip(carries).map(|(sum, carry)| f64::from(*sum) - f64::from(*carry)).sum::<f64>()
        };
        let film: f64 = self.seen.coils.iter().map(|[_, _, film, carry]| of_cells([film, carry])).sum();
        let mut water = stored(VAPOUR, Some(Contents::Air)) + stored(LIQUID, Some(Contents::Air)) + film;
        let mut energy = stored(ENERGY, None);
        energy += self.seen.coils.iter().map(|[energy, carry, ..]| of_cells([energy, carry])).sum::<f64>();
        energy += self.seen.walls.iter().map(|wall| sum(wall)).sum::<f64>();
        for store in self.seen.stores {
            water += sum(&store[..2]) + sum(&store[2..4]) + sum(&store[4..6]);
            energy += sum(&store[6..8]) + sum(&store[8..10]);
        }
        [
            gas("nitrogen", NITROGEN),
            gas("oxygen", OXYGEN),
            gas("carbon_dioxide", CARBON_DIOXIDE),
            gas("trace", TRACE),
            ledger("water", "kg", water, booked(&[VAPOUR, LIQUID])),
            ledger("coolant", "kg", stored(NITROGEN, Some(Contents::Coolant)), [0.0; 2]),
            ledger("energy", "J", energy, booked(&[ENERGY])),
        ]
    }
}
