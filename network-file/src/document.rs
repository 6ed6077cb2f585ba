//! The document: what stands in a network file, before any conversion.
//!
//! Numbers are `f64` in the unit that their key names, as written. Reading is strict and done by
//! [`crate::parse`]; writing is done here.

pub mod air;
pub mod channel;
pub mod element;

use std::collections::BTreeMap;

use serde::Serialize;

pub use self::channel::{ChannelEntry, InputKeys, ProcessEntry};
pub use self::element::{Entry, Value};

use self::air::{AirEntry, ContentsEntry, ControlEntry, PartEntry};

/// Schema version that this crate reads and writes.
pub const SCHEMA: i64 = 1;

/// A whole network file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetworkFile {
    /// Version of the format, [`SCHEMA`].
    pub schema: i64,
    /// Short name of the network, an id.
    pub name: String,
    /// Title for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Pressure from which gauge pressures count [Pa].
    pub reference_pressure_pa: f64,
    /// How the network is run when nothing else is said.
    pub run: Run,
    /// Heat, moisture and composition; flows only when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air: Option<AirEntry>,
    /// Nodes in file order.
    #[serde(rename = "node")]
    pub nodes: Vec<NodeEntry>,
    /// Lines in file order.
    #[serde(rename = "line")]
    pub lines: Vec<LineEntry>,
    /// Components at nodes, by the names of their kinds, in file order.
    #[serde(flatten)]
    pub parts: BTreeMap<&'static str, Vec<PartEntry>>,
    /// Control loops in file order.
    #[serde(rename = "control", skip_serializing_if = "Vec::is_empty")]
    pub controls: Vec<ControlEntry>,
    /// Schedules in file order.
    #[serde(rename = "schedule", skip_serializing_if = "Vec::is_empty")]
    pub schedules: Vec<ScheduleEntry>,
    /// How hardware is coupled, where it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub process: Option<ProcessEntry>,
    /// Signals between plant and hardware, in file order.
    #[serde(rename = "channel", skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<ChannelEntry>,
}

/// Table `[run]`; durations as text, such as `"1ms"`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Run {
    /// Name of the method.
    pub method: String,
    /// Step of the method.
    pub step: String,
    /// Plant time at which a run ends.
    pub until: String,
    /// `file` or `steady`: where a run starts; as the file says when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<String>,
    /// Points that a run writes down; all of them when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<Vec<String>>,
}

/// Table `[[node]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NodeEntry {
    /// Id, unique in the file.
    pub id: String,
    /// Kind with its own keys.
    #[serde(flatten)]
    pub kind: NodeEntryKind,
    /// Absolute pressure at the start [Pa].
    pub pressure_pa: f64,
    /// Temperature [K].
    pub temperature_k: f64,
    /// Column and row in drawings, both from 0; chosen by the drawing when absent. Not part of the network's id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<(u32, u32)>,
    /// What it holds, where there is `[air]`.
    #[serde(flatten)]
    pub contents: ContentsEntry,
}

/// Kinds of node.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum NodeEntryKind {
    /// A well-mixed gas volume.
    Cabin {
        /// Free gas volume [m³].
        volume_m3: f64,
    },
    /// A full volume of coolant.
    Liquid {
        /// Volume [m³].
        volume_m3: f64,
        /// Density [kg/m³].
        density_kg_m3: f64,
        /// Bulk modulus K, of liquid and walls together [Pa].
        bulk_modulus_pa: f64,
    },
    /// A volume of coolant under a spring.
    Accumulator {
        /// Volume of coolant at the start [m³].
        volume_m3: f64,
        /// Density [kg/m³].
        density_kg_m3: f64,
        /// Stiffness of the spring dp/dV [Pa/m³].
        stiffness_pa_m3: f64,
    },
    /// A point without volume where lines meet.
    Junction,
    /// Held at its start pressure whatever flows.
    Boundary,
}

/// Table `[[line]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineEntry {
    /// Id, unique in the file.
    pub id: String,
    /// Id of the node at the inlet.
    pub from: String,
    /// Id of the node at the outlet.
    pub to: String,
    /// Driving pressure below which the line's law is linear [Pa]; [`crate::limits::LAMINAR_BELOW_PA`]
    /// when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub laminar_below_pa: Option<f64>,
    /// Mass flow at the start [kg/s]; 0 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_flow_kg_s: Option<f64>,
    /// Density for which the line's parameters hold [kg/m³]; that of the `from` node at the start when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_density_kg_m3: Option<f64>,
    /// `fixed`, or `follows` where the parameters follow the density of the upstream node; fixed when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<String>,
    /// Elements in the direction of flow.
    #[serde(rename = "element")]
    pub elements: Vec<ElementEntry>,
}

/// Table `[[line.element]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementEntry {
    /// Id, unique in the file.
    pub id: String,
    /// Name of its kind.
    pub kind: &'static str,
    /// Keys of that kind.
    #[serde(flatten)]
    pub entry: Entry,
    /// Length of the fluid column [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_m: Option<f64>,
    /// Inner diameter [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diameter_m: Option<f64>,
    /// Flow area [m²], instead of a diameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_m2: Option<f64>,
    /// Inertance L/A [1/m], instead of a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertance_per_m: Option<f64>,
    /// Volume at the outlet [m³]; length times area when absent, 0 for the last element of a line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlet_volume_m3: Option<f64>,
}

/// Table `[[schedule]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScheduleEntry {
    /// The input that it drives, as in `valve.opening`.
    pub input: String,
    /// `linear` or `hold`; linear when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<String>,
    /// Pairs of time [s] and value.
    pub points: Vec<(f64, f64)>,
}

impl NetworkFile {
    /// Returns the document as TOML. Read again it gives an equal document and the same network id; comments
    /// and spacing are not kept.
    ///
    /// # Panics
    ///
    /// Never: the document holds nothing that TOML cannot express.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("tables, text and numbers always have a TOML form")
    }
}
