//! Fits the three conductance figures of the condensing heat exchanger to the rows at 67 °F of its effectiveness
//! table, by both readings of the effectiveness, and shows how the rows at 75 °F then come out.
//!
//! `cargo run --release -p eclss-core --example fit_condenser [sensitivity]`; the word asks instead what the coil does
//! at other coolant flows, with `U_c` held at other values.

#[allow(dead_code, reason = "shared with a test that reads more of it")]
#[path = "../tests/support/effectiveness.rs"]
mod effectiveness;

use eclss_core::components::coil::Condenser;
use effectiveness::{AT_67_F, AT_75_F, AtRest, Inlet, at_rest, errors, largest_and_mean};

/// ln `U_a`, m, ln `U_c`.
type Point = [f64; 3];

fn condenser(point: &Point) -> Condenser {
    Condenser {
        air_w_k: point[0].exp() as f32,
        air_exponent: point[1] as f32,
        coolant_w_k: point[2].exp() as f32,
        ..Condenser::CCAA
    }
}

/// Sum of squares of the relative errors at 67 °F.
fn misfit(point: &Point, read: fn(&AtRest) -> f32) -> f64 {
    errors(&condenser(point), 67.0, &AT_67_F, read).iter().map(|error| f64::from(error * error)).sum()
}

/// Nelder and Mead's simplex method.
fn minimise(start: Point, size: Point, mut f: impl FnMut(&Point) -> f64) -> Point {
    let mut simplex: Vec<(f64, Point)> = vec![(f(&start), start)];
    for (axis, size) in size.into_iter().enumerate() {
        let mut point = start;
        point[axis] += size;
        simplex.push((f(&point), point));
    }
    for _ in 0..120 {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        let worst = simplex[3].1;
        let centre: Point =
            std::array::from_fn(|axis| simplex[..3].iter().map(|p| p.1[axis]).sum::<f64>() / 3.0);
        let mut try_at = |t: f64| {
            let point: Point = std::array::from_fn(|axis| centre[axis] + t * (centre[axis] - worst[axis]));
            (f(&point), point)
        };
        let reflected = try_at(1.0);
        let better = if reflected.0 < simplex[0].0 {
            let expanded = try_at(2.0);
            if expanded.0 < reflected.0 { expanded } else { reflected }
        } else if reflected.0 < simplex[2].0 {
            reflected
        } else {
            let contracted = try_at(if reflected.0 < simplex[3].0 { 0.5 } else { -0.5 });
            if contracted.0 < simplex[3].0.min(reflected.0) {
                contracted
            } else {
                let best = simplex[0].1;
                for corner in &mut simplex[1..] {
                    corner.1 = std::array::from_fn(|axis| 0.5 * (corner.1[axis] + best[axis]));
                    corner.0 = f(&corner.1);
                }
                continue;
            }
        };
        simplex[3] = better;
    }
    simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
    simplex[0].1
}

/// Refits `U_a` and m for other `U_c` and shows the misfit and what the coil then does away from the table.
fn sensitivity() {
    let inlets = [18.0f32, 22.0, 26.0].map(|air_c| {
        [0.074f32, 0.110, 0.145].map(|coolant_kg_s| Inlet {
            air_k: 273.15 + air_c,
            dew_point_k: 273.15 + 10.0,
            air_m3_s: 0.15,
            coolant_k: 277.5,
            coolant_kg_s,
        })
    });
    println!(
        "heat [W] at 0.15 m³/s, dew point 10 °C, coolant 277.5 K; air at 18, 22, 26 °C, each with 74, 110, 145 g/s"
    );
    for coolant_w_k in [2_000.0f64, 4_000.0, 10_468.0, 20_000.0, 100_000.0] {
        let point = minimise([490f64.ln(), 0.57, coolant_w_k.ln()], [0.1, 0.05, 0.0], |point| {
            if (0.0..=1.0).contains(&point[1]) {
                misfit(point, |rest| rest.by_temperature)
            } else {
                f64::INFINITY
            }
        });
        let fitted = condenser(&point);
        let [at_67, at_75] = [(67.0, &AT_67_F), (75.0, &AT_75_F)]
            .map(|(air_f, rows)| largest_and_mean(&errors(&fitted, air_f, rows, |rest| rest.by_temperature)));
        let heats = inlets.map(|row| row.map(|inlet| at_rest(&fitted, inlet, 1_500, 0.2)));
        let text: Vec<_> = heats.iter().flatten().map(|rest| format!("{:.0}", rest.coolant_w)).collect();
        println!(
            "  U_c {coolant_w_k:.0}: U_a {:.1}, m {:.4}; 67 °F {:.2} %, {:.2} %; 75 °F {:.2} %, {:.2} %; {}",
            fitted.air_w_k,
            fitted.air_exponent,
            100.0 * at_67.0,
            100.0 * at_67.1,
            100.0 * at_75.0,
            100.0 * at_75.1,
            text.join(" ")
        );
    }
}

fn main() {
    if std::env::args().any(|word| word == "sensitivity") {
        return sensitivity();
    }
    for (name, read) in [
        ("temperature", (|rest| rest.by_temperature) as fn(&AtRest) -> f32),
        ("enthalpy", |rest| rest.by_enthalpy),
    ] {
        let point = minimise([600f64.ln(), 0.6, 3000f64.ln()], [0.3, 0.1, 0.7], |point| {
            // Outside the ranges of the exponent there is no coil.
            if (0.0..=1.0).contains(&point[1]) { misfit(point, read) } else { f64::INFINITY }
        });
        let fitted = condenser(&point);
        println!(
            "by {name}: U_a {:.1} W/K at 0.1 kg/s, m {:.4}, U_c {:.0} W/K",
            fitted.air_w_k, fitted.air_exponent, fitted.coolant_w_k
        );
        for (air_f, rows) in [(67.0, &AT_67_F), (75.0, &AT_75_F)] {
            let list = errors(&fitted, air_f, rows, read);
            let (largest, mean) = largest_and_mean(&list);
            println!("  {air_f} °F: largest error {:.2} %, mean {:.2} %", 100.0 * largest, 100.0 * mean);
            for (row, (dew_point_f, _)) in list.chunks(9).zip(rows) {
                let text: Vec<_> = row.iter().map(|error| format!("{:+.1}", 100.0 * error)).collect();
                println!("    dew point {dew_point_f} °F: {} %", text.join(" "));
            }
        }
    }
}
