//! Fans and pumps with heat and moisture: nothing moves for nothing.

use crate::support::with_network;
use eclss_network_file::parse;

/// A room with a fan that blows through a grille, and `keys` at the fan.
fn file(keys: &str) -> String {
    format!(
        r#"
schema = 1
name = "fan"
reference_pressure_pa = 101325.0
[run]
method = "adaptive"
step = "10ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 50.0
pressure_pa = 101325.0
temperature_k = 295.15
[[line]]
id = "loop"
from = "cabin"
to = "cabin"
[[line.element]]
id = "fan"
kind = "fan"
shutoff_pa = 300.0
quadratic_pa_s2_kg2 = 13000.0
{keys}
[[line.element]]
id = "grille"
kind = "pipe"
resistance_pa_s2_kg2 = 17000.0
"#
    )
}

#[test]
fn a_fan_of_which_nothing_is_said_still_heats_by_what_it_moves() {
    for (keys, efficiency) in [("", 0.5), ("efficiency = 0.8", 0.8), ("efficiency = 1.0", 1.0)] {
        for speed in [1.0f32, 0.6] {
            with_network(&file(keys), |_, simulator| {
                simulator.set_input(0, speed).unwrap();
                simulator.step_times(6_000);
                // All of the loss of a closed loop is friction: R·w³/ρ becomes heat, and the fan's own losses with it.
                let w = f64::from(simulator.line_flow_kg_s(0));
                let friction_w = 17_000.0 * w * w * w / 1.196;
                let [.., energy] = simulator.ledgers();
                let power_w = energy.supplied / 60.0;
                // w·(f0 − f2·w²)/ρ is largest at w² = f0/(3·f2).
                let n = f64::from(speed);
                let most_w = n * n * n * (300.0f64 / 39_000.0).sqrt() * 200.0 / 1.196;
                assert!((power_w * efficiency / most_w - 1.0).abs() < 2e-3, "{keys} {speed}: {power_w} W");
                assert!(power_w > friction_w, "{power_w} W against {friction_w} W of friction");
                assert!(energy.gap().abs() < 1e-3 * energy.held, "{energy:?}");
            });
        }
    }
}

#[test]
fn a_power_below_what_the_stream_gets_is_refused() {
    for (keys, wanted) in [
        ("power_w = 10.0", "less than the 14.6"),
        ("power_w = 40.0\nefficiency = 0.5", "give the power once"),
        ("efficiency = 1.5", "`efficiency` must lie in 0.01 … 1"),
    ] {
        let error = parse(&file(keys), "fan.toml").unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    assert!(parse(&file("power_w = 15.0"), "fan.toml").is_ok());
}
