//! Near rest a loss is linear in flow, in lines that take mass out as well.

use std::fmt::Write;

use eclss_core::{Buffers, Health, Line, Method, Network, Settings, Simulator};
use eclss_network_file::parse;
use eclss_network_file::steady::steady;

const DRIVE_PA: f64 = 0.25;
const LIMIT_PA: f64 = 1.0;
const RESISTANCES: [f64; 3] = [2e3, 5e3, 3e3];
/// Share of the flow behind it that the first element takes out.
const REMOVAL: f64 = 0.1;

/// Three elements between two held pressures, the first of which condenses.
fn text(forward: bool, volume_m3: f64) -> String {
    let mut text = String::from("schema = 1\nname = \"laminar\"\nreference_pressure_pa = 101325.0\n");
    let gauge = if forward { [DRIVE_PA, 0.0] } else { [0.0, DRIVE_PA] };
    for (id, gauge) in ["a", "b"].iter().zip(gauge) {
        let _ = write!(
            text,
            "[[node]]\nid = \"{id}\"\nkind = \"boundary\"\npressure_pa = {}\ntemperature_k = 295.15\n",
            101_325.0 + gauge
        );
    }
    let _ = write!(text, "[[line]]\nid = \"l\"\nfrom = \"a\"\nto = \"b\"\nlaminar_below_pa = {LIMIT_PA:e}\n");
    for (index, resistance) in RESISTANCES.iter().enumerate() {
        let kind = match index {
            0 => format!(
                "kind = \"heat_exchanger\"\nliquid_fraction = {REMOVAL}\nseparator_efficiency = 1.0\n"
            ),
            _ => "kind = \"pipe\"\n".to_owned(),
        };
        let _ = write!(
            text,
            "[[line.element]]\nid = \"e{index}\"\n{kind}resistance_pa_s2_kg2 = {resistance:e}\noutlet_volume_m3 = {volume_m3:e}\n"
        );
    }
    text
}

/// Flow at one of the elements after 2000 steps of 10 ms, and at the steady state [kg/s].
fn flow_kg_s(text: &str, flow_segment: u32, method: Method) -> (f64, f64) {
    let loaded = parse(text, "laminar.toml").unwrap_or_else(|error| panic!("{error}"));
    let network = loaded.network();
    let lines = [Line { flow_segment, ..network.lines[0] }];
    let network = Network { lines: &lines, ..network };
    let sizes = method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let mut simulator = Simulator::new(&network, Settings { method, step_us: 10_000 }, buffers).unwrap();
    for _ in 0..2000 {
        assert_eq!(simulator.step(), Health::Trusted);
    }
    let steady = steady(&network, network.inputs).expect("a steady state");
    (f64::from(simulator.line_flow_kg_s(0)), steady.flow_kg_s[0])
}

#[test]
fn the_limit_is_a_pressure_whatever_is_taken_out() {
    for (forward, flow_element, volume_m3) in
        (0..12).map(|case| (case % 2 == 0, case / 2 % 3, if case < 6 { 0.0 } else { 1e-3 }))
    {
        // With m the ratio to the flow that is asked for, y = Σm²R·w·√(y_lin/Σm²R).
        let share = |index: usize| if forward && index == 0 { 1.0 + REMOVAL } else { 1.0 };
        let ratio = |index: usize| share(index) / share(flow_element);
        let resistance: f64 = (0..3).map(|index| ratio(index).powi(2) * RESISTANCES[index]).sum();
        let sign = if forward { 1.0 } else { -1.0 };
        let expected = sign * DRIVE_PA / (resistance * LIMIT_PA).sqrt();
        for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
            let text = text(forward, volume_m3);
            let (found, steady) = flow_kg_s(&text, flow_element as u32, method);
            let case = format!("{method:?}, forward: {forward}, e{flow_element}, {volume_m3} m3");
            assert!((steady / expected - 1.0).abs() < 1e-6, "steady, {case}: {steady} for {expected}");
            assert!((found / expected - 1.0).abs() < 2e-6, "{case}: {found} for {expected}");
        }
    }
}
