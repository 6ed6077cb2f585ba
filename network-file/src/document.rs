//! The document: what stands in a network file, before any conversion.
//!
//! Numbers are `f64` in the unit that their key names, as written. Reading is strict and done by
//! [`crate::parse`]; writing is done here.

pub mod air;

use serde::Serialize;

use self::air::{AirEntry, CoilEntry, ContentsEntry, ControlEntry, PartEntry, Starts};

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
    /// Heat and mass sources in file order.
    #[serde(rename = "source", skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<PartEntry>,
    /// Crews in file order.
    #[serde(rename = "crew", skip_serializing_if = "Vec::is_empty")]
    pub crews: Vec<PartEntry>,
    /// Idealised removal in file order.
    #[serde(rename = "remover", skip_serializing_if = "Vec::is_empty")]
    pub removers: Vec<PartEntry>,
    /// Walls in file order.
    #[serde(rename = "wall", skip_serializing_if = "Vec::is_empty")]
    pub walls: Vec<PartEntry>,
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
    /// Kind with its own keys.
    #[serde(flatten)]
    pub kind: ElementKind,
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

/// Kinds of element.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ElementKind {
    /// Duct, filter or grille.
    Pipe {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
    },
    /// Loss known by one measured point.
    ReferencePipe {
        /// Measured pressure loss [Pa].
        pressure_drop_pa: f64,
        /// Mass flow of the measurement [kg/s].
        mass_flow_kg_s: f64,
        /// Exponent of the flow [1].
        exponent: f64,
        /// Density of the measurement [kg/m³]; the line's when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        density_kg_m3: Option<f64>,
    },
    /// Control valve.
    Valve {
        /// Resistance when fully open [Pa·s²/kg²].
        open_resistance_pa_s2_kg2: f64,
        /// Exponent of the opening [1].
        exponent: f64,
        /// Opening that remains when closed [1]; [`crate::limits::LEAKAGE_OPENING`] when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        leakage_opening: Option<f64>,
        /// Opening at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
    /// Fan.
    Fan(Machine),
    /// Pump.
    Pump(Machine),
    /// Condensing heat exchanger.
    HeatExchanger {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Mass of liquid per mass of air that leaves [1].
        liquid_fraction: f64,
        /// Share of the liquid that the separator takes out [1].
        separator_efficiency: f64,
    },
    /// Condensing heat exchanger with walls, films and separator; needs `[air]`.
    Condenser {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Everything else.
        #[serde(flatten)]
        coil: CoilEntry,
    },
    /// Coolant side of a condenser; needs `[air]`.
    CoolantSide {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Id of the condenser.
        condenser: String,
    },
    /// Heater, cold plate or heat load in a line; needs `[air]`.
    Heater {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Start value of its power.
        #[serde(flatten)]
        starts: Starts,
    },
    /// Adsorption bed.
    Bed {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Mass fraction of the captured species in the air that enters [1].
        mass_fraction: f64,
        /// Share of the species that is captured [1].
        capture_efficiency: f64,
    },
    /// Real hardware, whose flow is an input.
    Measured {
        /// Largest flow that is believed [kg/s].
        largest_flow_kg_s: f64,
        /// How strongly its flow answers to pressure, at most [kg/(s·Pa)].
        slope_kg_s_pa: f64,
    },
    /// Opening of the element's own area with isentropic, choked flow.
    Orifice {
        /// Discharge coefficient on the area [1].
        discharge_coefficient: f64,
    },
    /// Orifice known by one measured leak.
    Leak {
        /// Measured leak [kg/d].
        leak_kg_d: f64,
        /// Pressure difference of the measurement [Pa].
        pressure_drop_pa: f64,
        /// Absolute pressure before the leak in the measurement [Pa]; that of the line's node of higher pressure
        /// when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        inlet_pressure_pa: Option<f64>,
    },
    /// Passes forward flow only.
    CheckValve {
        /// Its loss in forward flow.
        #[serde(flatten)]
        loss: Loss,
        /// Leak in reverse [kg/s].
        reverse_leak_kg_s: f64,
        /// Pressure difference at which it leaks so much [Pa].
        reverse_pressure_pa: f64,
    },
    /// Opens at one pressure difference and closes at a lower one.
    ReliefValve {
        /// Pressure difference at which it opens [Pa].
        crack_pa: f64,
        /// Pressure difference at which it closes [Pa].
        reseat_pa: f64,
        /// Its loss when open.
        #[serde(flatten)]
        loss: Loss,
        /// Opening that remains when closed [1]; [`crate::limits::LEAKAGE_OPENING`] when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        leakage_opening: Option<f64>,
    },
    /// Holds the pressure at its outlet.
    PressureRegulator(Regulator),
    /// Opening between modules.
    Hatch {
        /// Its loss when open.
        #[serde(flatten)]
        loss: Loss,
        /// Part of the area that remains when closed [1]; [`crate::limits::HATCH_LEAKAGE`] when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        leakage_opening: Option<f64>,
        /// Opening at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
}

/// A quadratic loss, given in one of two ways.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Loss {
    /// By resistance.
    Resistance {
        /// R in Δp = R·w·|w| [Pa·s²/kg²].
        resistance_pa_s2_kg2: f64,
    },
    /// By loss coefficient ξ on the element's own flow area.
    Coefficient {
        /// ξ in Δp = ξ·ρ·v²/2 [1].
        loss_coefficient: f64,
    },
}

/// Fan or pump: head curve at rated speed and start speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// Head curve.
    #[serde(flatten)]
    pub curve: Curve,
    /// Speed at the start [1, 1 = rated]; 1 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
    /// Electric power at rated speed, which heats what it moves [W]; 0 when absent, needs `[air]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power_w: Option<f64>,
}

/// Pressure regulator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Regulator {
    /// Discharge coefficient on the element's own area when fully open [1].
    pub discharge_coefficient: f64,
    /// Absolute pressure at the outlet at which it closes [Pa].
    pub set_point_pa: f64,
    /// Fully open below the set point by this [Pa].
    pub band_pa: f64,
    /// Lag of the actuator [s].
    pub lag_s: f64,
    /// Opening that remains when closed [1]; [`crate::limits::LEAKAGE_OPENING`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leakage_opening: Option<f64>,
}

/// A head curve, given in one of two ways.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Curve {
    /// By pressure over mass flow at the line's reference density.
    Pressure {
        /// Pressure rise at zero flow [Pa].
        shutoff_pa: f64,
        /// Linear fall [Pa·s/kg]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        linear_pa_s_kg: Option<f64>,
        /// Quadratic fall [Pa·s²/kg²].
        quadratic_pa_s2_kg2: f64,
    },
    /// By head over volume flow, h = h0 − h1·Q − h2·Q².
    Head {
        /// Head at zero flow [m].
        h0_m: f64,
        /// Linear fall [s/m²]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        h1_s_m2: Option<f64>,
        /// Quadratic fall [s²/m⁵].
        h2_s2_m5: f64,
    },
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

/// Table `[process]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ProcessEntry {
    /// `latched` or `immediate`; latched when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// Ticks of silence after which the plant goes to SAFE; [`crate::limits::SAFE_AFTER_TICKS`] when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe_after_ticks: Option<f64>,
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
