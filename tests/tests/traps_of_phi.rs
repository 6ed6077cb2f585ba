//! Traps in the rule for φ: each test shows the wrong rule failing and the product's holding.

use eclss_core::{BuildError, Health, Margin, Method, MethodError, Proof};
use eclss_tests::model::Branch;
use eclss_tests::spectrum::{line_jacobian, paper_radius, phi, step_radius};
use eclss_tests::tight::Equations;
use eclss_tests::{laws, paper, product, reference};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Runs the paper's loop with the closing valve to `until_s` [s] by explicit steps of `h` [s]; `scale` turns
/// the rows' slopes over the flow (element resistances times 2|w|) into the φ of every row. Returns the flow
/// [kg/s] after every step.
fn closing(h: f64, until_s: f64, scale: impl Fn([f64; 6]) -> [f64; 6]) -> Vec<f64> {
    let (mut x, mut rates) = (paper::relaxation_start(), [0.0; 6]);
    let steps = (until_s / h).round() as u32;
    (0..steps)
        .map(|step| {
            let t_s = f64::from(step) * h;
            paper::Relaxation.rates(t_s, &x, &mut rates);
            let [r1, r2, r3, r4, r5] = paper::felt_resistances();
            let valve = paper::valve_resistance(paper::opening(t_s));
            let phis = scale([r1, r2, r3, r4, r5, valve].map(|r| 2.0 * r * x[5].abs()));
            for ((state, rate), phi) in x.iter_mut().zip(&rates).zip(phis) {
                *state += h * phi * rate;
            }
            x[5]
        })
        .collect()
}

/// Smallest and largest of the last ten flows [g/s].
fn late_g_s(flows: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let flows: Vec<f64> = flows.into_iter().collect();
    let late = flows[flows.len() - 10..].iter().map(|w| w * 1e3);
    late.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), w| (low.min(w), high.max(w)))
}

#[test]
fn with_a_factor_of_two_the_step_sits_on_the_edge_of_the_disc_and_never_settles() -> Outcome {
    for (step_us, low_g_s, high_g_s) in [(1_000, 3.95, 4.20), (10_000, 3.0, 5.86)] {
        let h = f64::from(step_us) * 1e-6;
        let doubled = closing(h, 26.0, |slopes| [1.0, 1.0, 1.0, 1.0, 1.0, (2.0 / (h * slopes[5])).min(1.0)]);
        let (low, high) = late_g_s(doubled);
        let flows = product::closing_flows(Method::Relaxation, step_us, 26_000_000)?;
        let (our_low, our_high) = late_g_s(flows.into_iter().map(|(_, w)| w));
        println!("{step_us} µs: factor 2 {low:.3} … {high:.3} g/s, ours {our_low:.5} … {our_high:.5} g/s");
        assert!(low < low_g_s && high > high_g_s, "{low} … {high}");
        assert!((our_low - 4.0593).abs() < 3e-4 && our_high - our_low < 5e-5, "{our_low} … {our_high}");
    }
    Ok(())
}

#[test]
fn full_row_sums_mix_units_and_throttle_rows_for_nothing() -> Outcome {
    let exact = reference::compute()?;
    let h = 1e-2;
    let worst_g_s = |flows: &[f64]| {
        // Step 1000 ends at 10 s, where the reference begins with a row every millisecond.
        let error = |k: usize| (flows[999 + k] - exact[10 * k].1).abs() * 1e3;
        (0..=200).map(error).fold(0.0, f64::max)
    };
    let throttled = closing(h, 12.0, |slopes| {
        let mut row = 0;
        slopes.map(|slope| {
            row += 1;
            let sum = slope + if row == 1 || row == 6 { 1.0 } else { 2.0 };
            (1.0 / (h * sum)).min(1.0)
        })
    });
    let ours: Vec<f64> = product::closing_flows(Method::Relaxation, 10_000, 12_000_000)?
        .into_iter()
        .map(|(_, flow)| flow)
        .collect();
    let (wrong, right) = (worst_g_s(&throttled), worst_g_s(&ours));
    println!("10 ms, 10–12 s: full row sums {wrong:.2} g/s from the tight solution, ours {right:.2} g/s");
    assert!((29.0..30.5).contains(&wrong), "{wrong}");
    assert!(right < 1.7, "{right}");
    Ok(())
}

/// Spectral radius of a step of `h` [s] where the line rests.
fn resting_radius(branch: &Branch, h: f64) -> f64 {
    let (rows, own) = branch.slopes(branch.steady_flow_kg_s(0.0));
    step_radius(line_jacobian(&rows, own, 1.0, phi(h, own)), h)
}

/// The end of a run.
struct Run {
    health: Health,
    margin: Margin,
    /// Flows of the last seconds [kg/s].
    flows: Vec<f64>,
}

/// Runs the product for 60 s at 10 ms.
fn run(tables: &product::Tables) -> Result<Run, BuildError> {
    product::with_simulator(&tables.network(), Method::Relaxation, 10_000, |simulator| {
        product::step_until(simulator, 50_000_000);
        let mut flows = vec![f64::from(simulator.line_flow_kg_s(0))];
        while simulator.time_us() < 60_000_000 && simulator.step() == Health::Trusted {
            flows.push(f64::from(simulator.line_flow_kg_s(0)));
        }
        Run { health: simulator.health(), margin: simulator.margin(), flows }
    })
}

/// Largest relative distance of `flows` from `exact`.
fn largest_error(flows: &[f64], exact: f64) -> f64 {
    flows.iter().map(|w| (w / exact - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn the_flow_state_belongs_on_the_stiffest_element() -> Outcome {
    for valve in 0..5 {
        // On the valve: inside the disc at every opening.
        let segments = product::reordered_loop(product::valve_at(valve), valve, 1.0).segments;
        let worst = (0..=98)
            .map(|k| resting_radius(&laws::branch(&segments, valve, 0.02 + 0.01 * f64::from(k)), 1e-2))
            .fold(0.0, f64::max);
        assert!(worst <= 0.9943, "valve {valve}: {worst}");
        for opening in [1.0, 0.2, 0.02] {
            let exact = laws::branch(&segments, valve, f64::from(opening)).steady_flow_kg_s(0.0);
            let run = run(&product::reordered_loop(product::valve_at(valve), valve, opening))?;
            assert_eq!(run.health, Health::Trusted);
            let off = largest_error(&run.flows, exact);
            assert!(off < 1e-5, "valve {valve}, {opening}: {off}");
        }

        // On the last pipe while the valve is nearly closed: outside, reported so, and the run does not settle.
        let line = laws::branch(&segments, 5, 0.02);
        let radius = resting_radius(&line, 1e-2);
        let Run { health, margin, flows } = run(&product::reordered_loop(product::valve_at(valve), 5, 0.02))?;
        let off = largest_error(&flows, line.steady_flow_kg_s(0.0));
        println!(
            "10 ms, valve {valve} of 5, 2 %: flow on the valve at most {worst:.4}, on the last pipe {radius:.4}; \
             {margin:?}, {health:?}, off by {off:.1e}"
        );
        assert!(radius > 1.02, "{radius}");
        assert!(f64::from(margin.spectral_bound) >= radius && margin.proof != Proof::Dominant);
        assert!(off > 0.1, "{off}");
        if valve == 4 {
            assert!((radius - 3.92).abs() < 0.01, "{radius}");
        }
    }
    Ok(())
}

#[test]
fn a_short_step_does_not_make_up_for_a_soft_flow_element() -> Outcome {
    // Fan and heat exchanger right ahead of the open valve: 2·h·R·|w| of the valve is 0.15, yet it swings.
    let order = [2, 4, 0, 1, 3, 5];
    let tables = product::reordered_loop(order, 5, 1.0);
    let line = laws::branch(&tables.segments, 5, 1.0);
    let exact = line.steady_flow_kg_s(0.0);
    let radius = resting_radius(&line, 1e-2);
    let Run { margin, flows, .. } = run(&tables)?;
    let off = largest_error(&flows, exact);
    println!("10 ms, flow on the open valve: radius {radius:.4}, {margin:?}, off by {off:.1e}");
    assert!(line.slopes(exact).1 * 1e-2 < 0.5);
    assert!((radius - 1.0626).abs() < 1e-3, "{radius}");
    assert!(off > 0.1, "{off}");
    assert!(f64::from(margin.spectral_bound) >= radius && margin.proof != Proof::Dominant, "{margin:?}");

    // On the heat exchanger, the stiffest while the valve is open, with the valve folded into its row.
    let line = laws::branch(&tables.segments, 4, 1.0);
    let radius = resting_radius(&line, 1e-2);
    let Run { health, flows, .. } = run(&product::reordered_loop(order, 4, 1.0))?;
    let off = largest_error(&flows, line.steady_flow_kg_s(0.0));
    println!("10 ms, flow on the heat exchanger: radius {radius:.4}, {health:?}, off by {off:.1e}");
    assert!(radius < 1.0 && off < 1e-5, "{radius}, {off}");
    Ok(())
}

#[test]
fn a_long_step_is_refused_because_phi_does_not_cover_it() {
    let worst = (0..=98).map(|k| paper_radius(0.02 + 0.01 * f64::from(k), 0.1, true)).fold(0.0, f64::max);
    println!("100 ms: largest spectral radius with the operator {worst:.2}");
    assert!((worst - 2.33).abs() < 0.01, "{worst}");
    for step_us in [10_001, 20_000, 100_000] {
        let refused = product::with_simulator(&product::closing_loop(), Method::Relaxation, step_us, |_| ());
        let longest = MethodError::Step { longest_us: 10_000 };
        assert_eq!(refused, Err(BuildError::Method(longest)));
    }
    let taken = product::with_simulator(&product::closing_loop(), Method::Relaxation, 10_000, |_| ());
    assert_eq!(taken, Ok(()));
}
