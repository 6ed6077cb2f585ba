//! What goes far beyond a cabin's life is followed to its end: blow-down to vacuum, loads that nothing cools, fog.

use crate::support::{assert_closed, with_network};
use eclss_core::Health;
use eclss_core::climate::monitor::Limit;

/// A cabin that a hole of 100 cm² opens to space.
const BREACH: &str = r#"
schema = 1
name = "breach"
reference_pressure_pa = 101325.0
[run]
method = "implicit-euler"
step = "10ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 101325.0
temperature_k = 295.15
[[node]]
id = "space"
kind = "boundary"
pressure_pa = 0.0
temperature_k = 290.0
[[line]]
id = "breach"
from = "cabin"
to = "space"
[[line.element]]
id = "hole"
kind = "orifice"
area_m2 = 0.01
discharge_coefficient = 0.8
"#;

/// A wall of the cabin.
const WALL: &str = r#"
[[wall]]
id = "shell"
node = "cabin"
capacity_j_k = 1e6
inner_w_k = 60.0
outer_w_k = 0.0
temperature_k = 295.0
"#;

#[test]
fn a_cabin_blows_down_to_vacuum_along_the_isentrope() {
    for method in ["implicit-euler", "tr-bdf2", "adaptive"] {
        let text = BREACH.replace("implicit-euler", method);
        let (mut lowest, mut worst) = (f32::INFINITY, 0.0f32);
        with_network(&text, |_, simulator| {
            for _ in 0..3_600 {
                assert_eq!(
                    simulator.step_times(100),
                    Health::Trusted,
                    "{method}: {:?}",
                    simulator.excursion()
                );
                let air = simulator.air(0).unwrap();
                lowest = lowest.min(air.temperature_k);
                assert!(
                    air.temperature_k.is_finite() && air.pressure_pa >= 0.0 && air.pressure_pa.is_finite()
                );
                if air.temperature_k > 60.0 {
                    // T/T0 = (p/p0)^(R/c_p) of dry air with 20.95 % oxygen by volume.
                    let (r, cp) = (288.20f32, 1_011.6f32);
                    let exact = 295.15 * libm::powf(air.pressure_pa / 101_325.0, r / cp);
                    worst = worst.max((air.temperature_k / exact - 1.0).abs());
                }
            }
            assert!(worst < 2e-3, "{method}: {worst}");
            assert!((lowest - 50.0).abs() < 1e-2, "{method}: {lowest}");
            assert!(simulator.air(0).unwrap().pressure_pa < 0.02, "{method}");
            assert!(simulator.warnings(0).has(Limit::Held) && simulator.warnings(0).has(Limit::Vacuum));
            assert_closed(simulator);
        });
    }
}

#[test]
fn a_cabin_in_vacuum_takes_the_temperature_of_its_walls_and_fills_again() {
    with_network(&(BREACH.to_owned() + WALL), |_, simulator| {
        assert_eq!(simulator.step_times(360_000), Health::Trusted, "{:?}", simulator.excursion());
        let air = simulator.air(0).unwrap();
        // The wall has given what the air carried off: 71 kg from 295 K, a few MJ of its 295 MJ.
        assert!(air.pressure_pa < 0.05 && (280.0..295.0).contains(&air.temperature_k), "{air:?}");
        assert!(!simulator.warnings(0).has(Limit::Held));
        assert_closed(simulator);
    });
}

#[test]
fn what_nothing_cools_is_held_and_named_and_comes_back_when_it_is_cooled() {
    let text = BREACH.replace("area_m2 = 0.01", "area_m2 = 1e-8")
        + "[[source]]\nid = \"fire\"\nnode = \"cabin\"\nheat = 20000.0\n";
    with_network(&text, |loaded, simulator| {
        let heat = loaded.names.inputs.iter().position(|name| name == "fire.heat").unwrap();
        // 71 kg of air by 100 K take 5.1 MJ, 270 s of 20 kW; ten minutes bring twice as much.
        assert_eq!(simulator.step_times(60_000), Health::Trusted, "{:?}", simulator.excursion());
        assert!((simulator.node_temperature_k(0) - 395.15).abs() < 1e-2);
        assert_eq!(simulator.first_warning(), Some((0, Limit::Held)));
        assert_closed(simulator);
        // What came in goes out again before the temperature moves.
        simulator.set_input(heat, -20_000.0).unwrap();
        assert_eq!(simulator.step_times(60_000), Health::Trusted);
        let back = simulator.node_temperature_k(0);
        assert!((back - 295.15).abs() < 2.0, "{back}");
        assert_eq!(simulator.first_warning(), None);
    });
}

#[test]
fn the_subsystem_lives_on_when_its_coolant_pump_has_failed_for_good() {
    with_network(include_str!("../../networks/thcs.toml"), |loaded, simulator| {
        let pump = loaded.names.inputs.iter().position(|name| name == "pump.speed").unwrap();
        let warm = loaded.names.nodes.iter().position(|name| name == "warm").unwrap();
        simulator.set_input(pump, 0.0).unwrap();
        let mut held = false;
        for _ in 0..1_500 {
            assert_eq!(simulator.step_times(1_000), Health::Trusted, "{:?}", simulator.excursion());
            held |= simulator.first_warning().is_some_and(|(_, limit)| limit == Limit::Held);
        }
        // Four hours: what the cold plate heats stands still, until it is as hot as is followed.
        assert!(held && simulator.node_temperature_k(warm) > 320.0);
        for ledger in simulator.ledgers() {
            let turned = if ledger.unit == "J" { 1e8 } else { 100.0 };
            assert!(ledger.gap().abs() < 1e-6 * turned, "{ledger:?}");
        }
    });
}

#[test]
fn vapour_above_saturation_is_fog_at_once_and_the_books_stay_closed() {
    let text = BREACH.replace("area_m2 = 0.01", "area_m2 = 1e-8")
        + "[[source]]\nid = \"kettle\"\nnode = \"cabin\"\nvapour = 1e-3\nheat = -1000.0\n";
    for surface in ["", "surface_kg_s_pa = 0.0\n"] {
        let text = text.replacen("kind = \"cabin\"\n", &format!("kind = \"cabin\"\n{surface}"), 1);
        with_network(&text, |_, simulator| {
            let mut most = 0.0f32;
            for _ in 0..1_800 {
                assert_eq!(simulator.step_times(100), Health::Trusted, "{:?}", simulator.excursion());
                most = most.max(simulator.air(0).unwrap().relative_humidity);
            }
            let air = simulator.air(0).unwrap();
            // 1.8 kg came, of which the air at some 20 °C holds about 1 kg.
            assert!((0.999..1.001).contains(&most), "{most}");
            assert!(air.liquid_kg > 0.5, "{air:?}");
            assert!(!simulator.warnings(0).has(Limit::Fog));
            assert_closed(simulator);
        });
    }
}
