//! Two loops of coolant that meet at an interface exchanger.

use std::fmt::Write as _;

use crate::support::{signal, with_network};
use eclss_core::Health;
use eclss_network_file::parse;

/// A loop with a heat load, and one that is cooled; `other` is what stands in the second.
fn file(other: &str) -> String {
    let mut text = String::from(
        "schema = 1\nname = \"loops\"\nreference_pressure_pa = 101325.0\n[run]\nmethod = \"implicit-euler\"\nstep = \"20ms\"\n[air]\n",
    );
    for (side, temperature) in [("a", 290.0), ("b", 280.0)] {
        let _ = write!(
            text,
            "[[node]]\nid = \"tank_{side}\"\nkind = \"accumulator\"\nvolume_m3 = 0.01\ndensity_kg_m3 = 1000.0\n\
             stiffness_pa_m3 = 1e7\npressure_pa = 201325.0\ntemperature_k = {temperature:?}\n\
             [[node]]\nid = \"out_{side}\"\nkind = \"liquid\"\nvolume_m3 = 0.005\ndensity_kg_m3 = 1000.0\n\
             bulk_modulus_pa = 2e8\npressure_pa = 201325.0\ntemperature_k = {temperature:?}\n"
        );
    }
    let line = |id: &str, from: &str, to: &str| {
        format!("[[line]]\nid = \"{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n")
    };
    let pump = |id: &str| {
        format!(
            "[[line.element]]\nid = \"{id}\"\nkind = \"pump\"\nshutoff_pa = 100000.0\nquadratic_pa_s2_kg2 = 1e6\npower_w = 20.0\n"
        )
    };
    let heater = |id: &str, power: f32| {
        format!(
            "[[line.element]]\nid = \"{id}\"\nkind = \"heater\"\nresistance_pa_s2_kg2 = 1e6\npower = {power:?}\n"
        )
    };
    text += &line("through_a", "tank_a", "out_a");
    text += &pump("pump_a");
    text += "[[line.element]]\nid = \"ifhx\"\nkind = \"interface_exchanger\"\nresistance_pa_s2_kg2 = 1e6\n\
             liquid_w_k = 3000.0\nliquid_reference_kg_s = 0.15\ncoolant_w_k = 3000.0\ncoolant_reference_kg_s = 0.15\n";
    text += &line("back_a", "out_a", "tank_a");
    text += &heater("load", 1_500.0);
    text += &line("through_b", "tank_b", "out_b");
    text += &pump("pump_b");
    text += other;
    text += &line("back_b", "out_b", "tank_b");
    text += &heater("sink", -1_500.0);
    text
}

const SIDE: &str = "[[line.element]]\nid = \"ifhx_b\"\nkind = \"coolant_side\"\ncondenser = \"ifhx\"\nresistance_pa_s2_kg2 = 1e6\n";

#[test]
fn heat_goes_from_the_warm_loop_to_the_cold_one_and_the_books_close() {
    with_network(&file(SIDE), |loaded, simulator| {
        // What the loops gain of their pumps is 40 W of 1500.
        assert_eq!(simulator.step_times(60_000), Health::Trusted);
        let [heat, taken] = ["ifhx.heat", "ifhx.coolant_heat"].map(|name| signal(loaded, simulator, name));
        assert!((heat / 1_520.0 - 1.0).abs() < 0.02, "{heat} W");
        assert!((heat - taken).abs() < 5.0, "{heat} {taken}");
        // ε-NTU in counterflow at equal flows: Q = U/(1 + U/C)·(T_hot,in − T_cold,in).
        let flow = f64::from(simulator.line_flow_kg_s(0));
        let capacity = 4_186.0 * flow;
        let conductance = 0.5 * 3_000.0 * (flow / 0.15).powf(0.46);
        let inlets = f64::from(simulator.node_temperature_k(0) - simulator.node_temperature_k(2));
        // Each pump warms its stream ahead of the plates alike, so their difference stays.
        let exact = conductance / (1.0 + conductance / capacity) * inlets;
        assert!((f64::from(heat) / exact - 1.0).abs() < 0.01, "{heat} W, {exact} W");
        for ledger in simulator.ledgers() {
            let scale = if ledger.unit == "J" { 1e-6 * ledger.turned_over } else { 1e-9 };
            assert!(ledger.gap().abs() <= scale, "{ledger:?}");
        }
    });
}

#[test]
fn coolant_from_outside_takes_the_place_of_the_other_loop() {
    let text = file("[[line.element]]\nid = \"plain\"\nkind = \"pipe\"\nresistance_pa_s2_kg2 = 1e6\n");
    let text = text.replacen("liquid_w_k", "coolant_flow = 0.1\ncoolant_temperature = 278.0\nliquid_w_k", 1);
    with_network(&text, |loaded, simulator| {
        assert_eq!(simulator.step_times(2_000), Health::Trusted);
        let [taken, outlet] =
            ["ifhx.coolant_heat", "ifhx.air_outlet"].map(|name| signal(loaded, simulator, name));
        assert!(taken > 1_000.0 && (278.0..291.0).contains(&outlet), "{taken} W, {outlet} K");
    });
}

#[test]
fn an_interface_in_a_line_of_air_is_refused() {
    let error = parse(
        &file(SIDE).replacen(
            "kind = \"liquid\"\nvolume_m3 = 0.005\ndensity_kg_m3 = 1000.0\nbulk_modulus_pa = 2e8\n",
            "kind = \"cabin\"\nvolume_m3 = 1.0\n",
            1,
        ),
        "x",
    );
    let error = error.unwrap_err().to_string();
    assert!(error.contains("joins air and coolant"), "{error}");
    let error = parse(&file(&SIDE.replace("\"ifhx\"", "\"nobody\"")), "x").unwrap_err().to_string();
    assert!(error.contains("there is no condenser or interface exchanger `nobody`"), "{error}");
}
