//! The flow of a line that is shown is the one that moves the masses, at every tick: so are the ledger, the pressures and
//! the compositions that come of it.

use crate::support::with_network;
use eclss_core::{Health, NodeKind};

/// A station with heat in its cabins, and the networks that ship.
const FILES: [(&str, &str); 5] = [
    ("duo", include_str!("files/duo.toml")),
    ("thcs", include_str!("../../networks/thcs.toml")),
    ("station", include_str!("../../networks/station.toml")),
    ("paper-p", include_str!("../../networks/paper-p.toml")),
    ("hil", include_str!("../../networks/hil.toml")),
];

#[test]
fn what_is_shown_is_what_the_ledger_moves() {
    for (name, text) in FILES {
        for method in ["tr-bdf2", "implicit-euler"] {
            let text: String = text
                .lines()
                .map(|line| {
                    if line.starts_with("method") {
                        format!("method = \"{method}\"\n")
                    } else {
                        format!("{line}\n")
                    }
                })
                .collect();
            with_network(&text, |loaded, simulator| {
                let step_s = f64::from(simulator.settings().step_us) * 1e-6;
                let lines = loaded.lines.len();
                let mut given: Vec<f64> = (0..lines).map(|line| simulator.line_sums_kg(line)[1]).collect();
                let (mut range, mut apart) =
                    (vec![[f64::INFINITY, f64::NEG_INFINITY]; lines], vec![0.0f64; lines]);
                for tick in 0..2_000 {
                    assert_eq!(simulator.step(), Health::Trusted, "{name}, {method}, tick {tick}");
                    for line in 0..lines {
                        let now = simulator.line_sums_kg(line)[1];
                        let booked = (now - given[line]) / step_s;
                        // Sums are of two `f32`, whose carry keeps a step's part to some 1e-9 of the sum.
                        let rounded = 1e-8 * now.abs() / step_s;
                        given[line] = now;
                        // At the outlet, behind every drain.
                        let mut shown = f64::NAN;
                        simulator.read_line(line, |segment, flow, _| {
                            let removal: f64 = 1.0
                                + f64::from(eclss_core::Element::removal(&loaded.segments[segment].element));
                            if shown.is_nan() {
                                shown = f64::from(flow) / if flow > 0.0 { removal } else { 1.0 };
                            }
                        });
                        range[line] = [range[line][0].min(booked), range[line][1].max(booked)];
                        apart[line] = apart[line].max((shown - booked).abs() - rounded);
                    }
                }
                for line in 0..lines {
                    let [low, high] = range[line];
                    let most = 0.01 * (high - low).max(1e-6);
                    let id = &loaded.names.lines[line];
                    assert!(
                        apart[line] <= most,
                        "{name}, {method}, {id}: {:e} kg/s off, {low} … {high}",
                        apart[line]
                    );
                }
            });
        }
    }
}

#[test]
fn flows_through_an_open_hatch_balance_the_mass_of_a_heated_cabin() {
    with_network(FILES[0].1, |loaded, simulator| {
        let hab = loaded.names.nodes.iter().position(|id| id == "hab").expect("a module");
        let NodeKind::Cabin { volume_m3 } = loaded.nodes[hab].kind else { panic!("a cabin") };
        // Mass from what is shown of the air, by the ideal gas and the gas constants of its parts.
        let mass = |simulator: &eclss_core::Simulator<'_>| {
            let air = simulator.air(hab).expect("air");
            let constants = [296.80, 259.84, 188.92, 461.52];
            let parts = air.partial_pa.iter().zip(constants);
            let volume = f64::from(volume_m3);
            parts.map(|(p, r)| f64::from(*p) / r).sum::<f64>() * volume / f64::from(air.temperature_k)
        };
        let run = |simulator: &mut eclss_core::Simulator<'_>, seconds: u32| {
            let mut net = 0.0;
            for _ in 0..100 * seconds {
                assert_eq!(simulator.step(), Health::Trusted);
                for (index, line) in loaded.lines.iter().enumerate() {
                    let flow = f64::from(simulator.line_flow_kg_s(index));
                    net += if line.to as usize == hab { flow } else { 0.0 };
                    net -= if line.from as usize == hab { flow } else { 0.0 };
                }
            }
            net / f64::from(100 * seconds)
        };
        run(simulator, 60);
        let before = mass(simulator);
        let shown = run(simulator, 100);
        let moved = (mass(simulator) - before) / 100.0;
        // Four people give off 0.05 g/s more of water and carbon dioxide than they take of oxygen, and f32 pressures of
        // 101 kPa are known to 1e-8 of 70 kg.
        println!("shown {shown:.3e} kg/s, moved {moved:.3e} kg/s");
        assert!((shown - moved).abs() < 2e-4, "shown {shown} kg/s, moved {moved} kg/s");
    });
}
