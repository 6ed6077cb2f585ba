//! What comes into a volume from outside is a part of the balance that the implicit methods solve: flows and pressures are right
//! at the end of the very step in which a source is turned on, however small the volume behind it.

mod support;

use eclss_core::Health;
use eclss_network_file::parse;
use eclss_network_file::steady::steady;
use support::with_network;

/// A box of nitrogen with a source of it, open to the ambient through a pipe.
const BOX: &str = r#"
schema = 1
name = "supplied"
reference_pressure_pa = 101325.0
[run]
method = "METHOD"
step = "STEP"
[air]
[[node]]
id = "box"
kind = "cabin"
volume_m3 = 0.2
pressure_pa = 101325.0
temperature_k = 295.15
oxygen_pa = 0.0
[[node]]
id = "ambient"
kind = "boundary"
pressure_pa = 101325.0
temperature_k = 295.15
[[line]]
id = "duct"
from = "box"
to = "ambient"
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 1000.0
[[source]]
id = "supply"
node = "box"
nitrogen = RATE
"#;

fn boxed(method: &str, step: &str, rate: f32) -> String {
    BOX.replace("METHOD", method).replace("STEP", step).replace("RATE", &format!("{rate:?}"))
}

/// Flow out of the box [kg/s] and its pressure [Pa gauge] after so many steps.
fn after(method: &str, step: &str, rate: f32, steps: u64) -> (f32, f32) {
    let mut found = (0.0, 0.0);
    with_network(&boxed(method, step, rate), |_, simulator| {
        assert_eq!(simulator.step_times(steps), Health::Trusted);
        found = (simulator.line_flow_kg_s(0), simulator.node_gauge_pa(0));
    });
    found
}

#[test]
fn what_is_supplied_leaves_at_the_pressure_that_drives_it() {
    for method in ["implicit-euler", "tr-bdf2"] {
        for (step, steps) in [("1ms", 60_000), ("10ms", 6_000), ("50ms", 1_200)] {
            for rate in [0.05f32, 0.005] {
                let (flow, pressure) = after(method, step, rate, steps);
                let drives = 1000.0 * rate * rate;
                println!("{method}, {step}, {rate} kg/s: {flow} kg/s at {pressure} Pa; {drives} Pa drive it");
                assert!((flow / rate - 1.0).abs() < 1e-5, "{method}, {step}: {flow} kg/s of {rate}");
                assert!(
                    (pressure / drives - 1.0).abs() < 1e-2,
                    "{method}, {step}: {pressure} Pa of {drives}"
                );
            }
        }
    }
}

/// Other gases than the box holds raise its pressure by their own gas constants, and what leaves at first is what it held.
#[test]
fn other_gases_are_counted_by_their_gas_constant() {
    for (gas, constant) in [("oxygen", 8_314.46 / 31.998), ("carbon_dioxide", 8_314.46 / 44.009)] {
        for method in ["implicit-euler", "tr-bdf2"] {
            for (step, steps) in [("1ms", 500), ("10ms", 50)] {
                let text = boxed(method, step, 0.01).replace("nitrogen = ", &format!("{gas} = "));
                with_network(&text.replace("volume_m3 = 0.2", "volume_m3 = 20.0"), |_, simulator| {
                    assert_eq!(simulator.step_times(steps), Health::Trusted);
                    let expected = 0.01 * constant / (8_314.46 / 28.013_4);
                    let (flow, pressure) = (simulator.line_flow_kg_s(0), simulator.node_gauge_pa(0));
                    println!("{gas}, {method}, {step}: {flow} kg/s of {expected}, {pressure} Pa");
                    assert!((flow / expected - 1.0).abs() < 1e-2, "{gas}, {method}, {step}: {flow} kg/s");
                    let drives = 1000.0 * flow * flow;
                    assert!((pressure / drives - 1.0).abs() < 2e-2, "{gas}, {method}, {step}: {pressure} Pa");
                });
            }
        }
    }
}

/// What has passed a volume since the start is no pressure: a run ends by what volumes hold, however long it is.
#[test]
fn a_volume_may_be_supplied_many_times_over() {
    for method in ["implicit-euler", "tr-bdf2", "adaptive"] {
        let text = boxed(method, "10ms", 0.05).replace("volume_m3 = 0.2", "volume_m3 = 0.002");
        with_network(&text, |_, simulator| {
            // 3 kg through 2 g.
            assert_eq!(simulator.step_times(6_000), Health::Trusted, "{method}: {:?}", simulator.excursion());
            assert!((simulator.line_flow_kg_s(0) / 0.05 - 1.0).abs() < 1e-2);
        });
    }
}

#[test]
fn a_source_that_begins_is_felt_in_the_same_step() {
    // At steps of 0.1 ms the filling of the box is followed: it is over after some milliseconds.
    for method in ["implicit-euler", "tr-bdf2"] {
        for tens_of_ms in [1, 2, 3, 10] {
            let (fine, fine_pa) = after(method, "100us", 0.05, 100 * tens_of_ms);
            let (coarse, coarse_pa) = after(method, "10ms", 0.05, tens_of_ms);
            println!(
                "{method}, {tens_of_ms}0 ms: {coarse} kg/s and {coarse_pa} Pa; {fine} and {fine_pa} of steps of 0.1 ms"
            );
            assert!((coarse / fine - 1.0).abs() < 0.05, "{method}: {coarse} kg/s of {fine}");
        }
    }
}

#[test]
fn what_is_supplied_is_in_the_state_of_rest() {
    let text = boxed("implicit-euler", "10ms", 0.05);
    let loaded = parse(&text, "box.toml").unwrap();
    let rest = steady(&loaded.network(), &loaded.inputs).unwrap();
    assert!((rest.flow_kg_s[0] / f64::from(0.05f32) - 1.0).abs() < 1e-9, "{rest:?}");
    assert!((rest.gauge_pa[0] / 2.5 - 1.0).abs() < 1e-6, "{rest:?}");
    // A run that starts there stays there.
    let text = text.replace("step = \"10ms\"", "step = \"10ms\"\nstart = \"steady\"");
    with_network(&text, |_, simulator| {
        for _ in 0..100 {
            assert_eq!(simulator.step(), Health::Trusted);
            let (flow, pressure) = (simulator.line_flow_kg_s(0), simulator.node_gauge_pa(0));
            assert!((flow / 0.05 - 1.0).abs() < 1e-3, "{flow} kg/s at tick {}", simulator.tick());
            assert!((pressure / 2.5 - 1.0).abs() < 1e-2, "{pressure} Pa at tick {}", simulator.tick());
        }
    });
    // What a closed box is given makes its pressure rise for ever.
    let closed = boxed("implicit-euler", "10ms", 0.05)
        .replace("kind = \"boundary\"", "kind = \"cabin\"\nvolume_m3 = 9.8");
    let loaded = parse(&closed, "closed.toml").unwrap();
    let error = steady(&loaded.network(), &loaded.inputs).unwrap_err().text(&loaded.names);
    // R·T·0.05 kg/s into 10 m³.
    let rate: f64 = error.split("change by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((rate / (287.055 * 295.15 * 0.05 / 10.0) - 1.0).abs() < 1e-3, "{error}");
}
