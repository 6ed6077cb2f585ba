//! Draws a network: topology, volumes, elements, step and what its inputs do.

use eclss_core::components::{
    Bed, CheckValve, Fan, HeadCurve, HeatExchanger, Pipe, Pump, ReferencePipe, Valve,
};
use eclss_core::{Active, AnyComponent, Element, Line, Network, Node, NodeKind, Responsive, Segment};
use eclss_network_file::PlanTables;

use crate::dice::Dice;

/// A network as tables, and how it is run.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Segments of all lines.
    pub segments: Vec<Segment>,
    /// Start value of every input.
    pub inputs: Vec<f32>,
    /// Step [µs], 100 … 100 000.
    pub step_us: u32,
    active: Vec<Active>,
    responsive: Vec<Responsive>,
    plan: PlanTables,
}

/// What may be drawn.
#[derive(Debug, Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "each may be drawn or not, whatever the others")]
pub struct Kinds {
    /// Nodes without volume, which `adaptive` does not take.
    pub junctions: bool,
    /// Elements whose law follows the flow: power laws and linear falls of a head.
    pub follow_flow: bool,
    /// Elements that take mass out.
    pub drains: bool,
    /// Check valves.
    pub check_valves: bool,
}

impl Kinds {
    /// Everything.
    pub const ALL: Self = Self { junctions: true, follow_flow: true, drains: true, check_valves: true };
}

impl Drawn {
    /// Draws a network of 2 … 40 nodes in one piece.
    pub fn new(dice: &mut Dice, kinds: Kinds) -> Self {
        let count = 2 + (39.0 * dice.unit() * dice.unit()) as u32;
        let mut drawn = Self {
            nodes: Vec::new(),
            lines: Vec::new(),
            segments: Vec::new(),
            inputs: Vec::new(),
            step_us: dice.power_of_ten(2.0, 5.0) as u32,
            active: Vec::new(),
            responsive: Vec::new(),
            plan: PlanTables::default(),
        };
        let held = dice.chance(0.75);
        for index in 0..count {
            drawn.node(dice, index == 0 && held, index > 0 && kinds.junctions);
        }
        // A tree that reaches every node: long as a chain, broad as a star, or between the two.
        let reach = dice.whole(1, count as usize) as u32;
        for node in 1..count {
            let other = node - 1 - (dice.unit() * f64::from(reach.min(node))) as u32;
            drawn.line(dice, node, other, kinds);
        }
        for _ in 0..dice.whole(0, count as usize) {
            let node = |dice: &mut Dice| (dice.unit() * f64::from(count)) as u32;
            // Now and then the same node twice: a loop through a cabin.
            let (from, to) = (node(dice), node(dice));
            drawn.line(dice, from, to, kinds);
        }
        drawn.inputs = drawn.drawn_inputs(dice);
        drawn.plan = PlanTables::new(&drawn.nodes, &drawn.lines, &drawn.segments);
        drawn
    }

    fn node(&mut self, dice: &mut Dice, held: bool, junctions: bool) {
        let volume_m3 = dice.power_of_ten(-4.0, 2.0) as f32;
        let kind = match dice.unit() {
            _ if held => NodeKind::Boundary,
            share if share < 0.05 => NodeKind::Boundary,
            share if junctions && share < 0.25 => NodeKind::Junction,
            _ => NodeKind::Cabin { volume_m3 },
        };
        // Far from everything else, but not so far that a fan could ask for less than a vacuum.
        let airlock = kind == NodeKind::Boundary && dice.chance(0.05);
        let start_gauge_pa = if airlock { -90_000.0 } else { dice.between(-300.0, 300.0) as f32 };
        self.nodes.push(Node { kind, start_gauge_pa, temperature_k: dice.between(275.0, 310.0) as f32 });
    }

    fn line(&mut self, dice: &mut Dice, one: u32, other: u32, kinds: Kinds) {
        let (from, to) = if dice.chance(0.5) { (one, other) } else { (other, one) };
        let elements = dice.whole(1, 4);
        let resistance = dice.power_of_ten(2.0, 7.0);
        let (columns, volumes) = (dice.chance(0.6), dice.chance(0.4));
        // Drawn for every line, but a node without volume passes on what comes in: a column of air that starts to run
        // against it on its own would have to be stopped at once, by a pressure without bound.
        let passes_on = [from, to].map(|node| self.nodes[node as usize].kind == NodeKind::Junction);
        self.lines.push(Line {
            from,
            to,
            first_segment: self.segments.len() as u32,
            segments: elements as u32,
            flow_segment: dice.whole(0, elements - 1) as u32,
            laminar_below_pa: dice.power_of_ten(-4.0, 0.0) as f32,
            start_flow_kg_s: if dice.chance(0.5) { 0.0 } else { dice.between(-0.05, 0.05) as f32 },
        });
        if let (true, Some(line)) = (passes_on.contains(&true), self.lines.last_mut()) {
            line.start_flow_kg_s = 0.0;
        }
        for _ in 0..elements {
            let element = element(dice, resistance / elements as f64, kinds);
            let first_input = self.inputs.len() as u32;
            self.inputs.extend((0..).map_while(|index| element.input_spec(index)).map(|spec| spec.default));
            self.segments.push(Segment {
                element,
                inertance_per_m: if columns { dice.power_of_ten(0.0, 3.0) as f32 } else { 0.0 },
                outlet_volume_m3: if volumes { dice.power_of_ten(-6.0, -2.0) as f32 } else { 0.0 },
                first_input,
            });
        }
        let line = self.lines.len() as u32 - 1;
        let first = self.lines[line as usize].first_segment;
        let own = &self.segments[first as usize..];
        if own.iter().any(|segment| segment.element.responds()) {
            self.responsive.push(Responsive { line, first_memory: 0, reference_density_kg_m3: 0.0 });
            return;
        }
        let active = (first..).zip(own).filter(|(_, segment)| segment.element.is_active());
        self.active.extend(active.map(|(segment, _)| Active { segment, line }));
    }

    /// Draws a value for every input: valves shut, open or between, machines at any speed.
    pub fn drawn_inputs(&self, dice: &mut Dice) -> Vec<f32> {
        let mut inputs = self.inputs.clone();
        for segment in &self.segments {
            let slot = segment.first_input as usize;
            let element = &segment.element;
            if element.is::<Valve>() {
                inputs[slot] =
                    if dice.chance(0.7) { f32::from(u8::from(dice.chance(0.5))) } else { dice.unit() as f32 };
            } else if element.is::<Fan>() || element.is::<Pump>() {
                inputs[slot] = dice.between(0.0, 1.5) as f32;
            }
        }
        inputs
    }

    /// Borrows the tables as a description that starts with these inputs.
    pub fn network<'n>(&'n self, inputs: &'n [f32]) -> Network<'n> {
        Network {
            // As high as any pressure may deviate from it: here it is arithmetic that is tried, and no law of these
            // elements looks at absolute pressure. A valve that shuts at once before a column of air has one of
            // w·√(I/C) behind it, 1.4 MPa below the others in one of the first 2000 networks.
            reference_pa: eclss_core::Fault::GAUGE_LIMIT_PA,
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            responsive: &self.responsive,
            inputs,
            schedules: &[],
            points: &[],
            plan: self.plan.plan(),
            climate: eclss_core::Climate::NONE,
        }
    }
}

fn element(dice: &mut Dice, resistance: f64, kinds: Kinds) -> AnyComponent {
    let resistance_pa_s2_kg2 = resistance as f32;
    match dice.unit() {
        share if share < 0.2 => Valve {
            open_resistance_pa_s2_kg2: resistance_pa_s2_kg2.min(1e5),
            exponent: dice.between(1.0, 3.2) as f32,
            leakage_opening: 1e-3,
        }
        .into_any(),
        share if share < 0.35 => {
            let linear_pa_s_kg = if kinds.follow_flow { dice.power_of_ten(0.0, 3.0) as f32 } else { 0.0 };
            let shutoff_pa = dice.between(0.0, 500.0) as f32;
            Fan::new(HeadCurve { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2: resistance_pa_s2_kg2 })
                .into_any()
        }
        share if share < 0.42 && kinds.drains => HeatExchanger {
            resistance_pa_s2_kg2,
            liquid_fraction: dice.between(0.0, 0.02) as f32,
            separator_efficiency: 1.0,
        }
        .into_any(),
        share if share < 0.46 && kinds.drains => {
            let mass_fraction = dice.between(0.0, 0.01) as f32;
            Bed { resistance_pa_s2_kg2, mass_fraction, capture_efficiency: 0.9 }.into_any()
        }
        share if share < 0.56 && kinds.follow_flow => {
            let mass_flow_kg_s = 0.05f32;
            ReferencePipe {
                pressure_drop_pa: resistance_pa_s2_kg2 * mass_flow_kg_s * mass_flow_kg_s,
                mass_flow_kg_s,
                exponent: dice.between(1.0, 2.0) as f32,
            }
            .into_any()
        }
        share if share < 0.64 && kinds.check_valves => {
            CheckValve { resistance_pa_s2_kg2, reverse_pa_s_kg: dice.power_of_ten(6.0, 10.0) as f32 }
                .into_any()
        }
        _ => Pipe::new(resistance_pa_s2_kg2).into_any(),
    }
}
