//! Units and forms of figures: SI as published, and the unit that people read.

use crate::InputSpec;

/// Form of a figure: its SI unit, and how people read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Display {
    /// Pressure over the network's reference [Pa].
    GaugePressure,
    /// Pressure over vacuum [Pa].
    AbsolutePressure,
    /// Partial pressure [Pa].
    PartialPressure,
    /// Difference of two pressures [Pa].
    PressureDifference,
    /// Mass flow of a gas, or of what a line carries [kg/s].
    MassFlow,
    /// Mass flow of a liquid [kg/s].
    LiquidFlow,
    /// Small mass flow, such as condensate or make-up gas [kg/s].
    Trickle,
    /// Volume flow [m³/s].
    VolumeFlow,
    /// Temperature [K].
    Temperature,
    /// Difference of two temperatures [K].
    TemperatureDifference,
    /// Mass [kg].
    Mass,
    /// Power [W].
    Heat,
    /// Time [s].
    Time,
    /// Share [1], read in per cent.
    Ratio,
    /// Whole number, such as people, a code, or 1 for yes [1].
    Count,
    /// Number [1].
    Number,
    /// Anything else, in this unit.
    Other(&'static str),
}

/// Unit that people read: `factor` times the SI value, plus `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// The unit.
    pub unit: &'static str,
    /// Reference of a pressure: `abs`, `gauge`, or nothing where the name says it.
    pub datum: &'static str,
    /// See [`Shown`].
    pub factor: f64,
    /// See [`Shown`].
    pub offset: f64,
}

impl Display {
    /// SI unit of the values; `1` for a ratio.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::GaugePressure
            | Self::AbsolutePressure
            | Self::PartialPressure
            | Self::PressureDifference => "Pa",
            Self::MassFlow | Self::LiquidFlow | Self::Trickle => "kg/s",
            Self::VolumeFlow => "m³/s",
            Self::Temperature | Self::TemperatureDifference => "K",
            Self::Mass => "kg",
            Self::Heat => "W",
            Self::Time => "s",
            Self::Ratio | Self::Count | Self::Number => "1",
            Self::Other(unit) => unit,
        }
    }

    /// Suffix of a column's name, as `_gauge_pa`.
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::GaugePressure => "_gauge_pa",
            Self::AbsolutePressure | Self::PartialPressure | Self::PressureDifference => "_pa",
            Self::MassFlow | Self::LiquidFlow | Self::Trickle => "_kg_s",
            Self::VolumeFlow => "_m3_s",
            Self::Temperature | Self::TemperatureDifference => "_k",
            Self::Mass => "_kg",
            Self::Heat => "_w",
            Self::Time => "_s",
            Self::Ratio | Self::Count | Self::Number | Self::Other(_) => "",
        }
    }

    /// Name of the form, for programs that know more units.
    pub const fn name(self) -> &'static str {
        match self {
            Self::GaugePressure => "gauge_pressure",
            Self::AbsolutePressure => "absolute_pressure",
            Self::PartialPressure => "partial_pressure",
            Self::PressureDifference => "pressure_difference",
            Self::MassFlow => "mass_flow",
            Self::LiquidFlow => "liquid_flow",
            Self::Trickle => "trickle",
            Self::VolumeFlow => "volume_flow",
            Self::Temperature => "temperature",
            Self::TemperatureDifference => "temperature_difference",
            Self::Mass => "mass",
            Self::Heat => "heat",
            Self::Time => "time",
            Self::Ratio => "ratio",
            Self::Count => "count",
            Self::Number => "number",
            Self::Other(_) => "other",
        }
    }

    /// Unit that people read.
    pub const fn shown(self) -> Shown {
        let (unit, factor, offset) = match self {
            Self::MassFlow | Self::LiquidFlow => ("g/s", 1e3, 0.0),
            Self::Trickle => ("g/h", 3.6e6, 0.0),
            Self::VolumeFlow => ("l/s", 1e3, 0.0),
            Self::Temperature => ("°C", 1.0, -273.15),
            Self::Ratio => ("%", 100.0, 0.0),
            other => (other.unit(), 1.0, 0.0),
        };
        let datum = match self {
            Self::GaugePressure => "gauge",
            Self::AbsolutePressure => "abs",
            _ => "",
        };
        Shown { unit, datum, factor, offset }
    }

    /// Form of the difference of two such figures, such as an offset of a sensor.
    #[must_use]
    pub const fn difference(self) -> Self {
        match self {
            Self::Temperature => Self::TemperatureDifference,
            Self::GaugePressure | Self::AbsolutePressure | Self::PartialPressure => Self::PressureDifference,
            other => other,
        }
    }

    /// Form of what an input takes. Flows from outside into a volume are trickles.
    pub(super) fn of_input(input: &InputSpec) -> Self {
        match (input.unit, input.name) {
            ("K", _) => Self::Temperature,
            ("Pa", _) => Self::PressureDifference,
            ("kg/s", "coolant_flow") => Self::LiquidFlow,
            ("kg/s", "measured_flow") => Self::MassFlow,
            ("kg/s", _) => Self::Trickle,
            ("m³/s", _) => Self::VolumeFlow,
            ("kg", _) => Self::Mass,
            ("W", _) => Self::Heat,
            ("s", _) => Self::Time,
            ("1", "opening" | "speed" | "fouling" | "efficiency" | "separator_efficiency") => Self::Ratio,
            ("1", "count" | "activity" | "discharge" | "fault" | "sensor_fault" | "actuator_fault") => {
                Self::Count
            }
            ("1", _) => Self::Number,
            (unit, _) => Self::Other(unit),
        }
    }
}
