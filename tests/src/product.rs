//! The product under test: the paper's loop with its valve schedule, and a run that lends it buffers.

use eclss_core::components::Valve;
use eclss_core::{
    Active, AnyComponent, BuildError, Element, Health, Interpolation, Line, Method, Network, Node, NodeKind,
    Plan, Schedule, SchedulePoint, Segment, Settings, Simulator, example,
};

static RAMP: [SchedulePoint; 3] = [
    SchedulePoint { time_us: 0, value: 1.0 },
    SchedulePoint { time_us: 10_000_000, value: 1.0 },
    SchedulePoint { time_us: 11_000_000, value: 0.02 },
];
static SCHEDULES: [Schedule; 1] =
    [Schedule { input: 1, first_point: 0, points: 3, interpolation: Interpolation::Linear }];

/// Returns the paper's loop whose valve stays open until 10 s and closes linearly to 2 % at 11 s.
pub fn closing_loop() -> Network<'static> {
    Network { schedules: &SCHEDULES, points: &RAMP, ..example::paper_loop() }
}

/// Returns the start values of the paper's inputs with the valve at `opening` [1].
pub fn held_at(opening: f32) -> [f32; 2] {
    [1.0, opening]
}

/// Builds a simulator over buffers of just the size it asks for and hands it to `body`.
pub fn with_simulator<T>(
    network: &Network<'_>,
    method: Method,
    step_us: u32,
    body: impl FnOnce(&mut Simulator<'_>) -> T,
) -> Result<T, BuildError> {
    let sizes = method.sizes(network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = eclss_core::Buffers {
        state: &mut state,
        work: &mut work,
        inputs: &mut inputs,
        cursors: &mut cursors,
    };
    Simulator::new(network, Settings { method, step_us }, buffers).map(|mut simulator| body(&mut simulator))
}

/// Steps until plant time `until_us` [µs] or until the run is no longer trusted, whichever comes first.
pub fn step_until(simulator: &mut Simulator<'_>, until_us: u64) -> Health {
    while simulator.time_us() < until_us && simulator.step() == Health::Trusted {}
    simulator.health()
}

/// Runs the closing loop and returns (time [s], flow [kg/s]) after every step up to `until_us` [µs].
pub fn closing_flows(method: Method, step_us: u32, until_us: u64) -> Result<Vec<(f64, f64)>, BuildError> {
    with_simulator(&closing_loop(), method, step_us, |simulator| {
        let mut flows = Vec::new();
        while simulator.time_us() < until_us && simulator.step() == Health::Trusted {
            let valve = simulator.network().lines[0].last_segment() as usize;
            let flow = simulator.segment_flow_at_end_kg_s(0, valve);
            flows.push((simulator.time_us() as f64 * 1e-6, f64::from(flow)));
        }
        flows
    })
}

/// Runs the loop with the valve held at `opening` [1] until `until_us` [µs] and returns its flow [kg/s].
pub fn settled_flow_kg_s(opening: f32, step_us: u32, until_us: u64) -> Result<f64, BuildError> {
    let inputs = held_at(opening);
    let network = Network { inputs: &inputs, ..example::paper_loop() };
    with_simulator(&network, Method::Relaxation, step_us, |simulator| {
        step_until(simulator, until_us);
        f64::from(simulator.line_flow_kg_s(0))
    })
}

/// Returns the paper's loop with its six elements in another `order`, the flow state on place `flow_segment` of
/// the new order and the valve at `opening` [1].
pub fn reordered_loop(order: [usize; 6], flow_segment: usize, opening: f32) -> Tables {
    let elements = order.map(|index| example::paper_loop().segments[index].element);
    let mut tables = Tables::default();
    let cabin = tables.node(Some(60.0), 0.0);
    tables.line((cabin, cabin), &elements, flow_segment, 0.0, 1e-3);
    for segment in &tables.segments {
        if segment.element.is::<Valve>() {
            tables.inputs[segment.first_input as usize] = opening;
        }
    }
    tables
}

/// Returns the order of the paper's elements with the valve moved to place `valve` (0…5).
pub fn valve_at(valve: usize) -> [usize; 6] {
    let mut order = [0, 1, 2, 3, 4, 5];
    order[valve..].rotate_right(1);
    order
}

/// A network's tables as vectors, for descriptions that a test makes up.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Segments of all lines in line order.
    pub segments: Vec<Segment>,
    /// Start values of the inputs.
    pub inputs: Vec<f32>,
    active: Vec<Active>,
}

impl Tables {
    /// Adds a node at `gauge_pa` [Pa]: a cabin of `volume_m3` [m³], or a boundary for `None`.
    pub fn node(&mut self, volume_m3: Option<f32>, gauge_pa: f32) -> u32 {
        let kind = volume_m3.map_or(NodeKind::Boundary, |volume_m3| NodeKind::Cabin { volume_m3 });
        self.nodes.push(Node { kind, start_gauge_pa: gauge_pa, temperature_k: 295.15 });
        self.nodes.len() as u32 - 1
    }

    /// Adds a line of `elements` from node to node with its flow state on `flow_segment` and start flow
    /// `start_kg_s` [kg/s], linear below `laminar_pa` [Pa].
    pub fn line(
        &mut self,
        (from, to): (u32, u32),
        elements: &[AnyComponent],
        flow_segment: usize,
        laminar_pa: f32,
        start_kg_s: f32,
    ) {
        let line = self.lines.len() as u32;
        self.lines.push(Line {
            from,
            to,
            first_segment: self.segments.len() as u32,
            segments: elements.len() as u32,
            flow_segment: flow_segment as u32,
            laminar_below_pa: laminar_pa,
            start_flow_kg_s: start_kg_s,
        });
        for element in elements {
            if element.is_active() {
                self.active.push(Active { segment: self.segments.len() as u32, line });
            }
            let first_input = self.inputs.len() as u32;
            self.inputs.extend((0..).map_while(|index| element.input_spec(index)).map(|spec| spec.default));
            let (inertance_per_m, outlet_volume_m3) = (254.648, 0.0);
            self.segments.push(Segment { element: *element, inertance_per_m, outlet_volume_m3, first_input });
        }
    }

    /// Borrows the tables as a description.
    pub fn network(&self) -> Network<'_> {
        Network {
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            inputs: &self.inputs,
            plan: Plan::EMPTY,
            ..example::paper_loop()
        }
    }
}
