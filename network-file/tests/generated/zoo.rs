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
pub const NAME: &str = "zoo";

/// Network id.
pub const NETWORK_ID: u64 = 0xc9fcb3e6888bd068;

/// Method of the file.
pub const METHOD: Method = Method::Adaptive;

/// Step of the file [µs].
pub const STEP_US: u32 = 500;

/// End of a run of the file [µs].
pub const UNTIL_US: u64 = 90000000;

/// Buffers that `euler` needs.
pub const EULER: Sizes = Sizes { state: 100, work: 122, inputs: 30, cursors: 3 };

/// Buffers that `relaxation` needs.
pub const RELAXATION: Sizes = Sizes { state: 100, work: 122, inputs: 30, cursors: 3 };

/// Buffers that `adaptive` needs.
pub const ADAPTIVE: Sizes = Sizes { state: 61, work: 171, inputs: 30, cursors: 3 };

/// Buffers that `implicit-euler` needs.
pub const IMPLICIT_EULER: Sizes = Sizes { state: 140, work: 451, inputs: 30, cursors: 3 };

/// Buffers that `tr-bdf2` needs.
pub const TR_BDF2: Sizes = Sizes { state: 140, work: 451, inputs: 30, cursors: 3 };

/// Buffers that the method of the file needs.
pub const BUFFERS: Sizes = Sizes { state: 61, work: 171, inputs: 30, cursors: 3 };

/// Nodes.
pub static NODES: [Node; 4] = [
    Node { kind: NodeKind::Cabin { volume_m3: 97.71 }, start_gauge_pa: 1325.0, temperature_k: 295.15 },
    Node { kind: NodeKind::Cabin { volume_m3: 57.8 }, start_gauge_pa: 1300.0, temperature_k: 296.0 },
    Node { kind: NodeKind::Boundary, start_gauge_pa: 10000.0, temperature_k: 293.15 },
    Node { kind: NodeKind::Boundary, start_gauge_pa: -100000.0, temperature_k: 270.0 },
];

/// Lines.
pub static LINES: [Line; 9] = [
    Line { from: 0, to: 1, first_segment: 0, segments: 4, flow_segment: 2, laminar_below_pa: 0.01, start_flow_kg_s: -0.002 },
    Line { from: 1, to: 0, first_segment: 4, segments: 2, flow_segment: 1, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 2, to: 0, first_segment: 6, segments: 2, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 3, to: 1, first_segment: 8, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 0, to: 3, first_segment: 9, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 1, to: 3, first_segment: 10, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 2, to: 0, first_segment: 11, segments: 2, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 0, to: 1, first_segment: 13, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 0, to: 1, first_segment: 14, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
];

/// Segments of all lines.
pub static SEGMENTS: [Segment; 15] = [
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 5556.456 }), inertance_per_m: 44.209705, outlet_volume_m3: 0.005654867, first_input: 0 },
    Segment { element: StdElement::Fan(Fan { curve: HeadCurve { shutoff_pa: 293.18933, linear_pa_s_kg: 29.418, quadratic_pa_s2_kg2: 7379.3496 } }), inertance_per_m: 30.0, outlet_volume_m3: 0.003, first_input: 0 },
    Segment { element: StdElement::HeatExchanger(HeatExchanger { resistance_pa_s2_kg2: 50168.945, liquid_fraction: 0.005, separator_efficiency: 0.9 }), inertance_per_m: 31.0, outlet_volume_m3: 0.002, first_input: 1 },
    Segment { element: StdElement::ReferencePipe(ReferencePipe { pressure_drop_pa: 40.135155, mass_flow_kg_s: 0.05, exponent: 1.8 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 1 },
    Segment { element: StdElement::Bed(Bed { resistance_pa_s2_kg2: 2000.0, mass_fraction: 0.006, capture_efficiency: 0.8 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 1 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 50.0, exponent: 2.0, leakage_opening: 0.01 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 1 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 10000000.0, exponent: 2.5, leakage_opening: 0.001 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 2 },
    Segment { element: StdElement::Pump(Pump { curve: HeadCurve { shutoff_pa: 50.0, linear_pa_s_kg: 4.0, quadratic_pa_s2_kg2: 1000000.0 } }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 3 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 83333330000000.0 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 4 },
    Segment { element: StdElement::Orifice(Orifice { effective_area_m2: 1.1003376e-8 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 4 },
    Segment { element: StdElement::ReliefValve(ReliefValve { crack_pa: 105000.0, reseat_pa: 103500.0, resistance_pa_s2_kg2: 400000000.0, effective_area_m2: 0.0, leakage_opening: 0.005 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 5 },
    Segment { element: StdElement::PressureRegulator(PressureRegulator { effective_area_m2: 1.6e-5, set_point_pa: 101400.0, band_pa: 300.0, lag_s: 0.5, leakage_opening: 0.001 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 6 },
    Segment { element: StdElement::CheckValve(CheckValve { resistance_pa_s2_kg2: 30000.0, reverse_pa_s_kg: 5000000000.0 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 7 },
    Segment { element: StdElement::Hatch(Hatch { open_resistance_pa_s2_kg2: 451.5205, leakage_opening: 2e-5 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 8 },
    Segment { element: StdElement::Orifice(Orifice { effective_area_m2: 4.8694685e-5 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 9 },
];

/// Segments whose law changes.
pub static ACTIVE: [Active; 5] = [
    Active { segment: 1, line: 0 },
    Active { segment: 3, line: 0 },
    Active { segment: 5, line: 1 },
    Active { segment: 6, line: 2 },
    Active { segment: 7, line: 2 },
];

/// Lines whose laws respond.
pub static RESPONSIVE: [Responsive; 5] = [
    Responsive { line: 4, first_memory: 0, reference_density_kg_m3: 0.0 },
    Responsive { line: 5, first_memory: 0, reference_density_kg_m3: 0.0 },
    Responsive { line: 6, first_memory: 1, reference_density_kg_m3: 0.0 },
    Responsive { line: 7, first_memory: 2, reference_density_kg_m3: 1.195959 },
    Responsive { line: 8, first_memory: 2, reference_density_kg_m3: 0.0 },
];

/// Start values of the inputs.
pub static INPUTS: [f32; 10] = [
    1.0,
    1.0,
    0.25,
    0.5,
    1.0,
    0.0,
    0.0,
    0.0,
    0.0,
    1.0,
];

/// Schedules.
pub static SCHEDULES: [Schedule; 3] = [
    Schedule { input: 1, first_point: 0, points: 3, interpolation: Interpolation::Hold },
    Schedule { input: 0, first_point: 3, points: 4, interpolation: Interpolation::Linear },
    Schedule { input: 8, first_point: 7, points: 2, interpolation: Interpolation::Linear },
];

/// Points of all schedules.
pub static POINTS: [SchedulePoint; 9] = [
    SchedulePoint { time_us: 0, value: 1.0 },
    SchedulePoint { time_us: 3600000000, value: 0.25 },
    SchedulePoint { time_us: 3600500000, value: 0.5 },
    SchedulePoint { time_us: 0, value: 0.0 },
    SchedulePoint { time_us: 0, value: 1.0 },
    SchedulePoint { time_us: 10100000, value: 1.0 },
    SchedulePoint { time_us: 10100000, value: 0.6 },
    SchedulePoint { time_us: 0, value: 0.0 },
    SchedulePoint { time_us: 20000000, value: 1.0 },
];

/// Ids of the nodes.
pub static NODE_NAMES: [&str; 4] = [
    "lab",
    "node_1",
    "supply",
    "space",
];

/// Ids of the lines.
pub static LINE_NAMES: [&str; 9] = [
    "return",
    "hatch_line",
    "makeup",
    "leak",
    "hull",
    "overboard",
    "bottle_line",
    "door",
    "equaliser",
];

/// Ids of the elements, one per segment.
pub static SEGMENT_NAMES: [&str; 15] = [
    "grille",
    "blower",
    "condenser",
    "filter",
    "scrubber",
    "hatch",
    "regulator",
    "booster",
    "crack",
    "crack_in_hull",
    "relief",
    "keeper",
    "check",
    "porthole",
    "bleed",
];

/// Names of the inputs.
pub static INPUT_NAMES: [&str; 10] = [
    "blower.speed",
    "hatch.opening",
    "regulator.opening",
    "booster.speed",
    "crack_in_hull.opening",
    "relief.fault",
    "keeper.fault",
    "check.fault",
    "porthole.opening",
    "bleed.opening",
];

static PLAN_END_START: [u32; 5] = [0, 7, 13, 15, 18];

static PLAN_ENDS: [u32; 18] = [0, 3, 5, 8, 13, 14, 16, 1, 2, 7, 10, 15, 17, 4, 12, 6, 9, 11];

static PLAN_ORDER: [u32; 2] = [0, 1];

static PLAN_ROW_START: [u32; 3] = [0, 2, 4];

static PLAN_COLUMNS: [u32; 4] = [0, 1, 0, 1];

static PLAN_DIAGONAL: [u32; 2] = [0, 3];

static PLAN_ROW_OF: [u32; 4] = [0, 1, 4294967295, 4294967295];

static PLAN_COMPOSITE: [u32; 2] = [0, 1];

static PLAN_STAMPS: [[u32; 4]; 9] = [[0, 1, 2, 3], [3, 2, 1, 0], [4294967295, 4294967295, 4294967295, 0], [4294967295, 4294967295, 4294967295, 3], [0, 4294967295, 4294967295, 4294967295], [3, 4294967295, 4294967295, 4294967295], [4294967295, 4294967295, 4294967295, 0], [0, 1, 2, 3], [0, 1, 2, 3]];

static PLAN_LEAVES: [[u32; 2]; 0] = [];

static PLAN_TERMS: [[u32; 3]; 18] = [[30, 4, 1], [37, 4, 1], [15, 2, 4294967295], [18, 3, 4294967295], [25, 2, 4294967295], [26, 4, 1], [28, 4, 1], [33, 4, 0], [34, 4, 0], [17, 3, 4294967295], [20, 3, 4294967295], [27, 4, 0], [29, 4, 0], [14, 4, 0], [24, 4, 0], [16, 4, 1], [19, 4, 0], [21, 4, 1]];

static PLAN_BETWEEN: [[u32; 2]; 15] = [[0, 4], [4, 5], [5, 6], [6, 1], [4294967295, 4294967295], [1, 0], [4294967295, 4294967295], [2, 0], [3, 1], [0, 3], [1, 3], [4294967295, 4294967295], [2, 0], [0, 1], [0, 1]];

/// The description with the method and step of the file, for a step specialised at compile time.
#[derive(Debug, Clone, Copy)]
pub struct Configured;

impl ::eclss_core::Compiled for Configured {
    type Element = StdElement;
    const NETWORK: Network<'static> = Network {
        reference_pa: 100000.0,
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
pub static INPUT_CHANNELS: [InputChannel; 2] = [
    InputChannel { slot: 2, port: Port::Analog(1), scaling: Scaling { electrical: Curve { points: &[[0.0, 0.0], [65535.0, 20.625]] }, engineering: Curve { points: &[[4.0, 0.0], [12.0, 0.45], [20.0, 1.0]] }, wire: Some([3.6, 20.5]), calibration: Calibration { id: "K-17", date: 20260131 } }, min: 0.0, max: 1.0, saturates: true, max_rate_per_s: 20.0, filter_s: 0.01, hold: Hold::Linear, extrapolate_ticks: 3, event_step: 0.2, stale_ticks: 30, safe_value: 0.25, safe_rate_per_s: 0.5, essential: true },
    InputChannel { slot: 3, port: Port::Link, scaling: Scaling::NONE, min: 0.0, max: 2.0, saturates: false, max_rate_per_s: f32::INFINITY, filter_s: 0.0, hold: Hold::Zero, extrapolate_ticks: 1, event_step: 0.2, stale_ticks: 10, safe_value: 0.5, safe_rate_per_s: 2.0, essential: false },
];

/// Channels from the plant to hardware.
pub static OUTPUT_CHANNELS: [OutputChannel; 3] = [
    OutputChannel { signal: Signal { output: Output::Pressure, owner: 0, item: 0 }, port: Port::Analog(0), scaling: Scaling { electrical: Curve { points: &[[0.0, 0.0], [4095.0, 3.3]] }, engineering: Curve { points: &[[0.0, -5000.0], [3.3, 5000.0]] }, wire: None, calibration: Calibration { id: "", date: 0 } }, min: -5000.0, max: 5000.0, max_rate_per_s: 1000000.0, safe_value: 0.0, safe_rate_per_s: 10000.0 },
    OutputChannel { signal: Signal { output: Output::SegmentFlow, owner: 4, item: 0 }, port: Port::Link, scaling: Scaling::NONE, min: -1.0, max: 1.0, max_rate_per_s: f32::INFINITY, safe_value: 0.0, safe_rate_per_s: 2.0 },
    OutputChannel { signal: Signal { output: Output::Input, owner: 1, item: 0 }, port: Port::Link, scaling: Scaling::NONE, min: 0.0, max: 1.0, max_rate_per_s: f32::INFINITY, safe_value: 1.0, safe_rate_per_s: 1.0 },
];

/// Names of the input channels.
pub static INPUT_CHANNEL_NAMES: [&str; 2] = [
    "regulator.opening",
    "booster.speed",
];

/// Names of the output channels.
pub static OUTPUT_CHANNEL_NAMES: [&str; 3] = [
    "lab.pressure",
    "scrubber.mass_flow",
    "hatch.opening",
];

/// Id of the process image.
pub const PROCESS_ID: u64 = 0x05ea6a0e325ab338;

/// The process image.
pub static PROCESS: Image<'static> = Image {
    inputs: &INPUT_CHANNELS,
    outputs: &OUTPUT_CHANNELS,
    order: Order::Immediate,
    safe_after_ticks: 50,
};
