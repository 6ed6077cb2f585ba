//! The station that ships: its steady flows are the printed ones, and methods that step in time go there.

use std::collections::BTreeMap;

use eclss_core::{Health, Method, NodeKind};
use eclss_network_file::steady::steady;
use eclss_network_file::{Loaded, parse};
use eclss_tests::product::with_simulator;

/// Ventilation between modules in 2015, in cubic feet a minute (C. Son, Boeing, in V-HAB); the returns of the airlock and
/// of the PMM are assumed equal.
const PRINTED_CFM: [(&str, &str, f64); 16] = [
    ("lab", "node1", 126.0),
    ("node1", "node3", 30.0),
    ("node3", "lab", 126.0),
    ("lab", "node2", 120.0),
    ("node2", "lab", 120.0),
    ("node2", "columbus", 110.0),
    ("columbus", "node2", 110.0),
    ("node2", "jem", 110.0),
    ("jem", "node2", 110.0),
    ("node1", "airlock", 115.0),
    ("airlock", "node1", 115.0),
    ("node1", "fgb", 96.0),
    ("fgb", "sm", 96.0),
    ("sm", "node3", 96.0),
    ("node3", "pmm", 60.0),
    ("pmm", "node3", 60.0),
];

/// Volumes [m³] (V-HAB).
const PRINTED_M3: [(&str, f64); 7] = [
    ("lab", 97.71),
    ("node1", 57.8),
    ("node2", 73.9),
    ("node3", 63.7),
    ("columbus", 65.4),
    ("jem", 168.7),
    ("airlock", 31.4),
];

const M3_S_PER_CFM: f64 = 4.719_474_432e-4;
/// Largest relative distance from a printed flow [1].
const MOST: f64 = 0.01;

fn station() -> Loaded {
    parse(include_str!("../../networks/station.toml"), "station.toml").expect("a good file")
}

/// Printed flows [kg/s] by line, for the cabins' air.
fn printed(loaded: &Loaded) -> BTreeMap<usize, f64> {
    let density = 101_325.0 / (287.05 * 295.35);
    let node = |id: &str| loaded.names.nodes.iter().position(|name| name == id).expect("a module") as u32;
    PRINTED_CFM
        .iter()
        .map(|&(from, to, cfm)| {
            let (from, to) = (node(from), node(to));
            let mut lines = loaded.lines.iter().enumerate();
            let found = lines.find(|(_, line)| line.from == from && line.to == to).expect("a line");
            (found.0, cfm * M3_S_PER_CFM * density)
        })
        .collect()
}

#[test]
fn steady_flows_are_the_printed_ones() {
    let loaded = station();
    let found = steady(&loaded.network(), &loaded.inputs).expect("a steady state");
    for (line, flow) in printed(&loaded) {
        let off = found.flow_kg_s[line] / flow - 1.0;
        assert!(off.abs() < MOST, "{}: {:+.3} %", loaded.names.lines[line], 100.0 * off);
    }
}

#[test]
fn modules_are_those_that_are_printed_and_labs_have_two_loops() {
    let loaded = station();
    let cabins = loaded.nodes.iter().filter(|node| matches!(node.kind, NodeKind::Cabin { .. }));
    assert!(cabins.count() >= 8);
    for (id, volume) in PRINTED_M3 {
        let index = loaded.names.nodes.iter().position(|name| name == id).expect("a module");
        let NodeKind::Cabin { volume_m3 } = loaded.nodes[index].kind else { panic!("{id} is no cabin") };
        assert!((f64::from(volume_m3) - volume).abs() < 1e-4, "{id}: {volume_m3} m³");
    }
    for lab in ["lab", "columbus", "jem"] {
        let index = loaded.names.nodes.iter().position(|name| name == lab).expect("a lab") as u32;
        let loops = loaded.lines.iter().filter(|line| line.from == index && line.to == index);
        assert_eq!(loops.count(), 2, "{lab}");
    }
}

#[test]
fn methods_isolate_columbus_and_come_back_to_the_printed_flows() {
    let loaded = station();
    let network = loaded.network();
    for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
        with_simulator(&network, method, 1_000, |simulator| {
            let id = "node2_columbus";
            let columbus = loaded.names.lines.iter().position(|name| name == id).expect("a line");
            while simulator.time_us() < 60_000_000 {
                assert_eq!(simulator.step(), Health::Trusted, "{}", method.name());
                if simulator.time_us() == 20_000_000 {
                    let leakage = simulator.line_flow_kg_s(columbus);
                    assert!(leakage.abs() < 1e-3, "{}: closed valve passes {leakage} kg/s", method.name());
                }
            }
            for (line, flow) in printed(&loaded) {
                let off = f64::from(simulator.line_flow_kg_s(line)) / flow - 1.0;
                let name = &loaded.names.lines[line];
                assert!(off.abs() < MOST, "{}, {name}: {:+.3} %", method.name(), 100.0 * off);
            }
        })
        .expect("accepted");
    }
}
