//! Traps in how a line's rows are written: each test shows the wrong way failing and the product's holding.

use eclss_core::{BuildError, Health, Method, MethodError, example};
use eclss_tests::model::{Branch, Model};
use eclss_tests::product::{self, Tables};
use eclss_tests::spectrum::{line_jacobian, phi, step_radius};
use eclss_tests::{laws, paper};
use nalgebra::DMatrix;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Resistances of the paper's line without its valve, as the flow behind the drain meets them, and heads.
fn rows() -> [(f64, f64); 5] {
    let [r1, r2, r3, r4, r5] = paper::felt_resistances();
    [(r1, 0.0), (r2, paper::FAN_HEAD_PA), (r3, 0.0), (r4, 0.0), (r5, 0.0)]
}

/// Jacobian of the paper's line with its valve before element `valve` and rows of their own for what lies
/// behind: inlet pressures `p_i' = p_{i+1} − p_i + R_i·w|w|`, `w' = φ·(p_up − p_down − Rv·w|w|)`.
fn jacobian_with_rows_behind(valve: usize, slopes: [f64; 5], own: f64, phi: f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(6, 6);
    for (row, slope) in slopes.into_iter().enumerate() {
        matrix[(row, row)] = -1.0;
        let behind = row >= valve;
        matrix[(row, 5)] = if behind { slope } else { -slope };
        let neighbour = if behind { (row < 4).then_some(row + 1) } else { row.checked_sub(1) };
        if let Some(neighbour) = neighbour {
            matrix[(row, neighbour)] = 1.0;
        }
    }
    if valve > 0 {
        matrix[(5, valve - 1)] = phi;
    }
    if valve < 5 {
        matrix[(5, valve)] = -phi;
    }
    matrix[(5, 5)] = -phi * own;
    matrix
}

/// Runs that system at `opening` for 60 s in steps of `h` [s]; returns the last hundred flows [kg/s], or
/// infinity where it diverges.
fn flows_with_rows_behind(valve: usize, opening: f64, h: f64) -> Vec<f64> {
    let (mut p, mut w) = ([0.0; 5], paper::START_FLOW_KG_S);
    let own = paper::valve_resistance(opening);
    let steps = (60.0 / h).round() as usize;
    let mut flows = vec![];
    for _ in 0..steps {
        let (old, square) = (p, w * f64::abs(w));
        for (row, (resistance, head)) in rows().into_iter().enumerate() {
            let loss = resistance * square - head;
            p[row] += h * if row < valve {
                row.checked_sub(1).map_or(0.0, |before| old[before]) - old[row] - loss
            } else {
                old.get(row + 1).copied().unwrap_or(0.0) - old[row] + loss
            };
        }
        let driving =
            valve.checked_sub(1).map_or(0.0, |row| old[row]) - old.get(valve).copied().unwrap_or(0.0);
        w += h * phi(h, 2.0 * own * w) * (driving - own * square);
        flows.push(w);
        if w.is_nan() || w.abs() > 1e3 {
            return vec![f64::INFINITY];
        }
    }
    flows.split_off(steps - 100)
}

#[test]
fn what_lies_behind_the_valve_belongs_into_its_row() -> Outcome {
    let h = 1e-2;
    let (mut worst, mut worst_folded) = ((0.0, 0, 0.0), 0.0f64);
    for valve in 0..=5 {
        for opening in (0..=490).map(|k| 0.02 + 2e-3 * f64::from(k)) {
            let slope = 2.0 * paper::steady_flow_kg_s(opening);
            let slopes = rows().map(|(resistance, _)| resistance * slope);
            let own = paper::valve_resistance(opening) * slope;
            // Only where the guard of the method is content.
            let guarded = own >= slopes.iter().sum() || h * own < 0.5;
            let separate = step_radius(jacobian_with_rows_behind(valve, slopes, own, phi(h, own)), h);
            if guarded && separate > worst.0 {
                worst = (separate, valve, opening);
            }
            let folded = own + slopes[valve..].iter().sum::<f64>();
            let radius = step_radius(line_jacobian(&slopes[..valve], folded, 1.0, phi(h, folded)), h);
            worst_folded = worst_folded.max(radius);
        }
    }
    let (radius, valve, opening) = worst;
    println!(
        "10 ms: rows behind the valve {radius:.3} (valve {valve}, C = {opening:.2}), folded {worst_folded:.4}"
    );
    assert!((radius - 1.10).abs() < 0.01, "{radius}");
    assert!(worst_folded <= 0.9943, "{worst_folded}");

    // And the runs do what the eigenvalues say: the one keeps swinging, the product settles.
    let exact = paper::steady_flow_kg_s(opening);
    let off = |flows: &[f64]| flows.iter().map(|w| (w / exact - 1.0).abs()).fold(0.0, f64::max);
    let swinging = off(&flows_with_rows_behind(valve, opening, h));
    let tables = product::reordered_loop(product::valve_at(valve), valve, opening as f32);
    let settled = product::with_simulator(&tables.network(), Method::Relaxation, 10_000, |simulator| {
        product::step_until(simulator, 60_000_000);
        f64::from(simulator.line_flow_kg_s(0))
    })?;
    println!(
        "10 ms, valve {valve}, C = {opening:.2}: rows behind {swinging:.1e} off, ours {:.1e}",
        off(&[settled])
    );
    assert!(swinging > 0.01, "{swinging}");
    // Ahead of the drain the same valve carries a little more flow: compare with the law there.
    let exact_here = laws::branch(&tables.segments, valve, opening).steady_flow_kg_s(0.0);
    assert!((settled / exact_here - 1.0).abs() < 1e-5, "{settled} against {exact_here}");
    Ok(())
}

#[test]
fn row_pressures_count_from_the_lines_own_inlet() -> Outcome {
    // The drain empties the cabin at 0.55 Pa/s. Rows that hold absolute pressures lag behind it by their own
    // second each, and the flow sees five seconds of drift.
    let (h, exact) = (1e-3, paper::steady_flow_kg_s(1.0));
    let per_mass = 287.05 * 295.15 / 60.0;
    let (mut cabin, mut p, mut w) = (0.0, [0.0; 5], paper::START_FLOW_KG_S);
    let mut drift_pa_s = 0.0;
    for _ in 0..60_000 {
        let (old, square) = (p, w * f64::abs(w));
        let mut before = cabin;
        for ((p, old), (resistance, head)) in p.iter_mut().zip(old).zip(rows()) {
            *p += h * (before - old + head - resistance * square);
            before = old;
        }
        let own = paper::valve_resistance(1.0);
        w += h * phi(h, 2.0 * own * w) * (before - cabin - own * square);
        drift_pa_s = per_mass * paper::DRAIN * w;
        cabin -= h * drift_pa_s;
    }
    let absolute = w / exact - 1.0;
    let (ours, gauge) =
        product::with_simulator(&example::paper_loop(), Method::Relaxation, 1_000, |simulator| {
            product::step_until(simulator, 60_000_000);
            (f64::from(simulator.line_flow_kg_s(0)) / exact - 1.0, f64::from(simulator.node_gauge_pa(0)))
        })?;
    println!(
        "cabin falling by {drift_pa_s:.3} Pa/s: absolute rows {:+.3} %, ours {ours:+.1e}; cabin at {gauge:.2} Pa \
         (absolute {cabin:.2} Pa)",
        100.0 * absolute
    );
    assert!((drift_pa_s - 0.55).abs() < 0.01, "{drift_pa_s}");
    assert!((absolute - 0.0046).abs() < 1e-4, "{absolute}");
    assert!(ours.abs() < 1e-5, "{ours}");
    // The cabin itself falls as far as the drained mass says, 60 s · 0.55 Pa/s less the first seconds.
    assert!((gauge / cabin - 1.0).abs() < 0.01, "{gauge} against {cabin}");
    Ok(())
}

/// Two supplies at ±50 Pa with a chamber of `volume_m3` between them, each line a short pipe and a valve.
fn chamber(volume_m3: f32) -> (Tables, Model) {
    let pipe = |resistance_pa_s2_kg2| eclss_core::components::Pipe::new(resistance_pa_s2_kg2).into_any();
    let elements = [pipe(5.0), pipe(50.0)];
    let mut tables = Tables::default();
    let (high, low) = (tables.node(None, 50.0), tables.node(None, -50.0));
    let middle = tables.node(Some(volume_m3), 5.0);
    for ends in [(high, middle), (middle, low)] {
        tables.line(ends, &elements, 1, 0.0, 1e-3);
    }
    let parts: Vec<_> = elements.iter().map(|element| laws::part(element, 1.0)).collect();
    let branch = |from, to| Branch { from, to, parts: parts.clone(), flow_part: 1, laminar_below_pa: 0.0 };
    let pressure_per_mass = vec![0.0, 0.0, 287.05 * 295.15 / f64::from(volume_m3)];
    (tables, Model { pressure_per_mass, branches: vec![branch(0, 2), branch(2, 1)] })
}

#[test]
fn a_node_too_small_for_the_step_is_refused_because_it_diverges() -> Outcome {
    // h²·Σc = 1 for 2 lines at 10 ms.
    let edge = 2.0 * 1e-4 * 287.05 * 295.15;
    for (volume, diverges) in [(0.5, true), (0.1 * edge, true), (1.001 * edge, false), (10.0 * edge, false)] {
        let (tables, model) = chamber(volume as f32);
        let built = product::with_simulator(&tables.network(), Method::Relaxation, 10_000, |simulator| {
            product::step_until(simulator, 200_000_000);
            [0, 1].map(|line| f64::from(simulator.line_flow_kg_s(line)))
        });
        // Stepped anyway, in double precision.
        let mut state = model.start(vec![50.0, -50.0, 5.0], vec![1e-3; 2]);
        let exact = model.branches[0].steady_flow_kg_s(50.0);
        let mut largest = 0.0f64;
        for step in 0..20_000 {
            model.step(&mut state, 1e-2);
            if step >= 10_000 {
                let off = (state.flows[0] / exact - 1.0).abs();
                largest = if off.is_nan() { f64::INFINITY } else { largest.max(off) };
            }
        }
        println!("{volume:.2} m³: {built:?}; stepped anyway, off by {largest:.1e} of {exact:.4} kg/s");
        if diverges {
            assert_eq!(built, Err(BuildError::Method(MethodError::NodeTooSmall(2))));
            assert!(largest > 0.1, "{largest}");
        } else {
            for w in built? {
                assert!((w / exact - 1.0).abs() < 1e-5, "{w} against {exact}");
            }
        }
    }
    Ok(())
}

#[test]
fn the_smallest_node_is_judged_with_all_its_lines() {
    // One loop through the node moves it only by what the loop loses, so it does not count.
    let edge = (1e-4 * 287.05 * 295.15) as f32;
    for (lines, loops) in [(1usize, 0usize), (1, 3), (3, 0), (4, 2)] {
        let verdict = |volume: f32| {
            let mut tables = Tables::default();
            let (supply, node) = (tables.node(None, 10.0), tables.node(Some(volume), 0.0));
            let element = example::paper_loop().segments[0].element;
            for _ in 0..lines {
                tables.line((supply, node), &[element], 0, 0.0, 0.0);
            }
            for _ in 0..loops {
                tables.line((node, node), &[element], 0, 0.0, 0.0);
            }
            product::with_simulator(&tables.network(), Method::Relaxation, 10_000, |simulator| {
                simulator.health()
            })
        };
        let refused = Err(BuildError::Method(MethodError::NodeTooSmall(1)));
        assert_eq!(verdict(0.999 * edge * lines as f32), refused, "{lines}, {loops}");
        assert_eq!(verdict(1.001 * edge * lines as f32), Ok(Health::Trusted), "{lines}, {loops}");
    }
}
