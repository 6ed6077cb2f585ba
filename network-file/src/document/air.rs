//! Heat, moisture, composition and control in a document.

use std::collections::BTreeMap;

use serde::Serialize;

/// Start values of inputs by their names; those that are absent start at their defaults.
pub type Starts = BTreeMap<&'static str, f64>;

/// Table `[air]`: its presence gives volumes temperature, moisture and composition.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct AirEntry {
    /// Temperature from which energies count [K]; [`crate::limits::REFERENCE_K`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_temperature_k: Option<f64>,
    /// Specific heat of the coolant [J/(kg·K)]; water's when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coolant_heat_j_kg_k: Option<f64>,
    /// How much of its volume the coolant gains per kelvin [1/K]; nothing when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coolant_expansion_1_k: Option<f64>,
}

/// What a node holds at the start.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ContentsEntry {
    /// `air` or `coolant`, for a boundary; air when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contents: Option<String>,
    /// Partial pressure of oxygen [Pa]; its share of dry air when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oxygen_pa: Option<f64>,
    /// Partial pressure of carbon dioxide [Pa]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carbon_dioxide_pa: Option<f64>,
    /// Partial pressure of trace gases [Pa]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace_pa: Option<f64>,
    /// Dew point [K]; dry when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dew_point_k: Option<f64>,
    /// Longest time of turnover in which the volume counts as mixed [s]; [`crate::limits::MIXING_LIMIT_S`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mixing_limit_s: Option<f64>,
    /// Evaporation of free water per pressure difference [kg/(s·Pa)]; [`crate::limits::SURFACE_KG_S_PA`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_kg_s_pa: Option<f64>,
}

/// What a condensing heat exchanger is beside its loss; the station's where nothing is said.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CoilEntry {
    /// Conductance of the air's side at the reference flow [W/K].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air_w_k: Option<f64>,
    /// Reference flow of dry air [kg/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air_reference_kg_s: Option<f64>,
    /// Exponent of the air's flow [1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air_exponent: Option<f64>,
    /// Conductance of the coolant's side at the reference flow [W/K].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coolant_w_k: Option<f64>,
    /// Reference flow of coolant [kg/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coolant_reference_kg_s: Option<f64>,
    /// Heat capacity of the walls [J/K].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capacity_j_k: Option<f64>,
    /// Water that the films hold [kg].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film_kg: Option<f64>,
    /// Temperature of the walls at the start [K]; that of the line's `from` node when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature_k: Option<f64>,
    /// Water that the separator holds [kg].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub separator_kg: Option<f64>,
    /// Time between two discharges [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discharge_s: Option<f64>,
    /// Water that leaves at once when the separator loses it [kg].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slug_kg: Option<f64>,
    /// Start values of its inputs.
    #[serde(flatten)]
    pub starts: Starts,
}

/// What a liquid-to-liquid heat exchanger is beside its loss.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlatesEntry {
    /// Conductance of the line's own side at its reference flow [W/K].
    pub liquid_w_k: f64,
    /// Reference flow of that side [kg/s].
    pub liquid_reference_kg_s: f64,
    /// Conductance of the other side at its reference flow [W/K].
    pub coolant_w_k: f64,
    /// Reference flow of the other side [kg/s].
    pub coolant_reference_kg_s: f64,
    /// Heat capacity of the plates [J/K]; the condenser's when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capacity_j_k: Option<f64>,
    /// Temperature of the plates at the start [K]; that of the line's `from` node when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature_k: Option<f64>,
    /// Start values of its inputs.
    #[serde(flatten)]
    pub starts: Starts,
}

/// Table `[[source]]`, `[[crew]]`, `[[remover]]` or `[[wall]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartEntry {
    /// Id, unique in the file.
    pub id: String,
    /// Id of its node.
    pub node: String,
    /// What is removed, for a remover.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Figures of a wall.
    #[serde(flatten)]
    pub wall: Option<WallEntry>,
    /// Start values of its inputs.
    #[serde(flatten)]
    pub starts: Starts,
}

/// Figures of a wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WallEntry {
    /// Heat capacity [J/K].
    pub capacity_j_k: f64,
    /// Conductance to the node [W/K].
    pub inner_w_k: f64,
    /// Conductance to the surroundings [W/K].
    pub outer_w_k: f64,
    /// Temperature at the start [K].
    pub temperature_k: f64,
}

/// Table `[[control]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ControlEntry {
    /// Id, unique in the file.
    pub id: String,
    /// What its sensor looks at, as in `cabin.temperature`.
    pub measures: String,
    /// The input that its actuator drives, as in `tccv.opening`.
    pub drives: String,
    /// The input that gets what is left, for the other way of a three-way valve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opposite: Option<String>,
    /// The controller.
    #[serde(flatten)]
    pub kind: ControlKind,
    /// Value of the driven input at position 0.
    pub closed: f64,
    /// Value of the driven input at position 1.
    pub open: f64,
    /// Time of full travel of the actuator [s]; 1 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel_s: Option<f64>,
    /// Least change of position that moves it [1]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiction: Option<f64>,
    /// Lowest reading of the sensor.
    pub sensor_min: f64,
    /// Highest reading of the sensor.
    pub sensor_max: f64,
    /// Lag of the sensor [s]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_lag_s: Option<f64>,
    /// Standard deviation of the sensor's noise; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_noise: Option<f64>,
    /// Seed of the noise; made of the id when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<f64>,
    /// Start values of its inputs, the set point among them.
    #[serde(flatten)]
    pub starts: Starts,
}

/// Kinds of controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ControlKind {
    /// Continuous.
    Pid {
        /// Share of the output per unit of the reading; below 0 for a controller that acts against a high reading.
        gain: f64,
        /// Integral time [s]; none when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        integral_s: Option<f64>,
        /// Derivative time [s]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        derivative_s: Option<f64>,
        /// Half width of the dead band; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        dead_band: Option<f64>,
        /// Output without error [1]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        bias: Option<f64>,
        /// Fastest change of the output [1/s]; unlimited when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        rate_per_s: Option<f64>,
    },
    /// On and off.
    Thermostat {
        /// Half width of the hysteresis.
        half_band: f64,
        /// `high` or `low`: the reading that switches on.
        on_when: String,
    },
}
