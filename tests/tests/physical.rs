//! The implicit methods against experiments P and P0: inertance, duct volumes, a valve that closes in 1 s.

use eclss_core::{Element, Method, Network, Node, NodeKind, Segment, example};
use eclss_network_file::PlanTables;
use eclss_tests::physical::{Drain, Lumped, Ringing};
use eclss_tests::product::{closing_loop, step_until, with_simulator};
use eclss_tests::tight::{self, Equations, Family};

/// Flow at the valve [kg/s] of the table of P and of P0, at these times [s].
const TIMES_S: [f64; 10] = [10.0, 10.5, 10.9, 11.0, 11.02, 11.05, 11.1, 11.5, 12.0, 13.9];
const P: [f64; 10] = [86.4776, 86.1976, 72.8301, 10.4185, 8.7660, 3.8908, -3.3856, 4.0556, 4.0336, 4.0633];
const P0: [f64; 10] = [86.4776, 86.2075, 74.5678, 9.3893, 4.5555, 4.0854, 4.0596, 4.0594, 4.0594, 4.0594];

/// The loop with a held cabin; without storage inside for P0.
fn with_held_cabin<T>(storage: bool, body: impl FnOnce(&Network<'_>) -> T) -> T {
    let network = closing_loop();
    let nodes = [Node { kind: NodeKind::Boundary, ..network.nodes[0] }];
    let segments: Vec<Segment> = network
        .segments
        .iter()
        .map(|segment| Segment {
            outlet_volume_m3: if storage { segment.outlet_volume_m3 } else { 0.0 },
            ..*segment
        })
        .collect();
    let tables = PlanTables::new(&nodes, network.lines, &segments);
    body(&Network { nodes: &nodes, segments: &segments, plan: tables.plan(), ..network })
}

/// Flow at the valve [kg/s] after every step.
fn run(network: &Network<'_>, method: Method, step_us: u32, until_us: u64) -> Vec<f64> {
    with_simulator(network, method, step_us, |simulator| {
        let mut flows = Vec::new();
        while simulator.time_us() < until_us {
            assert_eq!(simulator.step(), eclss_core::Health::Trusted);
            flows.push(f64::from(simulator.segment_flow_at_end_kg_s(0, network.segments.len() - 1)));
        }
        flows
    })
    .expect("the loop is accepted")
}

/// Largest and root mean square difference over 10–12 s [g/s].
fn errors(flows: &[f64], reference: &[f64], step_us: u32) -> (f64, f64) {
    let first = (10_000_000 / step_us) as usize - 1;
    let differences: Vec<f64> =
        flows[first..].iter().zip(reference).map(|(flow, exact)| 1e3 * (flow - exact).abs()).collect();
    let square: f64 = differences.iter().map(|d| d * d).sum();
    (differences.iter().fold(0.0, |worst, d| d.max(worst)), (square / differences.len() as f64).sqrt())
}

fn reference(equations: &impl Equations, start: &[f64], flow: usize, step_us: u32) -> Vec<f64> {
    let count = 2_000_000 / step_us;
    let times: Vec<f64> = (0..=count).map(|k| 10.0 + f64::from(k) * f64::from(step_us) * 1e-6).collect();
    let states = tight::solve(equations, Family::Bdf, 1e-10, 0.0, start, &times).expect("integrates");
    states.iter().map(|state| state[flow]).collect()
}

#[test]
fn the_second_writing_of_the_equations_gives_the_published_table() {
    for (drain, family, bar) in [(Drain::Signed, Family::Bdf, 6e-4), (Drain::Signed, Family::Esdirk34, 6e-4)]
    {
        let ringing = tight::solve(&Ringing(drain), family, 1e-9, 0.0, &Ringing::start(), &TIMES_S).unwrap();
        let lumped = tight::solve(&Lumped, family, 1e-9, 0.0, &[1e-3], &TIMES_S).unwrap();
        for (index, time) in TIMES_S.iter().enumerate() {
            let (p, p0) = (1e3 * ringing[index][10], 1e3 * lumped[index][0]);
            assert!((p - P[index]).abs() < bar, "{family:?}, P at {time}: {p}");
            assert!((p0 - P0[index]).abs() < bar, "{family:?}, P0 at {time}: {p0}");
        }
    }
}

#[test]
fn transients_meet_their_bars() {
    let mut report = Vec::new();
    let mut missed = false;
    for (storage, name) in [(true, "P"), (false, "P0")] {
        for step_us in [1_000, 10_000] {
            let exact = if storage {
                reference(&Ringing(Drain::Signed), &Ringing::start(), 10, step_us)
            } else {
                reference(&Lumped, &[1e-3], 0, step_us)
            };
            for method in [Method::ImplicitEuler, Method::TrBdf2] {
                let flows = with_held_cabin(storage, |network| run(network, method, step_us, 12_000_000));
                let (worst, rms) = errors(&flows, &exact, step_us);
                let bar = match (method, storage, step_us) {
                    (Method::TrBdf2, true, 1_000) => 0.03,
                    (Method::TrBdf2, true, _) => 1.0,
                    (Method::TrBdf2, false, 1_000) => 0.005,
                    (Method::TrBdf2, false, _) => 0.4,
                    (_, true, 1_000) => 0.9,
                    (_, true, _) => 7.5,
                    (_, false, 1_000) => 0.25,
                    (_, false, _) => 3.5,
                };
                report.push(format!(
                    "{name:3}{:16}{:6} ms: max {worst:.4} g/s (bar {bar}), rms {rms:.5}",
                    method.name(),
                    step_us / 1000
                ));
                missed |= worst > bar;
            }
        }
    }
    let report = report.join("\n");
    println!("{report}");
    assert!(!missed, "\n{report}");
}

#[test]
fn steady_states_are_exact_at_every_step() {
    let mut report = Vec::new();
    let mut missed = false;
    for (opening, exact) in [
        (1.0f32, eclss_tests::paper::steady_flow_kg_s(1.0)),
        (0.02, eclss_tests::paper::steady_flow_kg_s(0.02)),
    ] {
        let inputs = [1.0, opening];
        for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
            for step_us in [10_000, 1_000, 100] {
                let network = Network { inputs: &inputs, ..example::paper_loop() };
                let flow = with_simulator(&network, method, step_us, |simulator| {
                    step_until(simulator, 12_000_000);
                    f64::from(simulator.line_flow_kg_s(0))
                })
                .unwrap();
                let error = flow / exact - 1.0;
                report
                    .push(format!("{:16}{opening:5} {step_us:6} us: {flow:.7} {error:+.1e}", method.name()));
                missed |= error.abs() > 1e-5;
            }
        }
    }
    let report = report.join("\n");
    println!("{report}");
    assert!(!missed, "\n{report}");
}

#[test]
fn tr_bdf2_is_of_second_order() {
    // The ringing after the valve has stopped: smooth, with every mode of the ducts awake. The reference is the
    // method itself at a step that is ten times smaller than the smallest compared.
    let at = |step_us: u32| {
        with_held_cabin(true, |network| {
            let inputs = [1.0, 0.3];
            let network = Network { schedules: &[], points: &[], inputs: &inputs, ..*network };
            run(&network, Method::TrBdf2, step_us, 600_000)
        })
    };
    let fine = at(50);
    let error = |step_us: u32| {
        let flows = at(step_us);
        let stride = (step_us / 50) as usize;
        // Compared at every 2 ms, the coarsest grid.
        let every = (2_000 / step_us) as usize;
        let mut worst = 0.0f64;
        for (index, flow) in flows.iter().enumerate() {
            if (index + 1) % every == 0 {
                worst = worst.max((flow - fine[(index + 1) * stride - 1]).abs());
            }
        }
        worst
    };
    let (two, one, half) = (error(2_000), error(1_000), error(500));
    let (first, second) = ((two / one).log2(), (one / half).log2());
    println!("errors {two:.3e} {one:.3e} {half:.3e} kg/s, orders {first:.3} {second:.3}");
    assert!(first >= 1.9 && second >= 1.9);
}

#[test]
fn removal_is_what_the_example_says() {
    assert!(
        (f64::from(example::paper_loop().segments[3].element.removal()) - eclss_tests::paper::DRAIN).abs()
            < 1e-9
    );
}
