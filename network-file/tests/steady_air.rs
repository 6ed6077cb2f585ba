//! `start = "steady"` with heat and moisture: pressures, masses and compositions of the start belong together.

use std::fmt::Write as _;

use crate::support::with_network;
use eclss_core::Health;
use eclss_core::fluid::medium::{GAS_CONSTANTS_J_KG_K, dot};
use eclss_network_file::Loaded;

/// Two rooms between two boundaries, and a loop of coolant; pressures far from rest.
fn file(start: &str) -> String {
    let mut text = format!(
        r#"
schema = 1
name = "rest"
reference_pressure_pa = 100000.0
[run]
method = "implicit-euler"
step = "10ms"
start = "{start}"
[air]
[[node]]
id = "supply"
kind = "boundary"
pressure_pa = 101000.0
temperature_k = 295.15
[[node]]
id = "first"
kind = "cabin"
volume_m3 = 30.0
pressure_pa = 99000.0
temperature_k = 303.15
dew_point_k = 285.0
carbon_dioxide_pa = 700.0
[[node]]
id = "second"
kind = "cabin"
volume_m3 = 8.0
pressure_pa = 100400.0
temperature_k = 288.15
dew_point_k = 280.0
[[node]]
id = "sink"
kind = "boundary"
pressure_pa = 100000.0
temperature_k = 295.15
[[node]]
id = "warm"
kind = "liquid"
volume_m3 = 0.01
density_kg_m3 = 1000.0
bulk_modulus_pa = 2e8
pressure_pa = 300000.0
temperature_k = 290.15
[[node]]
id = "spring"
kind = "accumulator"
volume_m3 = 0.02
density_kg_m3 = 1000.0
stiffness_pa_m3 = 1e7
pressure_pa = 250000.0
temperature_k = 285.15
[[line]]
id = "out"
from = "warm"
to = "spring"
[[line.element]]
id = "pump"
kind = "pump"
shutoff_pa = 20000.0
quadratic_pa_s2_kg2 = 1e6
power_w = 60.0
[[line]]
id = "return"
from = "spring"
to = "warm"
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 1e6
"#
    );
    for (id, from, to, resistance) in
        [("a", "supply", "first", 1e4), ("b", "first", "second", 2e4), ("c", "second", "sink", 3e4)]
    {
        text += "[[line]]\ndensity = \"follows\"\n";
        let _ = writeln!(
            text,
            "id = \"{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n[[line.element]]\nid = \"{id}_pipe\""
        );
        let _ = writeln!(text, "kind = \"pipe\"\nresistance_pa_s2_kg2 = {resistance:e}");
    }
    text
}

/// Absolute pressure [Pa] that gas law, or spring, gives the mass of node `index` at the start; with the nominal mass and
/// pressure of coolant.
fn pressure_of_mass(loaded: &Loaded, index: usize, volume_m3: f64) -> f64 {
    let volume = &loaded.climate.volumes[index];
    let gas = f64::from(dot(&volume.fractions, &GAS_CONSTANTS_J_KG_K));
    f64::from(volume.start_kg) * gas * f64::from(loaded.nodes[index].temperature_k) / volume_m3
}

#[test]
fn masses_and_pressures_of_a_steady_start_keep_the_gas_law() {
    let compositions = |loaded: &Loaded| {
        let list = loaded.climate.volumes.iter().map(|volume| volume.fractions);
        list.collect::<Vec<_>>()
    };
    let before = with_network(&file("file"), |loaded, _| compositions(loaded));
    with_network(&file("steady"), |loaded, simulator| {
        assert_eq!(compositions(loaded), before);
        for (index, volume_m3) in [(1, 30.0), (2, 8.0)] {
            let pressure = 1e5 + f64::from(loaded.nodes[index].start_gauge_pa);
            assert!((1e5..=101_000.0).contains(&pressure), "between its boundaries: {pressure}");
            let found = pressure_of_mass(loaded, index, volume_m3);
            assert!((found / pressure - 1.0).abs() < 2e-7, "node {index}: {found} for {pressure} Pa");
            let air = simulator.air(index).unwrap();
            let sum: f32 = air.partial_pa.iter().sum();
            assert!(
                (sum / air.pressure_pa - 1.0).abs() < 1e-6 && (f64::from(sum) / found - 1.0).abs() < 1e-6
            );
        }
        // Springs: δm = Cap·δp, and what one coolant volume gives the other takes.
        let moved =
            |index: usize, nominal_kg: f64| f64::from(loaded.climate.volumes[index].start_kg) - nominal_kg;
        let (warm, spring) = (moved(4, 10.0), moved(5, 20.0));
        let expected = 1000.0 / 1e7 * (f64::from(loaded.nodes[5].start_gauge_pa) - 150_000.0);
        assert!((spring - expected).abs() < 4e-6, "{spring} for {expected} kg");
        assert!((warm + spring).abs() < 4e-6, "{warm} + {spring} kg");
        // Nothing moves but heat and what it does, and the books close from the first step on.
        let rest: Vec<_> = (0..3).map(|line| simulator.line_flow_kg_s(2 + line)).collect();
        assert!(rest.iter().all(|flow| (flow / rest[0] - 1.0).abs() < 1e-6) && rest[0] > 0.01, "{rest:?}");
        let mass = simulator.ledgers().map(|ledger| ledger.held);
        assert!(mass.iter().all(|held| held.abs() < f64::MIN_POSITIVE), "{mass:?}");
        assert_eq!(simulator.step(), Health::Trusted);
        for (line, rest) in rest.iter().enumerate() {
            let flow = simulator.line_flow_kg_s(2 + line);
            assert!((flow / rest - 1.0).abs() < 1e-4, "line {line}: {rest}, then {flow} kg/s");
        }
        assert_eq!(simulator.step_times(1_000), Health::Trusted);
        for ledger in simulator.ledgers() {
            let scale = if ledger.unit == "kg" { 1e-6 } else { 5.0 };
            assert!(ledger.gap().abs() < scale, "{ledger:?}");
        }
    });
}
