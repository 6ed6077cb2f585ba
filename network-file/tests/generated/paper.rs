// Generated from a network file; do not edit.

#[allow(unused_imports)] // a network need not have every kind of element
use ::eclss_core::element::{
    Bed, CheckValve, Fan, Hatch, HeadCurve, HeatExchanger, Measured, Orifice, Pipe, PressureRegulator, Pump, ReferencePipe,
    ReliefValve, Valve,
};
#[allow(unused_imports)] // nor channels
use ::eclss_core::process::{
    Calibration, Curve, Hold, Image, InputChannel, Order, OutputChannel, Port, Scaling,
};
#[allow(unused_imports)] // nor schedules
use ::eclss_core::{
    Active, Climate, Interpolation, Line, Method, Network, Node, NodeKind, Plan, Responsive, Schedule, SchedulePoint, Segment,
    Output, Settings, Signal, Sizes, StdElement,
};

/// Name of the network.
pub const NAME: &str = "paper";

/// Network id.
pub const NETWORK_ID: u64 = 0xc65c00ef643e5e4a;

/// Method of the file.
pub const METHOD: Method = Method::Relaxation;

/// Step of the file [µs].
pub const STEP_US: u32 = 1000;

/// End of a run of the file [µs].
pub const UNTIL_US: u64 = 26000000;

/// Buffers that `euler` needs.
pub const EULER: Sizes = Sizes { state: 22, work: 32, inputs: 6, cursors: 1 };

/// Buffers that `relaxation` needs.
pub const RELAXATION: Sizes = Sizes { state: 22, work: 32, inputs: 6, cursors: 1 };

/// Buffers that `adaptive` needs.
pub const ADAPTIVE: Sizes = Sizes { state: 9, work: 25, inputs: 6, cursors: 1 };

/// Buffers that `implicit-euler` needs.
pub const IMPLICIT_EULER: Sizes = Sizes { state: 36, work: 179, inputs: 6, cursors: 1 };

/// Buffers that `tr-bdf2` needs.
pub const TR_BDF2: Sizes = Sizes { state: 36, work: 179, inputs: 6, cursors: 1 };

/// Buffers that the method of the file needs.
pub const BUFFERS: Sizes = Sizes { state: 22, work: 32, inputs: 6, cursors: 1 };

/// Nodes.
pub static NODES: [Node; 1] = [
    Node { kind: NodeKind::Cabin { volume_m3: 60.0 }, start_gauge_pa: 0.0, temperature_k: 295.15 },
];

/// Lines.
pub static LINES: [Line; 1] = [
    Line { from: 0, to: 0, first_segment: 0, segments: 6, flow_segment: 5, laminar_below_pa: 0.0, start_flow_kg_s: 0.001 },
];

/// Segments of all lines.
pub static SEGMENTS: [Segment; 6] = [
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 805.874 }), inertance_per_m: 254.6479, outlet_volume_m3: 0.015707964, first_input: 0 },
    Segment { element: StdElement::Fan(Fan { curve: HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 12984.201 } }), inertance_per_m: 254.6479, outlet_volume_m3: 0.015707964, first_input: 0 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 5337.527 }), inertance_per_m: 254.6479, outlet_volume_m3: 0.015707964, first_input: 1 },
    Segment { element: StdElement::HeatExchanger(HeatExchanger { resistance_pa_s2_kg2: 16007.337, liquid_fraction: 0.0045, separator_efficiency: 1.0 }), inertance_per_m: 254.6479, outlet_volume_m3: 0.015707964, first_input: 1 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 4577.822 }), inertance_per_m: 254.6479, outlet_volume_m3: 0.015707964, first_input: 1 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 85.97846, exponent: 3.134165, leakage_opening: 0.001 }), inertance_per_m: 254.6479, outlet_volume_m3: 0.0, first_input: 1 },
];

/// Segments whose law changes.
pub static ACTIVE: [Active; 2] = [
    Active { segment: 1, line: 0 },
    Active { segment: 5, line: 0 },
];

/// Lines whose laws respond.
pub static RESPONSIVE: [Responsive; 0] = [];

/// Start values of the inputs.
pub static INPUTS: [f32; 2] = [
    1.0,
    1.0,
];

/// Schedules.
pub static SCHEDULES: [Schedule; 1] = [
    Schedule { input: 1, first_point: 0, points: 3, interpolation: Interpolation::Linear },
];

/// Points of all schedules.
pub static POINTS: [SchedulePoint; 3] = [
    SchedulePoint { time_us: 0, value: 1.0 },
    SchedulePoint { time_us: 10000000, value: 1.0 },
    SchedulePoint { time_us: 11000000, value: 0.02 },
];

/// Ids of the nodes.
pub static NODE_NAMES: [&str; 1] = [
    "cabin",
];

/// Ids of the lines.
pub static LINE_NAMES: [&str; 1] = [
    "loop",
];

/// Ids of the elements, one per segment.
pub static SEGMENT_NAMES: [&str; 6] = [
    "intake",
    "fan",
    "fan_duct",
    "che",
    "supply",
    "valve",
];

/// Names of the inputs.
pub static INPUT_NAMES: [&str; 2] = [
    "fan.speed",
    "valve.opening",
];

static PLAN_END_START: [u32; 2] = [0, 2];

static PLAN_ENDS: [u32; 2] = [0, 1];

static PLAN_ORDER: [u32; 1] = [0];

static PLAN_ROW_START: [u32; 2] = [0, 1];

static PLAN_COLUMNS: [u32; 1] = [0];

static PLAN_DIAGONAL: [u32; 1] = [0];

static PLAN_ROW_OF: [u32; 1] = [0];

static PLAN_COMPOSITE: [u32; 1] = [0];

static PLAN_STAMPS: [[u32; 4]; 1] = [[0, 4294967295, 4294967295, 0]];

static PLAN_LEAVES: [[u32; 2]; 1] = [[4294967295, 4294967295]];

static PLAN_TERMS: [[u32; 3]; 2] = [[12, 1, 4294967295], [15, 1, 4294967295]];

static PLAN_BETWEEN: [[u32; 2]; 6] = [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]];

/// The description with the method and step of the file, for a step specialised at compile time.
#[derive(Debug, Clone, Copy)]
pub struct Configured;

impl ::eclss_core::Compiled for Configured {
    type Element = StdElement;
    const NETWORK: Network<'static> = Network {
        reference_pa: 101325.0,
        nodes: &NODES,
        lines: &LINES,
        segments: &SEGMENTS,
        active: &ACTIVE,
        responsive: &RESPONSIVE,
        inputs: &INPUTS,
        schedules: &SCHEDULES,
        points: &POINTS,
        plan: Plan {
            end_start: &PLAN_END_START,
            ends: &PLAN_ENDS,
            order: &PLAN_ORDER,
            row_start: &PLAN_ROW_START,
            columns: &PLAN_COLUMNS,
            diagonal: &PLAN_DIAGONAL,
            stamps: &PLAN_STAMPS,
            row_of: &PLAN_ROW_OF,
            leaves: &PLAN_LEAVES,
            terms: &PLAN_TERMS,
            composite: &PLAN_COMPOSITE,
            between: &PLAN_BETWEEN,
        },
        climate: Climate::NONE,
    };
    const SETTINGS: Settings = Settings { method: METHOD, step_us: STEP_US };
}

/// The description.
pub static NETWORK: Network<'static> = <Configured as ::eclss_core::Compiled>::NETWORK;

/// Channels from hardware to the plant.
pub static INPUT_CHANNELS: [InputChannel; 0] = [];

/// Channels from the plant to hardware.
pub static OUTPUT_CHANNELS: [OutputChannel; 0] = [];

/// Names of the input channels.
pub static INPUT_CHANNEL_NAMES: [&str; 0] = [];

/// Names of the output channels.
pub static OUTPUT_CHANNEL_NAMES: [&str; 0] = [];

/// Id of the process image.
pub const PROCESS_ID: u64 = 0x5ed9d73248e2f691;

/// The process image.
pub static PROCESS: Image<'static> = Image {
    inputs: &INPUT_CHANNELS,
    outputs: &OUTPUT_CHANNELS,
    order: Order::Latched,
    safe_after_ticks: 20,
};
