//! Heat that is put into a stream which stands still warms both ends of its line alike, whatever rounding makes of its flow.

use crate::support::{assert_closed, with_network};
use eclss_core::Health;

/// Two cabins, a heater between them whose line is all but shut, and another line that is open.
const CABINS: &str = r#"
schema = 1
name = "standing"
reference_pressure_pa = 101325.0
[run]
method = "METHOD"
step = "STEP"
[air]
[[node]]
id = "first"
kind = "cabin"
volume_m3 = 30.0
pressure_pa = 101325.0
temperature_k = 295.15
[[node]]
id = "second"
kind = "cabin"
volume_m3 = 30.0
pressure_pa = 101325.0
temperature_k = 295.15
[[line]]
id = "duct"
from = "first"
to = "second"
[[line.element]]
id = "heater"
kind = "heater"
resistance_pa_s2_kg2 = 100.0
power = POWER
[[line.element]]
id = "valve"
kind = "valve"
open_resistance_pa_s2_kg2 = 1000.0
inertance_per_m = 100.0
exponent = 3.0
opening = 0.0
"#;

fn cabins(method: &str, step: &str, power: f32) -> String {
    CABINS.replace("METHOD", method).replace("STEP", step).replace("POWER", &format!("{power:?}"))
}

#[test]
fn both_ends_warm_alike_when_nothing_flows() {
    for method in ["implicit-euler", "tr-bdf2", "adaptive"] {
        for (step, steps) in [("1ms", 200_000), ("10ms", 20_000)] {
            for power in [300.0, -300.0] {
                with_network(&cabins(method, step, power), |_, simulator| {
                    assert_eq!(simulator.step_times(steps), Health::Trusted);
                    let rises = [0, 1].map(|node| simulator.node_temperature_k(node) - 295.15);
                    println!("{method}, {step}, {power} W: {rises:?} K after 200 s");
                    // 60 kJ into 35.9 kg of air each, at constant volume: 717 J/(kg·K).
                    let expected = 0.5 * power * 200.0 / (35.9 * 719.0);
                    for rise in rises {
                        assert!((rise / expected - 1.0).abs() < 0.02, "{method}, {step}: {rises:?}");
                    }
                    assert_closed(simulator);
                });
            }
        }
    }
}

#[test]
fn what_flows_carries_all_of_it() {
    // Open, with enough pressure to move some air for a moment: all heat goes downstream.
    let text = cabins("implicit-euler", "10ms", 300.0).replace("opening = 0.0", "opening = 1.0").replacen(
        "pressure_pa = 101325.0\ntemperature_k",
        "pressure_pa = 101425.0\ntemperature_k",
        1,
    );
    let unheated = text.replace("power = 300.0", "power = 0.0");
    let after = |text: &str| {
        with_network(text, |_, simulator| {
            assert_eq!(simulator.step_times(10), Health::Trusted);
            let flow = simulator.line_flow_kg_s(0);
            assert!(flow > 0.05, "{flow} kg/s");
            [0, 1].map(|node| simulator.node_temperature_k(node))
        })
    };
    let ([first, second], [cold, mixed]) = (after(&text), after(&unheated));
    assert!((first - cold).abs() < 1e-4, "{first} K upstream, {cold} K without the heater");
    assert!(second - mixed > 5e-4, "{second} K downstream, {mixed} K without the heater");
}

/// A coil behind the heater takes from the stream what the stream has, not what it could not carry.
#[test]
fn a_coil_in_the_same_line_does_not_get_what_the_stream_could_not_carry() {
    let coil = "[[line.element]]\nid = \"che\"\nkind = \"condenser\"\nresistance_pa_s2_kg2 = 100.0\ncoolant_flow = 0.1\n\
                coolant_temperature = 285.0\n";
    for power in [150.0, -150.0] {
        let text = cabins("implicit-euler", "10ms", power)
            .replace("[[line.element]]\nid = \"valve\"", &format!("{coil}[[line.element]]\nid = \"valve\""));
        with_network(&text, |_, simulator| {
            assert_eq!(simulator.step_times(20_000), Health::Trusted);
            let rises = [0, 1].map(|node| simulator.node_temperature_k(node) - 295.15);
            let expected = 0.5 * power * 200.0 / (35.9 * 719.0);
            for rise in rises {
                assert!((rise / expected - 1.0).abs() < 0.05, "{rises:?} K, {expected} K expected");
            }
            assert_closed(simulator);
        });
    }
}
