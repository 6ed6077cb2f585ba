//! What hardware in the loop sees: the process image and its channels.

use serde::Serialize;

/// Table `[process]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ProcessEntry {
    /// `latched` or `immediate`; latched when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// Ticks of silence after which the plant goes to SAFE; [`crate::limits::SAFE_AFTER_TICKS`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe_after_ticks: Option<f64>,
    /// Part of its range by which no output may move for INIT to be over \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settled_part: Option<f64>,
    /// For how long \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settled_s: Option<f64>,
}

/// Table `[[channel]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelEntry {
    /// The input or point, as in `valve.opening` or `loop.mass_flow`.
    pub bind: String,
    /// `in` (hardware to plant) or `out`.
    pub direction: String,
    /// Number of the board's converter; through the link when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub analog: Option<f64>,
    /// Pairs of raw count and volts or milliamperes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub electrical: Vec<(f64, f64)>,
    /// Pairs of volts or milliamperes and the point's unit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scale: Vec<(f64, f64)>,
    /// Smallest and largest electrical value of a sound wire.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wire: Option<(f64, f64)>,
    /// Number of the calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration_id: Option<String>,
    /// Its day, as in `2026-01-31`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration_date: Option<String>,
    /// Smallest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Fastest change [unit/s]; any when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_rate_per_s: Option<f64>,
    /// What is taken or given when nothing better is known.
    pub safe_value: f64,
    /// How fast it goes there and back [unit/s]; through the range in a second when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe_rate_per_s: Option<f64>,
    /// What only inputs have.
    #[serde(flatten)]
    pub input: InputKeys,
}

/// Keys of a `[[channel]]` with direction `in`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct InputKeys {
    /// `reject` or `limit` what is out of range; reject when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond: Option<String>,
    /// Time constant of the filter [s]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter_s: Option<f64>,
    /// `zero` or `linear`; zero when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold: Option<String>,
    /// Ticks without a sample that a linear hold goes on; 1 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolate_ticks: Option<f64>,
    /// Change beyond which there is no slope; a tenth of the range when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub event_step: Option<f64>,
    /// Ticks without a sample after which the input is lost; [`crate::limits::STALE_TICKS`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stale_ticks: Option<f64>,
    /// `safe` or `go_on`: what its loss leads to; safe when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss: Option<String>,
}
