//! Lines whose laws look at the gas: density by the present temperature and composition of the air upstream.

use crate::support::with_network;
use eclss_core::{Health, Simulator};

/// A warm, humid cabin with much carbon dioxide that is heated and loses air to a vacuum and to a colder room.
fn file(method: &str) -> String {
    format!(
        r#"
schema = 1
name = "warm"
reference_pressure_pa = 101325.0
[run]
method = "{method}"
step = "1ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 20.0
pressure_pa = 101325.0
temperature_k = 303.15
dew_point_k = 300.0
carbon_dioxide_pa = 2000.0
[[node]]
id = "room"
kind = "boundary"
pressure_pa = 100325.0
temperature_k = 285.15
[[node]]
id = "space"
kind = "boundary"
pressure_pa = 0.0
temperature_k = 285.15
[[source]]
id = "heat"
node = "cabin"
heat = 40000.0
vapour = 0.002
[[line]]
id = "duct"
from = "cabin"
to = "room"
density = "follows"
reference_density_kg_m3 = 1.2
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 40000.0
[[line]]
id = "back"
from = "room"
to = "cabin"
density = "follows"
reference_density_kg_m3 = 1.2
[[line.element]]
id = "grille"
kind = "pipe"
resistance_pa_s2_kg2 = 90000.0
[[line]]
id = "hole"
from = "cabin"
to = "space"
[[line.element]]
id = "leak"
kind = "orifice"
area_m2 = 1e-4
discharge_coefficient = 0.6
"#
    )
}

/// Gas constant [J/(kg·K)] and temperature [K] of the cabin's air from its partial pressures, in double precision.
fn gas(simulator: &Simulator<'_>) -> (f64, f64, f64) {
    let air = simulator.air(0).unwrap();
    let molar = [28.013_4, 31.998, 44.009, 18.015, 28.965];
    let pressure: f64 = air.partial_pa[..5].iter().map(|p| f64::from(*p)).sum();
    let mean: f64 = air.partial_pa.iter().zip(molar).map(|(p, m)| f64::from(*p) * m / pressure).sum();
    (8_314.463 / mean, f64::from(air.temperature_k), 101_325.0 + f64::from(simulator.node_gauge_pa(0)))
}

#[test]
fn flows_follow_the_air_as_it_warms_and_moistens() {
    // An implicit step ends at a lower pressure than it begins with, and does not know yet what the heat of the step,
    // 0.8 Pa of 190 … 1000 Pa, puts back; the density makes 3 %.
    for (method, bar) in [("adaptive", 3e-7), ("implicit-euler", 2.1e-3), ("tr-bdf2", 2.1e-3)] {
        with_network(&file(method), |_, simulator| {
            let (start_gas, start_k, _) = gas(simulator);
            for _ in 0..20 {
                simulator.step_times(999);
                let (gas, temperature, pressure) = gas(simulator);
                assert_eq!(simulator.step(), Health::Trusted);
                let density = pressure / (gas * temperature);
                let duct = (density / 1.2 * (pressure - 100_325.0) / 40_000.0).sqrt();
                // Reversed flow too has the density of the air that comes.
                let back = -(density / 1.2 * (pressure - 100_325.0) / 90_000.0).sqrt();
                // De Saint-Venant and Wantzel, choked.
                let hole = 0.6e-4 * pressure / (gas * temperature).sqrt() * 0.468_857_1f64.sqrt();
                for (line, exact) in [duct, back, hole].into_iter().enumerate() {
                    let found = f64::from(simulator.line_flow_kg_s(line));
                    assert!((found / exact - 1.0).abs() < bar, "{method}, line {line}: {found} for {exact}");
                }
            }
            // The laws have had something to follow.
            let (gas, temperature, _) = gas(simulator);
            assert!(temperature > start_k + 10.0 && gas > start_gas * 1.0005, "{temperature} K, {gas}");
        });
    }
}

/// A fan at its shut-off head against a colder room: one state of rest, whether it comes from below or from above, and
/// the methods stand still there (without the inertance of a duct, in which it would ring for minutes). Its intake stands at the reference density, so that the rest is 1000 Pa above it.
#[test]
fn a_fan_at_its_shut_off_head_has_one_rest() {
    let file = |method: &str, room_pa: f64| {
        format!(
            r#"
schema = 1
name = "deadhead"
reference_pressure_pa = 101325.0
[run]
method = "{method}"
step = "10ms"
[[node]]
id = "hall"
kind = "boundary"
pressure_pa = 101325.0
temperature_k = 303.15
[[node]]
id = "room"
kind = "cabin"
volume_m3 = 1.0
pressure_pa = {room_pa:?}
temperature_k = 293.15
[[line]]
id = "duct"
from = "hall"
to = "room"
density = "follows"
[[line.element]]
id = "fan"
kind = "fan"
shutoff_pa = 1000.0
quadratic_pa_s2_kg2 = 4000.0
"#
        )
    };
    for method in ["adaptive", "implicit-euler", "tr-bdf2"] {
        for room_pa in [101_325.0, 102_000.0, 102_340.0, 103_000.0] {
            with_network(&file(method, room_pa), |loaded, simulator| {
                for _ in 0..60_000 {
                    assert_eq!(simulator.step(), Health::Trusted);
                }
                let (gauge, flow) = (simulator.node_gauge_pa(1), simulator.line_flow_kg_s(0));
                assert!((gauge - 1_000.0).abs() < 0.1, "{method} from {room_pa} Pa: {gauge} Pa");
                assert!(flow.abs() < 1e-5, "{method} from {room_pa} Pa: {flow} kg/s");
                let rest = eclss_network_file::steady::steady(&loaded.network(), &loaded.inputs).unwrap();
                assert!((rest.gauge_pa[1] - 1_000.0).abs() < 1e-3, "{rest:?}");
            });
        }
    }
}
