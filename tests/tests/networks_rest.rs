//! Small networks at and near rest: where flows vanish, conductances are at their largest, and so is whatever
//! arithmetic makes of them.

use eclss_core::{Health, Method};
use eclss_network_file::parse;
use eclss_tests::networks::run::METHODS;
use eclss_tests::product::with_simulator;

const HEAD: &str = r#"
schema = 1
name = "rest"
reference_pressure_pa = 101325.0
[run]
method = "tr-bdf2"
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 0.001
pressure_pa = 101325.0
temperature_k = 295.15
"#;

/// Runs `steps` steps of 50 ms and returns pressure [Pa gauge] of node 0 and flow [kg/s] of line 0 after each.
fn run(text: &str, method: Method, steps: usize) -> Vec<(f32, f32)> {
    let loaded = parse(&format!("{HEAD}{text}"), "rest.toml").expect("a good file");
    with_simulator(&loaded.network(), method, 50_000, |simulator| {
        let step = |_| {
            assert_eq!(simulator.step(), Health::Trusted, "{}", method.name());
            (simulator.node_gauge_pa(0), simulator.line_flow_kg_s(0))
        };
        (0..steps).map(step).collect()
    })
    .expect("accepted")
}

#[test]
fn a_loop_without_inertance_halves_its_flow_with_every_solve() {
    let text = r#"
[[line]]
id = "loop"
from = "cabin"
to = "cabin"
initial_flow_kg_s = 0.02
[[line.element]]
id = "duct"
kind = "pipe"
resistance_pa_s2_kg2 = 1.2e4
"#;
    for method in METHODS {
        // Newton's iteration towards rest on w|w| halves; one solve a step at least, and nothing ever grows.
        let flows = run(text, method, 8);
        let mut bound = 0.02;
        for (_, flow) in flows {
            bound *= 0.5;
            assert!(flow.abs() <= bound * 1.001, "{}: {flow} kg/s above {bound}", method.name());
        }
    }
}

#[test]
fn a_cabin_behind_a_closed_valve_comes_to_rest() {
    // The leak fills the cabin within seconds; the ducts in series with the valve lose next to nothing then.
    let text = r#"
[[node]]
id = "supply"
kind = "boundary"
pressure_pa = 101488.0
temperature_k = 295.15
[[line]]
id = "feed"
from = "supply"
to = "cabin"
laminar_below_pa = 0.02
[[line.element]]
id = "valve"
kind = "valve"
open_resistance_pa_s2_kg2 = 723.0
exponent = 3.0757585
leakage_opening = 1e-3
opening = 0.0
[[line.element]]
id = "duct"
kind = "pipe"
resistance_pa_s2_kg2 = 723.0
[[line.element]]
id = "outlet"
kind = "valve"
open_resistance_pa_s2_kg2 = 723.0
exponent = 1.4646256
leakage_opening = 1e-3
opening = 0.46
"#;
    let mut wrong = Vec::new();
    for method in METHODS {
        let tail = run(text, method, 4_000).split_off(3_000);
        let (low, high) =
            tail.iter().fold((f32::MAX, f32::MIN), |(low, high), (p, _)| (low.min(*p), high.max(*p)));
        println!("{}: {low} … {high} Pa", method.name());
        if (low - 163.0).abs() > 0.01 || (high - 163.0).abs() > 0.01 {
            wrong.push((method.name(), low, high));
        }
    }
    assert!(wrong.is_empty(), "not at 163 Pa: {wrong:?}");
}
