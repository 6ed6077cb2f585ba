//! Limits and defaults of the format, as `docs/network-file.md` lists them.
//!
//! The ranges are wide: they keep out slips of unit and of sign, and whatever would leave the range in which
//! a run is trusted at its first step.

use std::fmt;
use std::ops::RangeInclusive;

/// Largest file [bytes].
pub const FILE_BYTES: usize = 32 << 20;
/// Largest number of problems of a file that are listed; the others are counted.
pub const FINDINGS: usize = 100;
/// Most nodes in a file.
pub const NODES: usize = 16_384;
/// Most lines in a file.
pub const LINES: usize = 32_768;
/// Most elements in a file.
pub const ELEMENTS: usize = 65_536;
/// Most schedules in a file.
pub const SCHEDULES: usize = 4_096;
/// Most points of all schedules in a file.
pub const SCHEDULE_POINTS: usize = 65_536;
/// Most channels in each direction.
pub const CHANNELS: usize = eclss_core::process::CHANNELS;
/// Most points of a channel's table.
pub const TABLE_POINTS: usize = 256;
/// Longest number of a calibration [bytes].
pub const CALIBRATION_BYTES: usize = 64;
/// Ticks without a sample after which an input is lost when its file does not say.
pub const STALE_TICKS: f64 = 10.0;
/// Ticks of silence after which the plant goes to SAFE when its file does not say.
pub const SAFE_AFTER_TICKS: f64 = 20.0;
/// Ticks for which a linear hold goes on when its file does not say.
pub const EXTRAPOLATE_TICKS: f64 = 1.0;
/// Longest id [bytes].
pub const ID_BYTES: usize = 48;

/// Driving pressure below which a line is linear when its file does not say [Pa].
pub const LAMINAR_BELOW_PA: f64 = 1e-3;
/// Default method.
pub const METHOD: &str = "relaxation";
/// Default step.
pub const STEP: &str = "1ms";
/// Default end of a run.
pub const UNTIL: &str = "60s";

/// Range of a number with its unit, for reading and for the message that refuses.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Allowed values, in `unit`.
    pub values: RangeInclusive<f64>,
    /// Unit, `1` for a ratio.
    pub unit: &'static str,
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} … {}", short(*self.values.start()), short(*self.values.end()))?;
        if self.unit == "1" { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// A number as people write it: with an exponent where it is very small or large, and with no more digits than the
/// single precision that it comes from.
pub(crate) fn short(number: f64) -> String {
    let plain = number == 0.0 || (1e-3..1e4).contains(&number.abs());
    let single = number as f32;
    match (plain, f64::from(single).to_bits() == number.to_bits()) {
        (true, true) => format!("{single}"),
        (true, false) => format!("{number}"),
        (false, true) => format!("{single:e}"),
        (false, false) => format!("{number:e}"),
    }
}

const fn range(from: f64, to: f64, unit: &'static str) -> Range {
    Range { values: from..=to, unit }
}

/// Absolute pressures and pressure rises.
pub const PRESSURE: Range = range(0.0, 1e7, "Pa");
/// Temperatures.
pub const TEMPERATURE: Range = range(50.0, 2e3, "K");
/// Volumes of nodes.
pub const NODE_VOLUME: Range = range(1e-6, 1e6, "m³");
/// Volumes inside a line.
pub const OUTLET_VOLUME: Range = range(0.0, 1e3, "m³");
/// Columns and rows of drawings.
pub const POSITION: Range = range(0.0, 63.0, "1");
/// Mass flows.
pub const MASS_FLOW: Range = range(-1e3, 1e3, "kg/s");
/// Densities.
pub const DENSITY: Range = range(1e-6, 2e4, "kg/m³");
/// Lengths.
pub const LENGTH: Range = range(0.0, 1e4, "m");
/// Diameters.
pub const DIAMETER: Range = range(1e-4, 1e2, "m");
/// Areas.
pub const AREA: Range = range(1e-8, 1e4, "m²");
/// Inertances.
pub const INERTANCE: Range = range(0.0, 1e12, "1/m");
/// Fractions, efficiencies and openings.
pub const FRACTION: Range = range(0.0, 1.0, "1");
/// Times of a schedule.
pub const TIME: Range = range(0.0, 1e9, "s");
/// Times of which there must be some.
pub const SOME_TIME: Range = range(1e-6, 1e9, "s");
/// Rates of change of a controller's output.
pub const OUTPUT_RATE: Range = range(1e-9, 1e9, "1/s");
/// Temperatures for which moist air is known.
pub const MOIST_TEMPERATURE: Range = range(273.15, 333.15, "K");
/// Specific heats.
pub const SPECIFIC_HEAT: Range = range(100.0, 1e5, "J/(kg·K)");
/// Thermal expansion of liquids.
pub const EXPANSION: Range = range(0.0, 5e-3, "1/K");
/// Bulk moduli of liquids.
pub const BULK_MODULUS: Range = range(1e3, 1e12, "Pa");
/// Stiffness of an accumulator's spring.
pub const STIFFNESS: Range = range(1.0, 1e15, "Pa/m³");
/// Seeds.
pub const SEED: Range = range(0.0, 16_777_215.0, "1");
/// Most sources, crews, removers, walls and control loops, each.
pub const PARTS: usize = 4_096;
/// Reference temperature of energies when the file does not say [K].
pub const REFERENCE_K: f64 = 295.15;
/// Longest turnover of a mixed volume when the file does not say [s] (assumed: half an hour).
pub const MIXING_LIMIT_S: f64 = 1_800.0;
/// Evaporation of free water when the file does not say [kg/(s·Pa)] (assumed: about 1 m² of wet surface).
pub const SURFACE_KG_S_PA: f64 = 2e-8;

/// Range of an input.
pub fn of(spec: &eclss_core::InputSpec) -> Range {
    range(f64::from(spec.min), f64::from(spec.max), spec.unit)
}

/// Values of a schedule, before the input's own range is known.
pub const ANY: Range = range(f64::MIN, f64::MAX, "1");
/// Time constants of filters.
pub const FILTER: Range = range(0.0, 1e3, "s");
/// Numbers of ticks.
pub const TICKS: Range = range(1.0, 6e4, "1");
/// Part of its range by which an output of a settled plant may move \[1\].
pub const SETTLED_PART: Range = range(1e-7, 1.0, "1");
/// Time for which it may not move further [s].
pub const SETTLED_S: Range = range(0.0, 3600.0, "s");
/// Numbers of ticks that may be none.
pub const SOME_TICKS: Range = range(0.0, 6e4, "1");
/// Numbers of a board's converters.
pub const CONVERTER: Range = range(0.0, eclss_core::process::CONVERTERS as f64 - 1.0, "1");
/// Rates and steps of a channel, in its unit.
pub const RATE: Range = range(1e-9, 1e12, "1");
