//! A file that was accepted: the document and the tables that the core runs on.

use eclss_core::climate::{ControlLoop, Volume};
use eclss_core::component::{Passage, Placed, Table};
use eclss_core::fluid::Medium;
use eclss_core::signal::OutputSpec;
use eclss_core::{
    Active, Climate, Line, Method, Network, Node, Responsive, Schedule, SchedulePoint, Segment,
};

use crate::document::NetworkFile;
use crate::plan::PlanTables;
use crate::process::ProcessTables;
use crate::signal::NamedSignal;
use crate::unrest::Places;

/// A network that was read, checked and converted; owns what [`Network`] borrows.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The document as read.
    pub file: NetworkFile,
    /// Ids by the core's indices.
    pub names: Names,
    /// Where they are named in the file.
    pub places: Places,
    /// Published description of every input slot; set point and bias of a control have the unit of its measurement.
    pub input_specs: Vec<OutputSpec>,
    /// Smallest and largest value of every input slot, in its unit.
    pub ranges: Vec<(f32, f32)>,
    /// Heat, moisture, composition and control.
    pub climate: ClimateTables,
    /// How the network is run when nothing else is said.
    pub run: RunDefaults,
    /// What a run writes down, in the order of the file, else everything.
    pub records: Vec<NamedSignal>,
    /// Pressure from which gauge pressures count [Pa].
    pub reference_pa: f32,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Segments of all lines, in line order.
    pub segments: Vec<Segment>,
    /// Segments whose law changes during a run.
    pub active: Vec<Active>,
    /// Lines whose laws respond to pressures or density.
    pub responsive: Vec<Responsive>,
    /// Start value of every input slot.
    pub inputs: Vec<f32>,
    /// Schedules.
    pub schedules: Vec<Schedule>,
    /// Points of all schedules.
    pub points: Vec<SchedulePoint>,
    /// Connection tables.
    pub plan: PlanTables,
    /// Signals between plant and hardware.
    pub process: ProcessTables,
}

/// Ids from the file at the indices that the core uses.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    /// Ids of the nodes.
    pub nodes: Vec<String>,
    /// Ids of the lines.
    pub lines: Vec<String>,
    /// Ids of the elements, one per segment.
    pub segments: Vec<String>,
    /// Names of the input slots, as in `valve.opening`.
    pub inputs: Vec<String>,
    /// Ids of the placed components.
    pub components: Vec<String>,
    /// Ids of the control loops.
    pub controls: Vec<String>,
}

/// The tables of a climate; without volumes there is none.
#[derive(Debug, Clone)]
pub struct ClimateTables {
    /// Temperature from which energies count [K].
    pub reference_k: f32,
    /// Air at that temperature.
    pub air: Medium,
    /// The coolant.
    pub coolant: Medium,
    /// What every node holds.
    pub volumes: Vec<Volume>,
    /// Placed components, those of one kind side by side.
    pub components: Vec<Placed>,
    /// Their kinds.
    pub tables: Vec<Table>,
    /// Passages of streams through components.
    pub passages: Vec<Passage>,
    /// Ids of the placed components.
    pub names: Vec<String>,
    /// Paths of their tables in the file.
    pub(crate) paths: Vec<String>,
    /// Control loops.
    pub loops: Vec<ControlLoop>,
}

impl Default for ClimateTables {
    fn default() -> Self {
        let Climate { reference_k, air, coolant, .. } = Climate::NONE;
        Self {
            reference_k,
            air,
            coolant,
            volumes: Vec::new(),
            components: Vec::new(),
            tables: Vec::new(),
            passages: Vec::new(),
            names: Vec::new(),
            paths: Vec::new(),
            loops: Vec::new(),
        }
    }
}

impl ClimateTables {
    /// Lends the tables as the core takes them.
    pub fn climate(&self) -> Climate<'_> {
        Climate {
            reference_k: self.reference_k,
            air: self.air,
            coolant: self.coolant,
            volumes: &self.volumes,
            components: &self.components,
            tables: &self.tables,
            passages: &self.passages,
            loops: &self.loops,
        }
    }
}

/// What `[run]` says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunDefaults {
    /// The method.
    pub method: Method,
    /// Its step [µs].
    pub step_us: u32,
    /// Plant time at which a run ends [µs].
    pub until_us: u64,
}

impl Loaded {
    /// Lends the tables as the description that a simulator takes; it has passed [`Network::check`].
    pub fn network(&self) -> Network<'_> {
        Network {
            reference_pa: self.reference_pa,
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            responsive: &self.responsive,
            inputs: &self.inputs,
            schedules: &self.schedules,
            points: &self.points,
            plan: self.plan.plan(),
            climate: self.climate.climate(),
        }
    }
}
