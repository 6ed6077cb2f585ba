//! Random networks under `relaxation`: branched and meshed, lines between nodes whose pressures move, valves in
//! any position, mass taken out, flow in both directions, machines at partial speed; against the equations
//! written a second time and through the mass ledger.

use eclss_core::{Health, Method, Simulator};
use eclss_tests::dice::Dice;
use eclss_tests::model::{Model, ModelState};
use eclss_tests::product::with_simulator;
use eclss_tests::random::{Drawn, Limits};
use eclss_tests::tight::{self, Equations, Family};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Largest differences between the product and the equations: of node pressures [Pa], and of what a line loses
/// at its flow, per the larger of that loss and 100 Pa [1]. Near rest a line's flow goes with the root of its
/// pressure, which would make a rounding of a pressure look large.
fn apart(simulator: &Simulator<'_>, model: &Model, state: &ModelState) -> [f64; 2] {
    let node = |(node, exact): (usize, &f64)| (f64::from(simulator.node_gauge_pa(node)) - exact).abs();
    let line = |(line, &exact): (usize, &f64)| {
        let branch = &model.branches[line];
        let lost = |w: f64| (0..branch.parts.len()).map(|part| branch.loss(part, w)).sum::<f64>();
        (lost(f64::from(simulator.line_flow_kg_s(line))) - lost(exact)).abs() / lost(exact).abs().max(100.0)
    };
    [
        state.pressures.iter().enumerate().map(node).fold(0.0, f64::max),
        state.flows.iter().enumerate().map(line).fold(0.0, f64::max),
    ]
}

#[test]
fn every_step_is_the_one_that_the_equations_say() -> Outcome {
    let mut dice = Dice::new(11);
    let (mut reversed, mut slowed, mut moved, mut lines) = (0, 0, 0, 0);
    let (mut worst, mut settled, mut apart_steps) = (0.0f64, 0.0f64, 0);
    for network in 0..80 {
        let step_us = if network % 2 == 0 { 1_000 } else { 10_000 };
        let h = f64::from(step_us) * 1e-6;
        let limits = Limits { quadratic: network % 4 < 2, ..Limits::ventilation(h) };
        let mut drawn = Drawn::new(&mut dice, &limits);
        let (pressures, flows) = drawn.start();
        let mut state = drawn.model.start(pressures, flows.clone());
        let tables = drawn.tables.clone();
        with_simulator(&tables.network(), Method::Relaxation, step_us, |simulator| {
            for step in 0..2_000 {
                if step % 500 == 499 {
                    // Somebody turns every valve and every machine.
                    for slot in 0..drawn.tables.inputs.len() {
                        let value = dice.between(0.1, 1.0) as f32;
                        drawn.tables.inputs[slot] = value;
                        assert_eq!(simulator.set_input(slot, value), Ok(()));
                    }
                    drawn.refresh();
                }
                assert_eq!(simulator.step(), Health::Trusted, "{network}");
                drawn.model.step(&mut state, h);
                let [node, line] = apart(simulator, &drawn.model, &state);
                worst = worst.max(node);
                apart_steps += usize::from(line > 1e-5);
                if step % 500 == 498 {
                    settled = settled.max(line);
                }
            }
            lines += flows.len();
            reversed += flows.iter().zip(&state.flows).filter(|(start, end)| *start * *end < 0.0).count();
            slowed += usize::from(simulator.worst_margin().phi < 0.9);
            moved += usize::from(state.pressures.iter().any(|p| p.abs() > 1.0));
        })?;
    }
    println!(
        "80 networks, {lines} lines, 2000 steps each: nodes at most {worst:.1e} Pa apart, losses {settled:.1e} before \
         the inputs move, above 1e-5 in {apart_steps} steps; {reversed} lines turned, {slowed} networks slowed by \
         φ, {moved} with pressures that moved"
    );
    assert!(worst < 1e-3, "{worst:e}");
    assert!(settled < 1e-5, "{settled:e}");
    // A stiff flow that starts near zero under a large pressure lands where the rounding of that zero says, and
    // is called back by the next steps.
    assert!(apart_steps < 100, "{apart_steps}");
    assert!(reversed > 40 && slowed > 40 && moved > 40);
    Ok(())
}

#[test]
fn a_smaller_step_goes_to_the_tight_solution_in_first_order() -> Outcome {
    let mut dice = Dice::new(12);
    let mut ratios = vec![];
    for network in 0..12 {
        // Soft enough for φ = 1 at every step, so that the limit is the equations without operator.
        let limits = Limits {
            resistance: (1.0, 2.5),
            dominance: (0.0, 0.3),
            start_flow: (-1.5, -1.0),
            ..Limits::ventilation(1e-2)
        };
        let drawn = Drawn::new(&mut dice, &limits);
        let (pressures, flows) = drawn.start();
        let model = &drawn.model;
        let mut start = vec![0.0; model.order()];
        start[..pressures.len()].copy_from_slice(&pressures);
        for (line, flow) in flows.iter().enumerate() {
            start[model.first_of_line(line) + model.branches[line].flow_part] = *flow;
        }
        let times: Vec<f64> = (1..=20).map(|k| 0.25 * f64::from(k)).collect();
        let exact = tight::solve(model, Family::Esdirk34, 1e-9, 0.0, &start, &times)?;
        let mut errors = vec![];
        for step_us in [500u32, 250, 125] {
            let error = with_simulator(&drawn.tables.network(), Method::Relaxation, step_us, |simulator| {
                let mut largest = 0.0f64;
                for x in &exact {
                    for _ in 0..250_000 / step_us {
                        simulator.step();
                    }
                    for (line, branch) in model.branches.iter().enumerate() {
                        let tight = x[model.first_of_line(line) + branch.flow_part];
                        largest = largest.max((f64::from(simulator.line_flow_kg_s(line)) - tight).abs());
                    }
                }
                (largest, simulator.worst_margin().phi)
            })?;
            errors.push(error);
        }
        println!("{network}: {errors:?}");
        if errors.iter().all(|(_, phi)| *phi >= 1.0) {
            ratios.push(errors[0].0 / errors[1].0);
            ratios.push(errors[1].0 / errors[2].0);
        }
    }
    println!("halving the step divides the error by {ratios:.2?}");
    assert!(ratios.len() > 10, "{}", ratios.len());
    assert!(ratios.iter().all(|ratio| (1.7..2.4).contains(ratio)), "{ratios:?}");
    Ok(())
}

#[test]
fn no_mass_is_made_or_lost() -> Outcome {
    let mut dice = Dice::new(13);
    let (mut worst, mut drained_total) = (0.0f64, 0.0);
    for network in 0..40 {
        let step_us = if network % 2 == 0 { 1_000 } else { 10_000 };
        let limits = Limits::ventilation(f64::from(step_us) * 1e-6);
        let drawn = Drawn::new(&mut dice, &limits);
        with_simulator(&drawn.tables.network(), Method::Relaxation, step_us, |simulator| {
            for _ in 0..20_000 {
                assert_eq!(simulator.step(), Health::Trusted);
            }
            let nodes = drawn.tables.nodes.len();
            let (mut balance, mut turnover) = (vec![0.0; nodes], vec![0.0f64; nodes]);
            let (mut drained_here, mut all) = (0.0, 0.0f64);
            for (line, description) in drawn.tables.lines.iter().enumerate() {
                let [taken, given, drained] = simulator.line_sums_kg(line);
                let (from, to) = (description.from as usize, description.to as usize);
                balance[from] -= taken;
                balance[to] += given;
                turnover[from] += taken.abs();
                turnover[to] += given.abs();
                drained_here += drained;
                all += taken.abs() + given.abs();
                // What a line takes it gives or drains.
                let size = taken.abs().max(given.abs()).max(1e-6);
                worst = worst.max((taken - given - drained).abs() / size);
                assert!(drained >= 0.0);
            }
            let stored: f64 = (0..nodes).map(|node| simulator.node_mass_kg(node)).sum();
            for node in 0..nodes {
                let off = (simulator.node_mass_kg(node) - balance[node]).abs();
                worst = worst.max(off / turnover[node].max(1e-6));
                // And the pressure is that of the mass.
                let gauge = f64::from(drawn.tables.nodes[node].start_gauge_pa)
                    + drawn.model.pressure_per_mass[node] * simulator.node_mass_kg(node);
                let shown = f64::from(simulator.node_gauge_pa(node));
                assert!((shown - gauge).abs() <= 1e-6 * gauge.abs().max(200.0), "{shown} against {gauge}");
            }
            worst = worst.max((stored + drained_here).abs() / all.max(1e-6));
            drained_total += drained_here;
        })?;
    }
    println!(
        "40 networks, 20 000 steps: ledger closes to {worst:.1e} of the turnover, {drained_total:.2} kg drained"
    );
    assert!(worst < 3e-8, "{worst:e}");
    assert!(drained_total > 1.0);
    Ok(())
}

#[test]
fn a_rested_network_balances_every_line_and_node() -> Outcome {
    let mut dice = Dice::new(14);
    let (mut rested, mut worst) = (0, 0.0f64);
    let limits = Limits { volume_range: 1.0, dominance: (0.0, 1.0), held: true, ..Limits::ventilation(1e-2) };
    for network in 0..30 {
        let drawn = Drawn::new(&mut dice, &limits);
        with_simulator(&drawn.tables.network(), Method::Relaxation, 10_000, |simulator| {
            for _ in 0..100_000 {
                simulator.step();
            }
            let lines = drawn.tables.lines.len();
            let flows = |s: &Simulator<'_>| -> Vec<f64> {
                (0..lines).map(|line| f64::from(s.line_flow_kg_s(line))).collect()
            };
            let pressures: Vec<f64> =
                (0..drawn.tables.nodes.len()).map(|n| f64::from(simulator.node_gauge_pa(n))).collect();
            let now = flows(simulator);
            // A network that is still emptying or ringing says nothing about rest.
            for _ in 0..100 {
                simulator.step();
            }
            let largest = now.iter().fold(0.0f64, |a, w| a.max(w.abs()));
            let still =
                now.iter().zip(flows(simulator)).all(|(a, b)| (a - b).abs() < 1e-5 * largest.max(0.01));
            if still {
                rested += 1;
                let scale = drawn
                    .model
                    .branches
                    .iter()
                    .flat_map(|branch| branch.parts.iter().map(|part| part.head.abs()))
                    .fold(1.0, f64::max);
                let imbalance = drawn.model.imbalance_pa(&pressures, &now);
                worst = worst.max(imbalance / scale);
                assert!(imbalance < 2e-5 * scale, "{network}: {imbalance}");
            }
        })?;
    }
    println!("{rested} of 30 networks came to rest, unbalanced by at most {worst:.1e} of the largest head");
    assert!(rested >= 10);
    Ok(())
}
