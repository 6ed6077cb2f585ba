//! The same bits with any number of threads, and as a step in one piece.

use eclss_core::climate::medium::{self, Medium};
use eclss_core::climate::{Contents, Volume};
use eclss_core::element::{Fan, HeadCurve, HeatExchanger, Pipe, Valve};
use eclss_core::{
    Active, Buffers, Climate, Element, Health, Line, Method, Network, Node, NodeKind, Place, Plan, Segment,
    Settings, Simulator, StdElement, moist,
};
use eclss_network_file::generate::{Shape, generate};
use eclss_network_file::parse;
use eclss_parallel::{ParallelBuffers, Threads};

const STEP_US: u32 = 1_000;

/// A network whose connections and elements are drawn.
#[derive(Default)]
struct Drawn {
    nodes: Vec<Node>,
    lines: Vec<Line>,
    segments: Vec<Segment>,
    active: Vec<Active>,
    inputs: Vec<f32>,
    end_start: Vec<u32>,
    ends: Vec<u32>,
    dice: u64,
}

impl Drawn {
    /// `nodes` nodes in a tree with `more` lines across it; one line in `special` has a valve, a fan or an exchanger
    /// that drains.
    fn new(nodes: u32, more: u32, special: u64) -> Self {
        let mut drawn = Self { dice: 1, ..Self::default() };
        for index in 0..nodes {
            let volume_m3 = [0.01, 1.0, 60.0][drawn.throw(3) as usize];
            let kind = if index == 0 { NodeKind::Boundary } else { NodeKind::Cabin { volume_m3 } };
            let start_gauge_pa = drawn.throw(200) as f32 - 100.0;
            drawn.nodes.push(Node { kind, start_gauge_pa, temperature_k: 295.15 });
        }
        for index in 1..nodes {
            let parent = drawn.throw(u64::from(index)) as u32;
            drawn.line(parent, index, special);
        }
        for _ in 0..more {
            let (from, to) = (drawn.throw(u64::from(nodes)) as u32, drawn.throw(u64::from(nodes)) as u32);
            drawn.line(from, to, special);
        }
        let mut of_node = vec![Vec::new(); drawn.nodes.len()];
        for (index, line) in (0u32..).zip(&drawn.lines) {
            of_node[line.from as usize].push(2 * index);
            of_node[line.to as usize].push(2 * index + 1);
        }
        drawn.end_start.push(0);
        for ends in of_node {
            drawn.ends.extend(ends);
            drawn.end_start.push(drawn.ends.len() as u32);
        }
        drawn
    }

    /// Knuth's MMIX generator: the same network on every machine.
    fn throw(&mut self, below: u64) -> u64 {
        self.dice = self.dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.dice >> 33) % below
    }

    fn line(&mut self, from: u32, to: u32, special: u64) {
        let resistance_pa_s2_kg2 = 10.0 + self.throw(1_000) as f32;
        let mut elements = vec![StdElement::Pipe(Pipe { resistance_pa_s2_kg2 })];
        if self.throw(special) == 0 {
            let curve = HeadCurve { shutoff_pa: 50.0, linear_pa_s_kg: 10.0, quadratic_pa_s2_kg2: 900.0 };
            elements.push(match self.throw(3) {
                0 => StdElement::Valve(Valve {
                    open_resistance_pa_s2_kg2: 80.0,
                    exponent: 3.0,
                    leakage_opening: 1e-3,
                }),
                1 => StdElement::Fan(Fan { curve }),
                _ => StdElement::HeatExchanger(HeatExchanger {
                    resistance_pa_s2_kg2: 900.0,
                    liquid_fraction: 0.0045,
                    separator_efficiency: 1.0,
                }),
            });
        }
        let line = self.lines.len() as u32;
        self.lines.push(Line {
            from,
            to,
            first_segment: self.segments.len() as u32,
            segments: elements.len() as u32,
            flow_segment: 0,
            laminar_below_pa: 1e-3,
            start_flow_kg_s: 0.0,
        });
        for element in elements {
            if element.is_active() {
                self.active.push(Active { segment: self.segments.len() as u32, line });
            }
            let first_input = self.inputs.len() as u32;
            self.inputs.extend((0..).map_while(|index| element.input_spec(index)).map(|spec| spec.default));
            self.segments.push(Segment { element, inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input });
        }
    }

    fn network(&self) -> Network<'_> {
        Network {
            reference_pa: 101_325.0,
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            responsive: &[],
            inputs: &self.inputs,
            schedules: &[],
            points: &[],
            plan: Plan { end_start: &self.end_start, ends: &self.ends, ..Plan::EMPTY },
            climate: Climate::NONE,
        }
    }
}

/// Hash, smallest φ, the nodes' pressures and what lines and nodes have booked.
type Figures = (u64, u32, Vec<[u32; 2]>, [f64; 3]);

fn figures(simulator: &Simulator<'_>) -> Figures {
    let (nodes, lines) = (simulator.network().nodes.len(), simulator.network().lines.len());
    let pressures = (0..nodes).map(|node| [simulator.node_gauge_pa(node), simulator.node_phi(node)]);
    let sums = (0..lines).map(|line| simulator.line_sums_kg(line));
    let booked =
        sums.fold([0.0; 3], |[a, b, c], [taken, given, drained]| [a + taken, b + given, c + drained]);
    let pressures = pressures.map(|pair| pair.map(f32::to_bits)).collect();
    (simulator.state_hash(), simulator.worst_margin().phi.to_bits(), pressures, booked)
}

/// Steps in one piece; figures after every `every` steps.
fn in_one_piece(network: &Network<'_>, steps: usize, every: usize) -> Vec<Figures> {
    let sizes = Method::Adaptive.sizes(network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let settings = Settings { method: Method::Adaptive, step_us: STEP_US };
    let mut simulator = Simulator::new(network, settings, buffers).expect("adaptive takes it");
    let mut seen = Vec::new();
    for step in 1..=steps {
        assert_eq!(simulator.step(), Health::Trusted);
        if step % every == 0 {
            seen.push(figures(&simulator));
        }
    }
    seen
}

fn with_threads(network: &Network<'_>, threads: usize, steps: usize, every: usize) -> Vec<Figures> {
    let mut buffers = ParallelBuffers::new(network);
    let mut simulator = buffers.simulator(network, STEP_US).expect("adaptive takes it");
    let threads = Threads::new(threads).expect("threads start");
    let mut seen = Vec::new();
    for step in 1..=steps {
        assert_eq!(threads.step(&mut simulator), Health::Trusted);
        if step % every == 0 {
            seen.push(figures(simulator.simulator()));
        }
    }
    seen
}

fn compare(network: &Network<'_>, what: &str) {
    const STEPS: usize = 60;
    const EVERY: usize = 20;
    let expected = in_one_piece(network, STEPS, EVERY);
    assert!(expected[0].0 != expected[1].0, "{what}: the state moves");
    for threads in [1, 2, 3, 4, 7] {
        let seen = with_threads(network, threads, STEPS, EVERY);
        let hashes = |figures: &[Figures]| figures.iter().map(|(hash, ..)| *hash).collect::<Vec<_>>();
        assert!(
            seen == expected,
            "{what} with {threads} threads: {:x?}, not {:x?}",
            hashes(&seen),
            hashes(&expected)
        );
    }
}

/// Large enough to be cut into many ranges of lines and of nodes.
#[test]
fn any_number_of_threads_gives_the_bits_of_a_step_in_one_piece() {
    for (special, what) in [(50, "few special lines"), (1, "all lines special"), (1_000_000, "hardly any")] {
        let drawn = Drawn::new(10_000, 5_000, special);
        compare(&drawn.network(), what);
    }
}

/// Where nodes hold air with heat and vapour, whose pressure the climate states after every step.
#[test]
fn a_climate_gives_the_same_bits() {
    let mut drawn = Drawn::new(3_000, 1_000, 60);
    for segment in &mut drawn.segments {
        // A climate wants to know where what is drained goes.
        if let StdElement::HeatExchanger(HeatExchanger { resistance_pa_s2_kg2, .. }) = segment.element {
            segment.element = StdElement::Pipe(Pipe { resistance_pa_s2_kg2 });
        }
    }
    // What a step carries through the smallest drawn volumes is more than they hold.
    for node in drawn.nodes.iter_mut().skip(1) {
        node.kind = NodeKind::Cabin { volume_m3: 60.0 };
    }
    let fractions = [0.75, 0.23, 0.0, 0.02, 0.0, 0.0];
    let gas = medium::dot(&fractions, &medium::GAS_CONSTANTS_J_KG_K);
    let volume = |node: &Node| {
        let volume_m3 = if let NodeKind::Cabin { volume_m3 } = node.kind { volume_m3 } else { 1.0 };
        let start_kg = (101_325.0 + node.start_gauge_pa) * volume_m3 / (gas * node.temperature_k);
        Volume {
            contents: Contents::Air,
            start_kg,
            fractions,
            mixing_limit_s: 1_800.0,
            surface_kg_s_pa: 1e-7,
        }
    };
    let volumes: Vec<Volume> = drawn.nodes.iter().map(volume).collect();
    let climate = Climate {
        reference_k: 295.15,
        air: Medium::air(295.15),
        coolant: Medium::coolant(moist::LIQUID_HEAT_J_KG_K),
        volumes: &volumes,
        ..Climate::NONE
    };
    compare(&Network { climate, ..drawn.network() }, "climate");
}

/// What the command line makes, with its schedule: smaller than a range in parts.
#[test]
fn a_generated_mesh_gives_the_same_bits() {
    let text = generate(Shape::Mesh, 1_900, 7).expect("a size that files hold").to_toml();
    let loaded = parse(&text, "mesh.toml").expect("what is generated is accepted");
    compare(&loaded.network(), "mesh");
}

/// A flow out of range ends both runs in the same tick, with the same line named.
#[test]
fn a_fault_is_found_in_the_same_place() {
    let mut drawn = Drawn::new(6_000, 500, 40);
    for line in [5_100, 777] {
        let segment = drawn.lines[line].first_segment as usize;
        drawn.segments[segment].element = StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 1e-9 });
    }
    let network = drawn.network();
    let sizes = Method::Adaptive.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let settings = Settings { method: Method::Adaptive, step_us: STEP_US };
    let mut whole = Simulator::new(&network, settings, buffers).expect("adaptive takes it");
    let mut buffers = ParallelBuffers::new(&network);
    let mut split = buffers.simulator(&network, STEP_US).expect("adaptive takes it");
    let threads = Threads::new(3).expect("threads start");
    for _ in 0..3 {
        let health = whole.step();
        assert_eq!(threads.step(&mut split), health);
        assert!(matches!(health, Health::Faulted(fault) if fault.place == Place::Line(777)), "{health:?}");
    }
}
