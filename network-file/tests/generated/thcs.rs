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
#[allow(unused_imports)] // nor everything that a climate may have
use ::eclss_core::{
    climate::condenser::Condenser, climate::medium::Medium, climate::{Contents::*, ControlLoop, Crew, Exchanger, Passage::*, Remover, Source, Station, Volume, Wall},
    control::{Actuator, Controller::*, Sensor},
};

/// Name of the network.
pub const NAME: &str = "thcs";

/// Network id.
pub const NETWORK_ID: u64 = 0x2f8db00e01d56299;

/// Method of the file.
pub const METHOD: Method = Method::ImplicitEuler;

/// Step of the file [µs].
pub const STEP_US: u32 = 10000;

/// End of a run of the file [µs].
pub const UNTIL_US: u64 = 86400000000;

/// Buffers that `euler` needs.
pub const EULER: Sizes = Sizes { state: 450, work: 390, inputs: 171, cursors: 4 };

/// Buffers that `relaxation` needs.
pub const RELAXATION: Sizes = Sizes { state: 450, work: 390, inputs: 171, cursors: 4 };

/// Buffers that `adaptive` needs.
pub const ADAPTIVE: Sizes = Sizes { state: 414, work: 444, inputs: 171, cursors: 4 };

/// Buffers that `implicit-euler` needs.
pub const IMPLICIT_EULER: Sizes = Sizes { state: 488, work: 690, inputs: 171, cursors: 4 };

/// Buffers that `tr-bdf2` needs.
pub const TR_BDF2: Sizes = Sizes { state: 488, work: 690, inputs: 171, cursors: 4 };

/// Buffers that the method of the file needs.
pub const BUFFERS: Sizes = Sizes { state: 488, work: 690, inputs: 171, cursors: 4 };

/// Nodes.
pub static NODES: [Node; 7] = [
    Node { kind: NodeKind::Cabin { volume_m3: 97.71 }, start_gauge_pa: 0.0, temperature_k: 295.35 },
    Node { kind: NodeKind::Cabin { volume_m3: 0.5 }, start_gauge_pa: 0.0, temperature_k: 295.35 },
    Node { kind: NodeKind::Cabin { volume_m3: 0.3 }, start_gauge_pa: 0.0, temperature_k: 290.0 },
    Node { kind: NodeKind::Boundary, start_gauge_pa: -101325.0, temperature_k: 290.0 },
    Node { kind: NodeKind::Liquid { capacity_kg_pa: 0.0001 }, start_gauge_pa: 100000.0, temperature_k: 283.0 },
    Node { kind: NodeKind::Liquid { capacity_kg_pa: 2.5e-8 }, start_gauge_pa: 100000.0, temperature_k: 277.5 },
    Node { kind: NodeKind::Liquid { capacity_kg_pa: 2.5e-8 }, start_gauge_pa: 100000.0, temperature_k: 283.0 },
];

/// Lines.
pub static LINES: [Line; 8] = [
    Line { from: 0, to: 1, first_segment: 0, segments: 2, flow_segment: 1, laminar_below_pa: 0.001, start_flow_kg_s: 0.2 },
    Line { from: 1, to: 2, first_segment: 2, segments: 2, flow_segment: 1, laminar_below_pa: 0.001, start_flow_kg_s: 0.1 },
    Line { from: 1, to: 2, first_segment: 4, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.1 },
    Line { from: 2, to: 0, first_segment: 5, segments: 2, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.2 },
    Line { from: 0, to: 3, first_segment: 7, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.0 },
    Line { from: 4, to: 5, first_segment: 8, segments: 2, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.155 },
    Line { from: 5, to: 6, first_segment: 10, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.155 },
    Line { from: 6, to: 4, first_segment: 11, segments: 1, flow_segment: 0, laminar_below_pa: 0.001, start_flow_kg_s: 0.155 },
];

/// Segments of all lines.
pub static SEGMENTS: [Segment; 12] = [
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 1000.0 }), inertance_per_m: 50.0, outlet_volume_m3: 0.0, first_input: 0 },
    Segment { element: StdElement::Fan(Fan { curve: HeadCurve { shutoff_pa: 600.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 3000.0 } }), inertance_per_m: 20.0, outlet_volume_m3: 0.0, first_input: 0 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 3000.0 }), inertance_per_m: 20.0, outlet_volume_m3: 0.0, first_input: 1 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 400.0, exponent: 2.0, leakage_opening: 0.001 }), inertance_per_m: 10.0, outlet_volume_m3: 0.0, first_input: 1 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 3000.0, exponent: 2.0, leakage_opening: 0.001 }), inertance_per_m: 30.0, outlet_volume_m3: 0.0, first_input: 2 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 300.0, exponent: 2.0, leakage_opening: 0.001 }), inertance_per_m: 10.0, outlet_volume_m3: 0.0, first_input: 3 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 2200.0 }), inertance_per_m: 50.0, outlet_volume_m3: 0.0, first_input: 4 },
    Segment { element: StdElement::Valve(Valve { open_resistance_pa_s2_kg2: 14680000000.0, exponent: 2.0, leakage_opening: 0.001 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 4 },
    Segment { element: StdElement::Pump(Pump { curve: HeadCurve { shutoff_pa: 200000.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 2000000.0 } }), inertance_per_m: 1000.0, outlet_volume_m3: 0.0, first_input: 5 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 2000000.0 }), inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 6 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 2000000.0 }), inertance_per_m: 5000.0, outlet_volume_m3: 0.0, first_input: 6 },
    Segment { element: StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 2000000.0 }), inertance_per_m: 5000.0, outlet_volume_m3: 0.0, first_input: 6 },
];

/// Segments whose law changes.
pub static ACTIVE: [Active; 6] = [
    Active { segment: 1, line: 0 },
    Active { segment: 3, line: 1 },
    Active { segment: 4, line: 2 },
    Active { segment: 5, line: 3 },
    Active { segment: 7, line: 4 },
    Active { segment: 8, line: 5 },
];

/// Lines whose laws respond.
pub static RESPONSIVE: [Responsive; 0] = [];

/// Start values of the inputs.
pub static INPUTS: [f32; 57] = [
    1.0,
    0.5,
    0.5,
    1.0,
    0.001,
    1.0,
    0.99,
    0.0,
    277.5,
    0.0,
    1.0,
    -2500.0,
    500.0,
    700.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    20.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    3.0,
    0.0,
    1.0,
    0.0,
    0.00997,
    0.9,
    290.0,
    295.35,
    0.0,
    0.0,
    0.0,
    277.5,
    0.0,
    0.0,
    0.0,
    21200.0,
    0.0,
    0.0,
    0.0,
    101325.0,
    0.0,
    0.0,
    0.0,
];

/// Schedules.
pub static SCHEDULES: [Schedule; 4] = [
    Schedule { input: 35, first_point: 0, points: 3, interpolation: Interpolation::Hold },
    Schedule { input: 37, first_point: 3, points: 10, interpolation: Interpolation::Hold },
    Schedule { input: 20, first_point: 13, points: 3, interpolation: Interpolation::Hold },
    Schedule { input: 0, first_point: 16, points: 5, interpolation: Interpolation::Linear },
];

/// Points of all schedules.
pub static POINTS: [SchedulePoint; 21] = [
    SchedulePoint { time_us: 0, value: 0.0 },
    SchedulePoint { time_us: 25200000000, value: 1.0 },
    SchedulePoint { time_us: 82800000000, value: 0.0 },
    SchedulePoint { time_us: 0, value: 0.0 },
    SchedulePoint { time_us: 25200000000, value: 1.0 },
    SchedulePoint { time_us: 57600000000, value: 2.0 },
    SchedulePoint { time_us: 58500000000, value: 3.0 },
    SchedulePoint { time_us: 59400000000, value: 4.0 },
    SchedulePoint { time_us: 60300000000, value: 5.0 },
    SchedulePoint { time_us: 61200000000, value: 6.0 },
    SchedulePoint { time_us: 62100000000, value: 7.0 },
    SchedulePoint { time_us: 63000000000, value: 1.0 },
    SchedulePoint { time_us: 82800000000, value: 0.0 },
    SchedulePoint { time_us: 0, value: 20.0 },
    SchedulePoint { time_us: 25200000000, value: 200.0 },
    SchedulePoint { time_us: 82800000000, value: 20.0 },
    SchedulePoint { time_us: 0, value: 1.0 },
    SchedulePoint { time_us: 72000000000, value: 1.0 },
    SchedulePoint { time_us: 72005000000, value: 0.0 },
    SchedulePoint { time_us: 73800000000, value: 0.0 },
    SchedulePoint { time_us: 73805000000, value: 1.0 },
];

/// Ids of the nodes.
pub static NODE_NAMES: [&str; 7] = [
    "cabin",
    "plenum",
    "mixer",
    "space",
    "tank",
    "cold",
    "warm",
];

/// Ids of the lines.
pub static LINE_NAMES: [&str; 8] = [
    "intake",
    "che_way",
    "bypass_way",
    "supply",
    "leak",
    "pumped",
    "through_che",
    "return",
];

/// Ids of the elements, one per segment.
pub static SEGMENT_NAMES: [&str; 12] = [
    "grille",
    "fan",
    "che",
    "che_valve",
    "bypass_valve",
    "flow_valve",
    "diffuser",
    "hole",
    "pump",
    "interface",
    "che_coolant",
    "cold_plate",
];

/// Names of the inputs.
pub static INPUT_NAMES: [&str; 57] = [
    "fan.speed",
    "che_valve.opening",
    "bypass_valve.opening",
    "flow_valve.opening",
    "hole.opening",
    "pump.speed",
    "che.separator_efficiency",
    "che.coolant_flow",
    "che.coolant_temperature",
    "che.fouling",
    "che.discharge",
    "interface.power",
    "cold_plate.power",
    "equipment.heat",
    "equipment.nitrogen",
    "equipment.oxygen",
    "equipment.carbon_dioxide",
    "equipment.vapour",
    "equipment.trace",
    "equipment.liquid",
    "lighting.heat",
    "lighting.nitrogen",
    "lighting.oxygen",
    "lighting.carbon_dioxide",
    "lighting.vapour",
    "lighting.trace",
    "lighting.liquid",
    "gases.heat",
    "gases.nitrogen",
    "gases.oxygen",
    "gases.carbon_dioxide",
    "gases.vapour",
    "gases.trace",
    "gases.liquid",
    "crew.count",
    "crew.activity",
    "exerciser.count",
    "exerciser.activity",
    "scrubber.air_flow",
    "scrubber.efficiency",
    "shell.outside",
    "cabin_temperature.setpoint",
    "cabin_temperature.sensor_bias",
    "cabin_temperature.sensor_fault",
    "cabin_temperature.actuator_fault",
    "coolant_temperature.setpoint",
    "coolant_temperature.sensor_bias",
    "coolant_temperature.sensor_fault",
    "coolant_temperature.actuator_fault",
    "oxygen_control.setpoint",
    "oxygen_control.sensor_bias",
    "oxygen_control.sensor_fault",
    "oxygen_control.actuator_fault",
    "pressure_control.setpoint",
    "pressure_control.sensor_bias",
    "pressure_control.sensor_fault",
    "pressure_control.actuator_fault",
];

static PLAN_END_START: [u32; 8] = [0, 3, 6, 9, 10, 12, 14, 16];

static PLAN_ENDS: [u32; 16] = [0, 7, 8, 1, 2, 4, 3, 5, 6, 9, 10, 15, 11, 12, 13, 14];

static PLAN_ORDER: [u32; 6] = [0, 1, 2, 4, 5, 6];

static PLAN_ROW_START: [u32; 7] = [0, 3, 6, 9, 12, 15, 18];

static PLAN_COLUMNS: [u32; 18] = [0, 1, 2, 0, 1, 2, 0, 1, 2, 3, 4, 5, 3, 4, 5, 3, 4, 5];

static PLAN_DIAGONAL: [u32; 6] = [0, 4, 8, 9, 13, 17];

static PLAN_ROW_OF: [u32; 7] = [0, 1, 2, 4294967295, 3, 4, 5];

static PLAN_COMPOSITE: [u32; 0] = [];

static PLAN_STAMPS: [[u32; 4]; 8] = [[0, 1, 3, 4], [4, 5, 7, 8], [4, 5, 7, 8], [8, 6, 2, 0], [0, 4294967295, 4294967295, 4294967295], [9, 10, 12, 13], [13, 14, 16, 17], [17, 15, 11, 9]];

static PLAN_LEAVES: [[u32; 2]; 0] = [];

static PLAN_TERMS: [[u32; 3]; 16] = [[2, 7, 1], [13, 7, 2], [14, 3, 4294967295], [3, 7, 0], [6, 7, 2], [8, 7, 2], [7, 7, 1], [9, 7, 1], [12, 7, 0], [15, 7, 0], [18, 7, 4], [23, 7, 5], [19, 7, 3], [20, 7, 5], [21, 7, 4], [22, 7, 3]];

static PLAN_BETWEEN: [[u32; 2]; 12] = [[4294967295, 4294967295], [0, 1], [4294967295, 4294967295], [1, 2], [1, 2], [4294967295, 4294967295], [2, 0], [0, 3], [4294967295, 4294967295], [4, 5], [5, 6], [6, 4]];

/// What the nodes hold.
pub static VOLUMES: [Volume; 7] = [
    Volume { contents: Air, start_kg: 116.07246, fractions: [0.755162, 0.23253983, 0.005280174, 0.007017973, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Air, start_kg: 0.59396404, fractions: [0.755162, 0.23253983, 0.005280174, 0.007017973, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Air, start_kg: 0.36313313, fractions: [0.75617725, 0.23242448, 0.0052775545, 0.006120714, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Air, start_kg: 1.0, fractions: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Coolant, start_kg: 10.0, fractions: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Coolant, start_kg: 5.0, fractions: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
    Volume { contents: Coolant, start_kg: 5.0, fractions: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], mixing_limit_s: 1800.0, surface_kg_s_pa: 2e-8 },
];

/// What streams meet.
pub static STATIONS: [Station; 6] = [
    Station { segment: 1, line: 0, passage: Machine { power_w: 150.0, speed_input: 0 } },
    Station { segment: 2, line: 1, passage: Condenser(0) },
    Station { segment: 8, line: 5, passage: Machine { power_w: 60.0, speed_input: 5 } },
    Station { segment: 9, line: 5, passage: Heater { power_input: 11 } },
    Station { segment: 10, line: 6, passage: CoolantSide(0) },
    Station { segment: 11, line: 7, passage: Heater { power_input: 12 } },
];

/// Condensers.
pub static EXCHANGERS: [Exchanger; 1] = [
    Exchanger { condenser: Condenser { air_w_k: 490.1, air_reference_kg_s: 0.1, air_exponent: 0.5675, coolant_w_k: 10468.0, coolant_reference_kg_s: 0.0756, capacity_j_k: 12000.0, film_kg: 0.1 }, start_k: 280.0, outlet_node: 2, own_coolant: false, separator_kg: 2.0, discharge_s: 4500.0, slug_kg: 0.05, first_input: 6 },
];

/// Sources.
pub static SOURCES: [Source; 3] = [
    Source { node: 0, first_input: 13 },
    Source { node: 0, first_input: 20 },
    Source { node: 0, first_input: 27 },
];

/// Crews.
pub static CREWS: [Crew; 2] = [
    Crew { node: 0, first_input: 34 },
    Crew { node: 0, first_input: 36 },
];

/// Removers.
pub static REMOVERS: [Remover; 1] = [
    Remover { node: 0, part: 2, first_input: 38 },
];

/// Walls.
pub static WALLS: [Wall; 1] = [
    Wall { node: 0, capacity_j_k: 1000000.0, inner_w_k: 60.0, outer_w_k: 2.0, start_k: 295.0, first_input: 40 },
];

/// Control loops.
pub static LOOPS: [ControlLoop; 4] = [
    ControlLoop { measures: Signal { output: Output::Temperature, owner: 0, item: 0 }, sensor: Sensor { min: 273.0, max: 323.0, lag_s: 20.0, noise: 0.02, seed: 2228928019 }, controller: Pid(::eclss_core::control::Pid { gain: -0.2, integral_s: 900.0, derivative_s: 0.0, dead_band: 0.25, bias: 0.0, rate_per_s: f32::INFINITY }), actuator: Actuator { rate_per_s: 0.06666667, stiction: 0.005, closed: 0.1, open: 1.0 }, drives: 1, opposite: 2, first_input: 41 },
    ControlLoop { measures: Signal { output: Output::Temperature, owner: 5, item: 0 }, sensor: Sensor { min: 273.0, max: 323.0, lag_s: 5.0, noise: 0.0, seed: 1891996012 }, controller: Pid(::eclss_core::control::Pid { gain: -0.05, integral_s: 120.0, derivative_s: 0.0, dead_band: 0.0, bias: 0.0, rate_per_s: f32::INFINITY }), actuator: Actuator { rate_per_s: 0.1, stiction: 0.0, closed: 0.0, open: -8000.0 }, drives: 11, opposite: 4294967295, first_input: 45 },
    ControlLoop { measures: Signal { output: Output::PartialPressure, owner: 0, item: 1 }, sensor: Sensor { min: 0.0, max: 40000.0, lag_s: 0.0, noise: 0.0, seed: 1645029807 }, controller: Thermostat(::eclss_core::control::Thermostat { half_band: 50.0, on_when_high: false }), actuator: Actuator { rate_per_s: 1.0, stiction: 0.0, closed: 0.0, open: 0.0002 }, drives: 29, opposite: 4294967295, first_input: 49 },
    ControlLoop { measures: Signal { output: Output::TotalPressure, owner: 0, item: 0 }, sensor: Sensor { min: 0.0, max: 200000.0, lag_s: 0.0, noise: 0.0, seed: 3483767528 }, controller: Thermostat(::eclss_core::control::Thermostat { half_band: 100.0, on_when_high: false }), actuator: Actuator { rate_per_s: 1.0, stiction: 0.0, closed: 0.0, open: 0.0002 }, drives: 28, opposite: 4294967295, first_input: 53 },
];

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
        climate: Climate {
            reference_k: 295.15,
            air: Medium { flowing_j_kg_k: [1040.0, 919.0, 846.0, 1864.0, 1006.0, 4186.0], resting_j_kg_k: [743.1969, 659.1568, 657.0736, 1402.47, 718.94794, 4186.0], offset_j_kg: [87601.42, 76692.72, 55761.633, 136220.58, 84723.414, 2449828.0], gas_j_kg_k: [296.80307, 259.8432, 188.92642, 461.53, 287.05206, 0.0], latent_j_kg: 2449828.0, expansion_1_k: 0.0 },
            coolant: Medium { flowing_j_kg_k: [4186.0, 0.0, 0.0, 0.0, 0.0, 0.0], resting_j_kg_k: [4186.0, 0.0, 0.0, 0.0, 0.0, 0.0], offset_j_kg: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], gas_j_kg_k: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], latent_j_kg: 0.0, expansion_1_k: 0.00011 },
            volumes: &VOLUMES,
            stations: &STATIONS,
            exchangers: &EXCHANGERS,
            sources: &SOURCES,
            crews: &CREWS,
            removers: &REMOVERS,
            walls: &WALLS,
            loops: &LOOPS,
        },
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
