//! Heat, moisture, composition and control in a document.

use std::collections::BTreeMap;

use serde::Serialize;

use super::element::Entry;

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

/// Table of a component at a node, such as `[[crew]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartEntry {
    /// Id, unique in the file.
    pub id: String,
    /// Id of its node.
    pub node: String,
    /// Keys of its kind.
    #[serde(flatten)]
    pub entry: Entry,
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
