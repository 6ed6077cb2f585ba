//! One cabin with crew, walls and a condensing heat exchanger: ledgers over a day, and what follows in closed form.

use eclss_core::climate::condenser::Condenser;
use eclss_core::climate::medium::{self, Medium};
use eclss_core::climate::{Contents, Crew, Exchanger, Passage, Remover, Source, Station, Volume, Wall};
use eclss_core::element::{Fan, HeadCurve, Pipe};
use eclss_core::{
    Active, Buffers, Climate, Health, Line, Method, Network, Node, NodeKind, Plan, Segment, Settings,
    Simulator, StdElement, air, moist,
};

const REFERENCE_K: f32 = 295.15;
const PRESSURE_PA: f32 = 101_325.0;

/// Mass fractions of air with these partial pressures [Pa] of oxygen, carbon dioxide and vapour, the rest nitrogen.
fn fractions(oxygen: f64, carbon_dioxide: f64, vapour: f64) -> [f32; 6] {
    let pressures =
        [f64::from(PRESSURE_PA) - oxygen - carbon_dioxide - vapour, oxygen, carbon_dioxide, vapour];
    let masses: Vec<f64> =
        pressures.iter().zip(medium::GAS_CONSTANTS_J_KG_K).map(|(p, gas)| p / f64::from(gas)).collect();
    let sum: f64 = masses.iter().sum();
    let mut parts = [0.0; 6];
    for (part, mass) in parts.iter_mut().zip(masses) {
        *part = (mass / sum) as f32;
    }
    parts
}

/// A cabin, its loop through fan and exchanger, and what lives in it; inputs by their slots.
struct Cabin {
    nodes: Vec<Node>,
    volumes: Vec<Volume>,
    inputs: Vec<f32>,
    exchangers: Vec<Exchanger>,
    stations: Vec<Station>,
    sources: Vec<Source>,
    crews: Vec<Crew>,
    removers: Vec<Remover>,
    walls: Vec<Wall>,
}

const SPEED: usize = 0;
const CREW: usize = 1;
const SOURCE: usize = 3;
const REMOVER: usize = 10;
const EXCHANGER: usize = 12;
const WALL: usize = 15;

impl Cabin {
    fn new(volume_m3: f32, temperature_k: f32, vapour_pa: f64) -> Self {
        let parts = fractions(21_200.0, 400.0, vapour_pa);
        let gas = medium::dot(&parts, &medium::GAS_CONSTANTS_J_KG_K);
        let volume = Volume {
            contents: Contents::Air,
            start_kg: PRESSURE_PA * volume_m3 / (gas * temperature_k),
            fractions: parts,
            mixing_limit_s: 1_800.0,
            surface_kg_s_pa: 1e-7,
        };
        let mut inputs = vec![0.0; 16];
        inputs[SPEED] = 1.0;
        inputs[CREW + 1] = 1.0;
        inputs[REMOVER + 1] = 1.0;
        inputs[EXCHANGER] = 0.95;
        inputs[EXCHANGER + 2] = 277.6;
        inputs[WALL] = REFERENCE_K;
        Self {
            nodes: vec![Node { kind: NodeKind::Cabin { volume_m3 }, start_gauge_pa: 0.0, temperature_k }],
            volumes: vec![volume],
            inputs,
            exchangers: vec![],
            stations: vec![],
            sources: vec![Source { node: 0, first_input: SOURCE as u32 }],
            crews: vec![],
            removers: vec![],
            walls: vec![],
        }
    }

    fn with_exchanger(mut self) -> Self {
        self.exchangers.push(Exchanger {
            condenser: Condenser::CCAA,
            start_k: REFERENCE_K,
            outlet_node: 0,
            own_coolant: true,
            separator_kg: 1.0,
            discharge_s: 4_500.0,
            slug_kg: 0.02,
            first_input: EXCHANGER as u32,
        });
        self.stations = vec![
            Station {
                segment: 0,
                line: 0,
                passage: Passage::Machine { power_w: 150.0, speed_input: SPEED as u32 },
            },
            Station { segment: 1, line: 0, passage: Passage::Condenser(0) },
        ];
        self.inputs[EXCHANGER + 1] = 0.075_6;
        self
    }

    /// Runs `each` on a simulator of this cabin.
    fn run<T>(&self, method: Method, step_us: u32, each: impl FnOnce(&mut Simulator<'_>) -> T) -> T {
        let curve = HeadCurve { shutoff_pa: 600.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 3_000.0 };
        let segment =
            |element| Segment { element, inertance_per_m: 20.0, outlet_volume_m3: 0.0, first_input: 0 };
        let segments = [
            segment(StdElement::Fan(Fan { curve })),
            segment(StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 7_000.0 })),
        ];
        let lines = [Line {
            from: 0,
            to: 0,
            first_segment: 0,
            segments: 2,
            flow_segment: 1,
            laminar_below_pa: 1e-3,
            start_flow_kg_s: 0.0,
        }];
        let network = Network {
            reference_pa: PRESSURE_PA,
            nodes: &self.nodes,
            lines: &lines,
            segments: &segments,
            active: &[Active { segment: 0, line: 0 }],
            inputs: &self.inputs,
            schedules: &[],
            points: &[],
            plan: Plan {
                end_start: &[0, 2],
                ends: &[0, 1],
                order: &[0],
                row_start: &[0, 1],
                columns: &[0],
                diagonal: &[0],
                stamps: &[[0, Plan::NOWHERE, Plan::NOWHERE, 0]],
                row_of: &[0],
            },
            climate: Climate {
                reference_k: REFERENCE_K,
                air: Medium::air(REFERENCE_K),
                coolant: Medium::coolant(moist::LIQUID_HEAT_J_KG_K),
                volumes: &self.volumes,
                stations: &self.stations,
                exchangers: &self.exchangers,
                sources: &self.sources,
                crews: &self.crews,
                removers: &self.removers,
                walls: &self.walls,
                loops: &[],
            },
        };
        let sizes = method.sizes(&network);
        let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
        let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
        let buffers =
            Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
        let mut simulator = Simulator::new(&network, Settings { method, step_us }, buffers).unwrap();
        each(&mut simulator)
    }
}

#[test]
fn ledgers_of_a_day_close() {
    let mut cabin = Cabin::new(97.71, 295.35, 1_100.0).with_exchanger();
    cabin.crews.push(Crew { node: 0, first_input: CREW as u32 });
    cabin.removers.push(Remover {
        node: 0,
        part: medium::CARBON_DIOXIDE as u32,
        first_input: REMOVER as u32,
    });
    cabin.walls.push(Wall {
        node: 0,
        capacity_j_k: 5e5,
        inner_w_k: 50.0,
        outer_w_k: 5.0,
        start_k: 295.0,
        first_input: WALL as u32,
    });
    cabin.inputs[CREW] = 4.0;
    cabin.inputs[REMOVER] = 0.012;
    cabin.inputs[SOURCE] = 700.0;
    for method in [Method::Adaptive, Method::ImplicitEuler] {
        cabin.run(method, 10_000, |simulator| {
            let clock = std::time::Instant::now();
            for tick in 0..8_640_000u64 {
                // A day: sleep, then work, exercise and recovery in turn.
                let activity = if tick < 2_880_000 { 0.0 } else { ((tick / 90_000) % 8) as f32 };
                if tick % 90_000 == 0 {
                    assert!(simulator.set_input(CREW + 1, activity));
                }
                simulator.step();
            }
            println!("{method:?}: {:.2} s; {:?}", clock.elapsed().as_secs_f64(), simulator.air(0));
            println!("{:?}", simulator.exchanger(0));
            assert_eq!(simulator.health(), Health::Trusted);
            for ledger in simulator.ledgers() {
                println!("{ledger:?}");
                let bar = if ledger.name == "energy" { 1e-5 } else { 1e-6 };
                assert!(ledger.gap().abs() <= bar * ledger.turned_over.max(1e-3), "{ledger:?}");
            }
            let [_, oxygen, carbon_dioxide, _, water, _, energy] = simulator.ledgers();
            assert!(oxygen.turned_over > 2.0 && carbon_dioxide.turned_over > 4.0 && water.turned_over > 6.0);
            assert!(energy.turned_over > 1e8);
            assert!(simulator.exchanger(0).unwrap().tank_kg > 1.0);
        });
    }
}
