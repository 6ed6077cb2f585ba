//! Recorded points: names for everything that a run can write down.

use crate::loaded::{Loaded, Names};
use eclss_core::Line;
use eclss_core::climate::{Contents, Volume, medium};

/// One column of a run's output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Name in files and column heads, as in `valve.mass_flow`.
    pub name: String,
    /// What it is.
    pub quantity: Quantity,
}

/// What a recorded point is, by the core's indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Gauge pressure of a node [Pa].
    NodePressure {
        /// The node.
        node: usize,
    },
    /// Mass flow of a line at its flow segment [kg/s].
    LineFlow {
        /// The line.
        line: usize,
    },
    /// Mass flow at the inlet of a segment [kg/s].
    SegmentFlow {
        /// The line.
        line: usize,
        /// The segment, counted from the line's first.
        segment: usize,
    },
    /// Gauge pressure at the outlet of a segment [Pa].
    OutletPressure {
        /// The line.
        line: usize,
        /// The segment, counted from the line's first.
        segment: usize,
    },
    /// A figure of a volume, where there is `[air]`.
    Air {
        /// The node.
        node: usize,
        /// The figure.
        figure: AirFigure,
    },
    /// A figure of a condenser.
    Exchanger {
        /// The condenser.
        exchanger: usize,
        /// The figure.
        figure: ExchangerFigure,
    },
    /// Value of an input, in the input's unit.
    Input {
        /// The slot.
        slot: usize,
        /// The unit.
        unit: &'static str,
    },
}

/// Figures of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AirFigure {
    /// Temperature [K].
    Temperature,
    /// Dew point [K].
    DewPoint,
    /// Relative humidity [1].
    RelativeHumidity,
    /// Partial pressure of a part [Pa].
    Partial(usize),
    /// Free liquid water [kg].
    Liquid,
    /// Whether the volume counts as mixed, 1 or 0.
    Mixed,
}

impl AirFigure {
    /// All that a volume of air has.
    const OF_AIR: [Self; 9] = [
        Self::Temperature,
        Self::DewPoint,
        Self::RelativeHumidity,
        Self::Partial(medium::OXYGEN),
        Self::Partial(medium::CARBON_DIOXIDE),
        Self::Partial(medium::VAPOUR),
        Self::Partial(medium::TRACE),
        Self::Liquid,
        Self::Mixed,
    ];

    /// Name in files.
    fn name(self) -> &'static str {
        match self {
            Self::Temperature => "temperature",
            Self::DewPoint => "dew_point",
            Self::RelativeHumidity => "relative_humidity",
            Self::Partial(part) => medium::NAMES[part],
            Self::Liquid => "liquid",
            Self::Mixed => "mixed",
        }
    }
}

/// Figures of a condenser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangerFigure {
    /// Heat out of the air [W].
    Heat,
    /// Heat into the coolant [W].
    CoolantHeat,
    /// Water out of the air [kg/s].
    Condensate,
    /// Temperature of the air behind it [K].
    AirOutlet,
    /// Water in its films [kg].
    Film,
    /// Water in its separator [kg].
    Separator,
    /// Water in its tank [kg].
    Tank,
}

impl ExchangerFigure {
    const ALL: [Self; 7] = [
        Self::Heat,
        Self::CoolantHeat,
        Self::Condensate,
        Self::AirOutlet,
        Self::Film,
        Self::Separator,
        Self::Tank,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Heat => "heat",
            Self::CoolantHeat => "coolant_heat",
            Self::Condensate => "condensate",
            Self::AirOutlet => "air_outlet",
            Self::Film => "film",
            Self::Separator => "separator",
            Self::Tank => "tank",
        }
    }
}

impl Quantity {
    /// Unit of the values; `1` for a ratio.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::NodePressure { .. } | Self::OutletPressure { .. } => "Pa",
            Self::LineFlow { .. } | Self::SegmentFlow { .. } => "kg/s",
            Self::Air { figure, .. } => match figure {
                AirFigure::Temperature | AirFigure::DewPoint => "K",
                AirFigure::RelativeHumidity | AirFigure::Mixed => "1",
                AirFigure::Partial(_) => "Pa",
                AirFigure::Liquid => "kg",
            },
            Self::Exchanger { figure, .. } => match figure {
                ExchangerFigure::Heat | ExchangerFigure::CoolantHeat => "W",
                ExchangerFigure::Condensate => "kg/s",
                ExchangerFigure::AirOutlet => "K",
                ExchangerFigure::Film | ExchangerFigure::Separator | ExchangerFigure::Tank => "kg",
            },
            Self::Input { unit, .. } => unit,
        }
    }
}

impl Loaded {
    /// Everything that a run can write down: nodes, then lines with their elements, then inputs.
    pub fn all_records(&self) -> Vec<Record> {
        all(&self.names, &self.lines, &self.climate.volumes, &self.units)
    }
}

/// All recordable points of a network.
pub(crate) fn all(names: &Names, lines: &[Line], volumes: &[Volume], units: &[&'static str]) -> Vec<Record> {
    let record = |id: &str, what: &str, quantity| Record { name: format!("{id}.{what}"), quantity };
    let mut list = Vec::new();
    for (node, id) in names.nodes.iter().enumerate() {
        list.push(record(id, "pressure", Quantity::NodePressure { node }));
    }
    let mut elements = names.segments.iter();
    for (line, (id, data)) in names.lines.iter().zip(lines).enumerate() {
        list.push(record(id, "mass_flow", Quantity::LineFlow { line }));
        for (segment, id) in elements.by_ref().take(data.segments as usize).enumerate() {
            list.push(record(id, "mass_flow", Quantity::SegmentFlow { line, segment }));
            list.push(record(id, "outlet_pressure", Quantity::OutletPressure { line, segment }));
        }
    }
    for ((node, id), volume) in names.nodes.iter().enumerate().zip(volumes) {
        let figures =
            if volume.contents == Contents::Air { &AirFigure::OF_AIR[..] } else { &AirFigure::OF_AIR[..1] };
        for &figure in figures {
            list.push(record(id, figure.name(), Quantity::Air { node, figure }));
        }
    }
    for (exchanger, id) in names.exchangers.iter().enumerate() {
        for figure in ExchangerFigure::ALL {
            list.push(record(id, figure.name(), Quantity::Exchanger { exchanger, figure }));
        }
    }
    for ((slot, name), &unit) in names.inputs.iter().enumerate().zip(units) {
        list.push(Record { name: name.clone(), quantity: Quantity::Input { slot, unit } });
    }
    list
}
