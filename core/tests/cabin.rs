//! One cabin with crew, walls and a condensing heat exchanger: ledgers over a day, and what follows in closed form.

use eclss_core::climate::{Contents, Volume};
use eclss_core::component::{Passage, Placed, Table};
use eclss_core::components::coil::Condenser;
use eclss_core::components::{CondensingHeatExchanger, Crew, Fan, HeadCurve, Remover, Source, Wall};
use eclss_core::fluid::medium::{self, Medium};
use eclss_core::{
    Active, AnyComponent, Buffers, Climate, Component, Health, Line, Method, Network, Node, NodeKind, Output,
    Plan, Segment, Settings, Simulator, moist,
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
    /// Components that act on the cabin, with their first inputs, each of another kind.
    components: Vec<(AnyComponent, usize)>,
    power_w: f32,
}

/// The station's coil behind a loss.
const COIL: CondensingHeatExchanger = CondensingHeatExchanger {
    resistance_pa_s2_kg2: 7_000.0,
    least_opening: 0.0,
    air_w_k: Condenser::CCAA.air_w_k,
    air_reference_kg_s: Condenser::CCAA.air_reference_kg_s,
    air_exponent: Condenser::CCAA.air_exponent,
    coolant_w_k: Condenser::CCAA.coolant_w_k,
    coolant_reference_kg_s: Condenser::CCAA.coolant_reference_kg_s,
    capacity_j_k: Condenser::CCAA.capacity_j_k,
    film_kg: Condenser::CCAA.film_kg,
    start_k: REFERENCE_K,
    separator_kg: 1.0,
    discharge_s: 4_500.0,
    slug_kg: 0.02,
};
const CURVE: HeadCurve = HeadCurve { shutoff_pa: 600.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 3_000.0 };

/// Figure `name` of the coil, which is placed component 1.
fn of_coil(simulator: &Simulator<'_>, name: &str) -> f64 {
    let item = CondensingHeatExchanger::OUTPUTS.iter().position(|output| output.name == name).unwrap();
    simulator.signal(Output::Figure.item(1, item)).into()
}

const SPEED: usize = 0;
const CREW: usize = 1;
const SOURCE: usize = 3;
const REMOVER: usize = 10;
const EXCHANGER: usize = 12;
const WALL: usize = 17;

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
        let mut inputs = vec![0.0; 18];
        inputs[SPEED] = 1.0;
        inputs[CREW + 1] = 1.0;
        inputs[REMOVER + 1] = 1.0;
        inputs[EXCHANGER] = 0.95;
        inputs[EXCHANGER + 2] = 277.6;
        inputs[EXCHANGER + 4] = 1.0;
        inputs[WALL] = REFERENCE_K;
        Self {
            nodes: vec![Node { kind: NodeKind::Cabin { volume_m3 }, start_gauge_pa: 0.0, temperature_k }],
            volumes: vec![volume],
            inputs,
            components: vec![(Source {}.into_any(), SOURCE)],
            power_w: 0.0,
        }
    }

    fn with_exchanger(mut self) -> Self {
        self.power_w = 150.0;
        self.components.insert(0, (COIL.into_any(), EXCHANGER));
        self.inputs[EXCHANGER + 1] = 0.075_6;
        self
    }

    /// Runs `each` on a simulator of this cabin.
    fn run<T>(&self, method: Method, step_us: u32, each: impl FnOnce(&mut Simulator<'_>) -> T) -> T {
        let fan = Fan { power_w: self.power_w, ..Fan::new(CURVE) }.into_any();
        let placed = |component: &AnyComponent, first_input: usize| Placed {
            row: component.row(),
            node: 0,
            first_input: first_input as u32,
            linked: false,
        };
        let own = self.components.iter().map(|(component, first_input)| placed(component, *first_input));
        let components: Vec<_> = [placed(&fan, SPEED)].into_iter().chain(own).collect();
        let mut tables = vec![Table::behind(None, &fan, 1)];
        for (component, _) in &self.components {
            tables.push(Table::behind(tables.last(), component, 1));
        }
        let meets = |segment: u32| Passage { segment, line: 0, table: segment, component: segment, side: 0 };
        let coil = usize::from(self.power_w > 0.0);
        let passages = &[meets(0), meets(1)][..=coil];
        let segment = |element, first_input: usize| Segment {
            element,
            inertance_per_m: 20.0,
            outlet_volume_m3: 0.0,
            first_input: first_input as u32,
        };
        let segments = [segment(fan, SPEED), segment(COIL.into_any(), EXCHANGER)];
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
            responsive: &[],
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
                leaves: &[[Plan::NOWHERE; 2]],
                terms: &[[2, 1, Plan::NOWHERE], [3, 1, Plan::NOWHERE]],
                series: &[],
                composite: &[],
                between: &[[Plan::NOWHERE; 2], [0, 0]],
            },
            climate: Climate {
                reference_k: REFERENCE_K,
                air: Medium::air(REFERENCE_K),
                coolant: Medium::coolant(moist::LIQUID_HEAT_J_KG_K),
                volumes: &self.volumes,
                components: &components,
                tables: &tables,
                passages,
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
    cabin.components.push((Crew {}.into_any(), CREW));
    cabin.components.push((Remover { part: medium::CARBON_DIOXIDE as f32 }.into_any(), REMOVER));
    let wall = Wall { capacity_j_k: 5e5, inner_w_k: 50.0, outer_w_k: 5.0, start_k: 295.0 };
    cabin.components.push((wall.into_any(), WALL));
    cabin.inputs[CREW] = 4.0;
    cabin.inputs[REMOVER] = 0.012;
    cabin.inputs[SOURCE] = 700.0;
    for (method, hours) in [(Method::ImplicitEuler, 24), (Method::Adaptive, 2)] {
        cabin.run(method, 10_000, |simulator| {
            let clock = std::time::Instant::now();
            for tick in 0..360_000u64 * hours {
                // A day: sleep, then work, exercise and recovery in turn.
                let activity = if tick < 360_000 { 0.0 } else { ((tick / 90_000) % 8) as f32 };
                if tick % 90_000 == 0 {
                    simulator.set_input(CREW + 1, activity).unwrap();
                }
                simulator.step();
            }
            println!("{method:?}: {:.2} s; {:?}", clock.elapsed().as_secs_f64(), simulator.air(0));
            assert_eq!(simulator.health(), Health::Trusted);
            for ledger in simulator.ledgers() {
                println!("{ledger:?}");
                let bar = if ledger.name == "energy" { 1e-5 } else { 1e-6 };
                assert!(ledger.gap().abs() <= bar * ledger.turned_over.max(1e-3), "{ledger:?}");
            }
            if hours < 24 {
                return;
            }
            let [_, oxygen, carbon_dioxide, _, water, _, energy] = simulator.ledgers();
            assert!(oxygen.turned_over > 2.0 && carbon_dioxide.turned_over > 4.0 && water.turned_over > 6.0);
            assert!(energy.turned_over > 1e8);
            assert!(of_coil(simulator, "tank") > 1.0);
        });
    }
}

#[test]
fn a_well_mixed_volume_follows_its_exact_exponentials() {
    let mut cabin = Cabin::new(97.71, 295.35, 1_100.0);
    cabin.volumes[0].surface_kg_s_pa = 0.0;
    cabin.inputs[SPEED] = 0.0;
    // Carbon dioxide: dm/dt = S − Q·m/V.
    let (supply, flow, volume) = (7e-5f64, 0.02f64, 97.71f64);
    cabin.components.push((Remover { part: medium::CARBON_DIOXIDE as f32 }.into_any(), REMOVER));
    cabin.inputs[SOURCE + 1 + medium::CARBON_DIOXIDE] = supply as f32;
    cabin.inputs[REMOVER] = flow as f32;
    let gas = f64::from(medium::GAS_CONSTANTS_J_KG_K[medium::CARBON_DIOXIDE]);
    let start = 400.0 * volume / (gas * 295.35);
    cabin.run(Method::ImplicitEuler, 10_000, |simulator| {
        for hour in 1..=3 {
            for _ in 0..360_000 {
                simulator.step();
            }
            let time = 3_600.0 * f64::from(hour);
            let rest = supply * volume / flow;
            let exact = rest + (start - rest) * (-flow / volume * time).exp();
            let air = simulator.air(0).unwrap();
            let mass = f64::from(air.partial_pa[medium::CARBON_DIOXIDE]) * volume
                / (gas * f64::from(air.temperature_k));
            println!("after {hour} h: {mass} kg against {exact}");
            assert!((mass / exact - 1.0).abs() < 1e-4, "{mass} {exact}");
        }
    });

    // Temperature of a closed volume behind a wall that nothing moves: C·dT/dt = G·(T_w − T), C = Σ m·c_v.
    let mut cabin = Cabin::new(97.71, 295.35, 1_100.0);
    cabin.volumes[0].surface_kg_s_pa = 0.0;
    cabin.inputs[SPEED] = 0.0;
    let wall = Wall { capacity_j_k: 1e12, inner_w_k: 40.0, outer_w_k: 0.0, start_k: 303.15 };
    cabin.components.push((wall.into_any(), WALL));
    let capacity = f64::from(
        cabin.volumes[0].start_kg
            * medium::dot(&cabin.volumes[0].fractions, &Medium::air(REFERENCE_K).resting_j_kg_k),
    );
    cabin.run(Method::ImplicitEuler, 10_000, |simulator| {
        for step in 1..=4 {
            for _ in 0..50_000 {
                simulator.step();
            }
            let exact = 303.15 - 7.8 * (-40.0 / capacity * 500.0 * f64::from(step)).exp();
            let air = simulator.air(0).unwrap();
            let rise = (f64::from(air.temperature_k) - 295.35) / (exact - 295.35);
            println!("{} K against {exact}", air.temperature_k);
            assert!((rise - 1.0).abs() < 1e-4, "{rise}");
            // The volume is closed: p/T stays.
            let ratio = air.pressure_pa / PRESSURE_PA / (air.temperature_k / 295.35);
            assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
        }
    });
}

#[test]
fn the_cabin_of_the_cdra_test_goes_to_its_analytic_state_of_rest() {
    // Knox, SAE 2000-01-2345, through V-HAB: 97.71 m³ at 65 °F; 6.6 lb/d of carbon dioxide, 12 lb/d of water, 940 W of
    // dry heat, coolant at 277.594 K. Removal of carbon dioxide is idealised [assumed: 0.0115 m³/s, all of it taken].
    let pound_a_day = 0.453_592_37 / 86_400.0;
    let (carbon_dioxide, water, flow) = (6.6 * pound_a_day, 12.0 * pound_a_day, 0.0115f64);
    let mut cabin = Cabin::new(97.71, 291.483, 900.0).with_exchanger();
    cabin.components.push((Remover { part: medium::CARBON_DIOXIDE as f32 }.into_any(), REMOVER));
    cabin.inputs[SOURCE] = 940.0;
    cabin.inputs[SOURCE + 1 + medium::CARBON_DIOXIDE] = carbon_dioxide as f32;
    cabin.inputs[SOURCE + 1 + medium::VAPOUR] = water as f32;
    cabin.inputs[REMOVER] = flow as f32;
    cabin.inputs[EXCHANGER] = 1.0;
    cabin.inputs[EXCHANGER + 2] = 277.594;
    cabin.run(Method::ImplicitEuler, 50_000, |simulator| {
        for _ in 0..20 * 72_000 {
            simulator.step();
        }
        let air = simulator.air(0).unwrap();
        println!("{air:?}");
        let gas = f64::from(medium::GAS_CONSTANTS_J_KG_K[medium::CARBON_DIOXIDE]);
        let partial = carbon_dioxide * gas * f64::from(air.temperature_k) / flow;
        let shown = f64::from(air.partial_pa[medium::CARBON_DIOXIDE]);
        assert!((shown / partial - 1.0).abs() < 1e-3, "{shown} Pa against {partial}");
        let condensate = of_coil(simulator, "condensate");
        assert!((condensate / water - 1.0).abs() < 1e-3, "{condensate} against {water}");
        // Heat: dry load, fan, and what the vapour gives off on its way from the cabin's temperature to the walls'.
        let latent = f64::from(moist::evaporation_enthalpy_j_kg(air.temperature_k));
        let heat = 940.0 + 150.0 + water * latent;
        let taken = of_coil(simulator, "coolant_heat");
        assert!((taken / heat - 1.0).abs() < 1e-3, "{taken} against {heat}");
    });
}

#[test]
fn without_ventilation_the_volume_says_that_it_is_not_mixed() {
    let cabin = Cabin::new(97.71, 295.35, 1_100.0).with_exchanger();
    cabin.run(Method::ImplicitEuler, 10_000, |simulator| {
        for _ in 0..1_000 {
            simulator.step();
        }
        assert!(simulator.air(0).unwrap().mixed);
        simulator.set_input(SPEED, 0.0).unwrap();
        for _ in 0..12_000 {
            simulator.step();
        }
        let air = simulator.air(0).unwrap();
        assert!(!air.mixed && air.turnover_s > 1_800.0, "{air:?}");
    });
}
