//! What comes into a volume from outside is a part of the balance that the implicit methods solve: flows and pressures are right
//! at the end of the very step in which a source is turned on, however small the volume behind it.

use crate::support::with_network;
use eclss_core::fluid::medium::NITROGEN;
use eclss_core::{Health, Strayed};
use eclss_network_file::steady::steady;
use eclss_network_file::{parse, unrest};

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

/// The box behind a choked orifice rests far above where it starts; behind one that is too small it never rests.
#[test]
fn a_choked_orifice_has_its_state_of_rest() {
    let orifice = |diameter: f32| {
        let element = format!("kind = \"orifice\"\ndiameter_m = {diameter:?}\ndischarge_coefficient = 0.8");
        boxed("implicit-euler", "10ms", 0.005)
            .replace("kind = \"pipe\"\nresistance_pa_s2_kg2 = 1000.0", &element)
    };
    for diameter in [0.001f32, 0.0012, 0.0015, 0.002, 0.0025, 0.003] {
        let loaded = parse(&orifice(diameter), "box.toml").unwrap();
        let rest = steady(&loaded.network(), &loaded.inputs).unwrap();
        // w = C_d·A·p·√(γ/(R·T))·(2/(γ + 1))^3
        let area = 0.25 * std::f64::consts::PI * f64::from(diameter).powi(2);
        let gas = 8_314.463 / 28.013_4 * 295.15;
        let choked = 0.8 * area * (1.4f64 / gas).sqrt() * (2.0f64 / 2.4).powi(3);
        let (pressure, expected) = (101_325.0 + rest.gauge_pa[0], 0.005 / choked);
        println!("{diameter} m: {pressure} Pa, {expected} Pa by the formula");
        assert!((pressure / expected - 1.0).abs() < 1e-3);
        assert!((rest.flow_kg_s[0] / 0.005 - 1.0).abs() < 1e-5);
    }
    let loaded = parse(&orifice(0.0001), "box.toml").unwrap();
    let error = steady(&loaded.network(), &loaded.inputs).unwrap_err().text(&loaded.names);
    assert!(error.contains("more than a run is trusted with") && error.contains("`box`"), "{error}");
}

/// As much in as out leaves a closed pair of boxes at rest, though single precision does not quite add up.
#[test]
fn sources_that_cancel_rest() {
    let source = |id: &str, node: &str, rate: f32| {
        format!("[[source]]\nid = \"{id}\"\nnode = \"{node}\"\nnitrogen = {rate:?}\n")
    };
    let text = boxed("implicit-euler", "10ms", 0.1)
        .replace("kind = \"boundary\"", "kind = \"cabin\"\nvolume_m3 = 2.0")
        + &source("more", "ambient", 0.2)
        + &source("vent", "ambient", -0.3);
    let loaded = parse(&text, "boxes.toml").unwrap();
    let rest = steady(&loaded.network(), &loaded.inputs).unwrap();
    assert!((rest.flow_kg_s[0] / 0.1 - 1.0).abs() < 1e-5, "{rest:?}");
    assert!(unrest(&loaded).is_empty(), "{:?}", unrest(&loaded));
    // With a little more it rises for ever, and each source is told.
    let loaded = parse(&text.replace("-0.3", "-0.299"), "boxes.toml").unwrap();
    let told: Vec<_> = unrest(&loaded).into_iter().map(|unrest| unrest.reason).collect();
    assert_eq!(told.len(), 3, "{told:#?}");
    assert!(steady(&loaded.network(), &loaded.inputs).is_err());
}

/// A sink that takes more than there is ends the run by the name of what it took, nitrogen as any other part.
#[test]
fn nitrogen_that_is_not_there_is_not_taken() {
    for method in ["implicit-euler", "tr-bdf2"] {
        let text = boxed(method, "10ms", -0.01)
            .replace("kind = \"boundary\"", "kind = \"cabin\"\nvolume_m3 = 0.1")
            .replacen(
                "temperature_k = 295.15\n[[line]]",
                "temperature_k = 295.15\noxygen_pa = 0.0\n[[line]]",
                1,
            );
        with_network(&text, |_, simulator| {
            // 0.35 kg are gone after 35 s.
            let health = simulator.step_times(6_000);
            assert!(
                matches!(health, Health::Faulted(_)),
                "{method}: {health:?} after {} s",
                simulator.time_us() / 1_000_000
            );
            let beyond = simulator.excursion().map(|excursion| excursion.quantity);
            assert_eq!(beyond, Some(Strayed::Part(NITROGEN as u32)), "{method}");
            assert!(simulator.time_us() > 25_000_000, "{method}: {} µs", simulator.time_us());
        });
    }
}
