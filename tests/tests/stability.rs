//! Eigenvalues of one step of the paper's loop, without and with the operator, and the margin that the
//! product reports while it runs.

use eclss_core::components::Pipe;
use eclss_core::operator::FlowRow;
use eclss_core::{Health, Method, Network, Proof, example};
use eclss_tests::dice::Dice;
use eclss_tests::random::{Drawn, Limits};
use eclss_tests::spectrum::{line_jacobian, paper_edge, paper_radius, step_radius};
use eclss_tests::{paper, product, spectrum};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Openings from 2 to 100 %.
fn openings() -> impl Iterator<Item = f64> {
    (0..=980).map(|k| 0.02 + 1e-3 * f64::from(k))
}

#[test]
fn without_the_operator_small_openings_leave_the_disc() {
    for (h, edge, tolerance) in [(1e-3, 0.198, 0.003), (1e-2, 0.43, 0.005)] {
        let found = paper_edge(h);
        println!("h = {h}: plain step unstable below {:.2} % opening", 100.0 * found);
        assert!((found - edge).abs() <= tolerance, "{found}");
        for opening in openings() {
            let inside = paper_radius(opening, h, false) <= 1.0;
            assert_eq!(inside, opening > found, "opening {opening}, h = {h}");
        }
    }
}

#[test]
fn with_the_operator_no_opening_leaves_the_disc() {
    for (h, largest) in [(1e-3, 0.999_42), (1e-2, 0.994_24)] {
        let worst = openings().map(|opening| paper_radius(opening, h, true)).fold(0.0, f64::max);
        println!("h = {h}: largest spectral radius with the operator {worst:.5}");
        assert!(worst < 1.0);
        assert!((worst - largest).abs() < 2e-5, "{worst}");
    }
}

#[test]
fn the_running_step_reports_what_the_equations_say() -> Outcome {
    for step_us in [1_000, 10_000] {
        let h = f64::from(step_us) * 1e-6;
        for opening in [1.0, 0.5, 0.2, 0.1, 0.05, 0.02] {
            let inputs = product::held_at(opening as f32);
            let network = Network { inputs: &inputs, ..example::paper_loop() };
            let margin = product::with_simulator(&network, Method::Relaxation, step_us, |simulator| {
                product::step_until(simulator, 60_000_000);
                simulator.margin()
            })?;
            let diagonal = 2.0 * paper::valve_resistance(opening) * paper::steady_flow_kg_s(opening);
            let phi = spectrum::phi(h, diagonal);
            assert!((f64::from(margin.phi) / phi - 1.0).abs() < 1e-5, "{opening}: {margin:?}, {phi}");
            let radius = paper_radius(opening, h, true);
            let bound = f64::from(margin.spectral_bound);
            println!("h = {h}, C = {opening}: radius {radius:.5}, bound {bound:.5}, {:?}", margin.proof);
            assert!(radius <= bound + 1e-6);
            // The paper's valve outweighs the rest of the loop below about 14 % opening.
            let dominant = paper::valve_resistance(opening) >= paper::felt_resistances().iter().sum();
            assert_eq!(margin.proof == Proof::Dominant, dominant);
            assert_eq!(bound < 1.0, dominant, "a proof is a bound below 1");
        }
    }
    Ok(())
}

/// A line drawn at random: h·J of it and what the operator is told.
struct AnyLine {
    row: FlowRow,
    h: f64,
    /// Slopes of the rows [Pa·s/kg].
    rows: Vec<f64>,
    /// Slope of the flow row [Pa·s/kg].
    own: f64,
}

fn any_line(dice: &mut Dice) -> AnyLine {
    let h = dice.power_of_ten(-4.0, -2.0);
    let flow = dice.power_of_ten(-5.0, 0.0);
    // Laminar: the slope of w·max(|w|, limit) is the limit.
    let slope = if dice.chance(0.3) { flow * dice.power_of_ten(0.0, 3.0) } else { 2.0 * flow };
    let linear_rows = dice.chance(0.4);
    let own_linear = if dice.chance(0.4) { dice.power_of_ten(-1.0, 5.0) } else { 0.0 };
    let own = dice.power_of_ten(0.0, 8.0);
    let count = dice.whole(0, 12);
    let (mut rows, mut others) = (vec![], 0.0);
    for _ in 0..count {
        let resistance = dice.power_of_ten(0.0, 6.0);
        let linear = if linear_rows { dice.power_of_ten(-2.0, 4.0) } else { 0.0 };
        rows.push(resistance * slope + linear);
        // A row's linear loss is carried as the quadratic one that loses as much at this flow.
        others += resistance + linear / flow;
    }
    let row = FlowRow {
        step: h as f32,
        slope: slope as f32,
        own: own as f32,
        own_linear: own_linear as f32,
        others: others as f32,
        rows: count as f32,
    };
    AnyLine { row, h, rows, own: own * slope + own_linear }
}

#[test]
fn the_live_bound_bounds_the_radius_of_any_line() {
    let mut dice = Dice::new(1);
    let (mut proven, mut closest, mut short, mut short_outside) = (0, f64::INFINITY, 0, 0);
    let (mut plain, mut weak) = (0, 0);
    for trial in 0..20_000 {
        let AnyLine { row, h, rows, own } = any_line(&mut dice);
        let stabilised = dice.chance(0.7);
        let phi = if stabilised { eclss_core::operator::phi(row.stiffness()) } else { 1.0 };
        let margin = row.margin(phi);
        let radius = step_radius(line_jacobian(&rows, own, 1.0, f64::from(phi)), h);
        let bound = f64::from(margin.spectral_bound);
        assert!(radius <= bound + 2e-6 * bound.max(1.0), "{trial}: {radius} above: {row:?}, {margin:?}");
        plain += usize::from(!stabilised);
        weak += usize::from(row.own < row.others);
        match margin.proof {
            Proof::Dominant => {
                proven += 1;
                closest = closest.min(bound - radius);
                assert!(bound <= 1.0 && radius <= 1.0 + 1e-12, "{trial}: {radius}, {row:?}, {margin:?}");
            }
            Proof::ShortStep => {
                short += 1;
                short_outside += usize::from(radius > 1.0 + 1e-9);
            }
            Proof::None | Proof::ByConstruction => {}
        }
    }
    println!(
        "20000 lines, {plain} without φ, {weak} with A < B: {proven} proven, bound at best {closest:.1e} above \
         the radius; {short} by the short step, {short_outside} of them outside the disc"
    );
    assert!(proven > 5_000 && plain > 5_000 && weak > 3_000);
}

#[test]
fn the_margin_of_a_running_network_bounds_every_line() -> Outcome {
    let mut dice = Dice::new(5);
    let (mut compared, mut outside) = (0, 0);
    for network in 0..60 {
        let step_us = if network % 2 == 0 { 1_000 } else { 10_000 };
        let h = f64::from(step_us) * 1e-6;
        // Flow rows from a thousandth of the others to ten times as much, laminar limits or linear losses.
        let limits = Limits { dominance: (-3.0, 1.0), quadratic: network % 4 < 2, ..Limits::ventilation(h) };
        let drawn = Drawn::new(&mut dice, &limits);
        let method = if network % 3 == 0 { Method::Euler } else { Method::Relaxation };
        product::with_simulator(&drawn.tables.network(), method, step_us, |simulator| {
            for _ in 0..50 {
                let flows: Vec<f64> = (0..drawn.tables.lines.len())
                    .map(|line| f64::from(simulator.line_flow_kg_s(line)))
                    .collect();
                let health = simulator.step();
                let margin = simulator.margin();
                let bound = f64::from(margin.spectral_bound);
                let mut smallest = 1.0f64;
                for (branch, &w) in drawn.model.branches.iter().zip(&flows) {
                    let (rows, own) = branch.slopes(w);
                    let phi = if method == Method::Euler { 1.0 } else { spectrum::phi(h, own) };
                    let radius = step_radius(line_jacobian(&rows, own, 1.0, phi), h);
                    smallest = smallest.min(phi);
                    compared += 1;
                    outside += usize::from(radius > 1.0);
                    assert!(
                        radius <= bound + 1e-5 * bound.max(1.0),
                        "{network}: {radius}, {margin:?}, w = {w}"
                    );
                }
                assert!((f64::from(margin.phi) / smallest - 1.0).abs() < 1e-4, "{margin:?}, {smallest}");
                if health != Health::Trusted {
                    break;
                }
            }
        })?;
    }
    println!("{compared} lines compared, {outside} of them outside the disc and reported so");
    assert!(compared > 10_000 && outside > 100);
    Ok(())
}

#[test]
fn the_live_bound_holds_in_the_laminar_range() -> Outcome {
    // Below `laminar_below_pa` the slope of the loss is half of what 2·R·|w| says at the limit.
    let mut tables = product::Tables::default();
    let ends = (tables.node(None, 1e-4), tables.node(None, 0.0));
    let pipe = |resistance_pa_s2_kg2| Pipe::new(resistance_pa_s2_kg2).into_any();
    tables.line(ends, &[pipe(1e-3), pipe(5.0)], 1, 0.01, 0.0);
    let (flow, margin) =
        product::with_simulator(&tables.network(), Method::Relaxation, 1_000, |simulator| {
            product::step_until(simulator, 100_000_000);
            (f64::from(simulator.line_flow_kg_s(0)), simulator.margin())
        })?;
    let laminar = (0.01f64 / 5.001).sqrt();
    assert!(0.0 < flow && flow < 0.1 * laminar, "{flow}");
    let radius = step_radius(line_jacobian(&[1e-3], 5.0, laminar, f64::from(margin.phi)), 1e-3);
    assert!(radius <= f64::from(margin.spectral_bound) + 1e-7, "{radius} above {margin:?}");
    Ok(())
}
