//! Reads what a climate holds and shows, for reports, records and ledgers.

use super::buffers::{Seen, Work};
use super::monitor::{Broken, FOGGED, Limit};
use super::volume::{self, Contents, Figures, LEAST_FRACTION};
use super::{Climate, Volume};
use crate::component::{Placed, Range, Seen as Block, Table};
use crate::fluid::medium::{self, CARBON_DIOXIDE, LIQUID, NITROGEN, OXYGEN, PARTS, Parts, TRACE, VAPOUR};
use crate::fluid::{ENERGY, STORED};
use crate::moist;
use crate::signal::{self, Owner, Signal};
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

/// Figures of a volume of air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Readings {
    /// Temperature [K].
    pub temperature_k: f32,
    /// Absolute pressure [Pa].
    pub pressure_pa: f32,
    /// Partial pressures of the gases, in the order of the parts [Pa].
    pub partial_pa: Parts,
    /// Dew point [K].
    pub dew_point_k: f32,
    /// Relative humidity [1].
    pub relative_humidity: f32,
    /// Free liquid water [kg].
    pub liquid_kg: f32,
    /// Time in which what flows in turns the volume over [s]; infinite without flow.
    pub turnover_s: f32,
    /// Whether a single well-mixed volume still describes it.
    pub mixed: bool,
}

/// Rows that figures of volumes and placed components are read from, within a step or after it.
#[derive(Clone, Copy)]
pub(super) struct Rows<'r> {
    figures: &'r [Figures],
    fractions: &'r [Parts],
    passed: &'r [[f32; 2]],
    components: &'r [f32],
    scratch: &'r [f32],
}

impl<'r> Rows<'r> {
    pub(super) fn of(work: &'r Work<'_>, components: &'r [f32]) -> Self {
        let Work { figures, fractions, passed, scratch, .. } = work;
        Self { figures, fractions, passed, components, scratch }
    }

    /// A figure of a volume or a placed component; NaN for any other.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a sensor of a step that may be specialised")]
    pub(super) fn read(self, climate: &Climate<'_>, step_s: f32, signal: Signal) -> f32 {
        let (owner, item) = (signal.owner as usize, usize::from(signal.item));
        match signal.output.owner() {
            Owner::Volume | Owner::Air => self
                .volume(climate, step_s, owner)
                .map_or(f32::NAN, |volume| signal::volume(signal.output, &volume, item)),
            Owner::Component => climate.component(signal.owner).map_or(f32::NAN, |(table, placed)| {
                let step = climate.context(step_s, &[]);
                signal::component(
                    signal.output,
                    table.kind().output(item, placed, &step, self.block(signal.owner, table)),
                )
            }),
            _ => f32::NAN,
        }
    }

    /// State and scratch of placed component `index`, one of `table`.
    fn block(self, index: u32, table: &Table) -> Block<'r> {
        let Range { first, first_state, first_scratch, blocks: [state, scratch], .. } = table.range;
        let place = index.saturating_sub(first);
        Block {
            state: self.components.get(Range::words(first_state, state, place)).unwrap_or(&[]),
            scratch: self.scratch.get(Range::words(first_scratch, scratch, place)).unwrap_or(&[]),
        }
    }

    fn volume(self, climate: &'r Climate<'_>, step_s: f32, node: usize) -> Option<VolumeView<'r>> {
        Some(VolumeView {
            volume: climate.volumes.get(node)?,
            figures: self.figures.get(node)?,
            fractions: self.fractions.get(node)?,
            passed: self.passed.get(node)?,
            reference_k: climate.reference_k,
            step_s,
        })
    }
}

/// One volume, of which every figure is computed when it is read.
pub(crate) struct VolumeView<'v> {
    volume: &'v Volume,
    figures: &'v Figures,
    fractions: &'v Parts,
    passed: &'v [f32; 2],
    reference_k: f32,
    step_s: f32,
}

impl VolumeView<'_> {
    /// Temperature [K].
    pub(crate) fn temperature_k(&self) -> f32 {
        self.reference_k + self.figures[0]
    }

    /// Absolute pressure [Pa].
    pub(crate) fn pressure_pa(&self) -> f32 {
        self.figures[1]
    }

    /// Partial pressure of a part [Pa].
    pub(crate) fn partial_pa(&self, part: usize) -> f32 {
        medium::partial_pressure_pa(part, self.fractions, self.pressure_pa())
    }

    /// Dew point [K].
    pub(crate) fn dew_point_k(&self) -> f32 {
        moist::dew_point_k(self.partial_pa(VAPOUR))
    }

    /// Relative humidity [1].
    pub(crate) fn relative_humidity(&self) -> f32 {
        moist::relative_humidity(self.partial_pa(VAPOUR), self.temperature_k())
    }

    /// Density of the gas that flows out [kg/m³].
    pub(crate) fn density_kg_m3(&self) -> f32 {
        let gas_j_kg_k = medium::dot(self.fractions, &medium::GAS_CONSTANTS_J_KG_K);
        self.pressure_pa() / (gas_j_kg_k * self.temperature_k())
    }

    /// Free liquid water [kg].
    pub(crate) fn liquid_kg(&self) -> f32 {
        self.figures[2] * self.fractions[LIQUID]
    }

    /// Time in which what flows in turns the volume over [s]; infinite without flow.
    pub(crate) fn turnover_s(&self) -> f32 {
        let inflow_kg_s = self.passed[0] / self.step_s;
        if inflow_kg_s > 0.0 { self.figures[2] / inflow_kg_s } else { f32::INFINITY }
    }

    /// Whether a single well-mixed volume still describes it.
    pub(crate) fn mixed(&self) -> bool {
        self.turnover_s() <= self.volume.mixing_limit_s
    }

    fn readings(&self) -> Readings {
        let mut partial_pa = [0.0; PARTS];
        for (part, partial) in partial_pa.iter_mut().enumerate() {
            *partial = self.partial_pa(part);
        }
        Readings {
            temperature_k: self.temperature_k(),
            pressure_pa: self.pressure_pa(),
            partial_pa,
            dew_point_k: self.dew_point_k(),
            relative_humidity: self.relative_humidity(),
            liquid_kg: self.liquid_kg(),
            turnover_s: self.turnover_s(),
            mixed: self.mixed(),
        }
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

    fn rows(&self) -> Rows<'_> {
        let Seen { figures, fractions, passed, components, scratch, .. } = self.seen;
        Rows { figures, fractions, passed, components, scratch }
    }

    /// A figure of a volume or a placed component.
    pub(crate) fn read(&self, signal: Signal) -> f32 {
        self.rows().read(self.climate, self.step_s, signal)
    }

    /// Density of what a volume of air holds [kg/m³].
    pub(crate) fn density_kg_m3(&self, node: usize) -> Option<f32> {
        Some(self.rows().volume(self.climate, self.step_s, node)?.density_kg_m3())
    }

    /// Reading and position of a control loop, each in its own unit.
    pub(crate) fn control(&self, index: usize) -> Option<[f32; 2]> {
        let [_, reading, _, _, _, _, position, _] = *self.seen.loops.get(index)?;
        Some([reading, position])
    }

    /// What a volume of air shows; `None` for one that does not exist or holds coolant.
    pub(crate) fn air(&self, node: usize) -> Option<Readings> {
        let air = self.rows().volume(self.climate, self.step_s, node)?;
        (air.volume.contents == Contents::Air).then(|| air.readings())
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

    /// Masses and energy that all placed components hold beyond their start.
    fn held_by_components(&self) -> [f64; STORED] {
        let mut sums = [0.0; STORED];
        let rows = self.rows();
        for table in self.climate.tables {
            let placed: &[Placed] = self.climate.placed_of(table);
            for (index, placed) in (table.range.first..).zip(placed) {
                table.kind().holds(&placed.row, rows.block(index, table).state, &mut |part, held| {
                    if let Some(sum) = sums.get_mut(part) {
                        *sum += f64::from(held);
                    }
                });
            }
        }
        sums
    }

    /// The ledgers: gases, water, coolant, energy.
    pub(crate) fn ledgers(&self) -> [Ledger; 7] {
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
        let own = self.held_by_components();
        let gas =
            |name, part| ledger(name, "kg", stored(part, Some(Contents::Air)) + own[part], booked(&[part]));
        let water = stored(VAPOUR, Some(Contents::Air))
            + stored(LIQUID, Some(Contents::Air))
            + own[VAPOUR]
            + own[LIQUID];
        let energy = stored(ENERGY, None) + own[ENERGY];
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
