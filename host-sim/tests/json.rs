//! `eclss-rt run --json`: what other programs read.

use crate::common::Folder;
use serde_json::Value;

fn run(folder: &Folder, arguments: &[&str]) -> (i32, Value) {
    let (code, out, err) = folder.say(arguments);
    let value = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}{err}"));
    assert!(err.is_empty(), "{err}");
    (code, value)
}

fn valve_g_s(snapshot: &Value) -> f64 {
    snapshot["flows_kg_s"]["valve"].as_f64().unwrap() * 1e3
}

#[test]
fn the_papers_flows_are_in_the_json() {
    let folder = Folder::new("json_paper");
    let (code, report) = run(&folder, &["run", "--at", "10s,20s,26s", "--json"]);
    assert_eq!(code, 0);
    assert_eq!(report["method"], "relaxation");
    assert!((report["step_s"].as_f64().unwrap() - 0.001).abs() < 1e-12);
    assert_eq!(report["diverged"], Value::Null);
    let at = report["at"].as_array().unwrap();
    for (snapshot, (time, flow, bar)) in
        at.iter().zip([(10.0, 86.4784, 5e-4), (20.0, 4.0455, 5e-4), (26.0, 4.0593, 3e-4)])
    {
        assert!((snapshot["t_s"].as_f64().unwrap() - time).abs() < 1e-12);
        assert!((valve_g_s(snapshot) - flow).abs() < bar, "{time} s: {}", valve_g_s(snapshot));
        for id in ["loop", "intake", "fan", "fan_duct", "che", "supply", "valve"] {
            assert!(snapshot["flows_kg_s"][id].is_number(), "{id}");
        }
        for id in ["cabin", "intake", "fan", "fan_duct", "che", "supply", "valve"] {
            let absolute = snapshot["pressures_pa"][id].as_f64().unwrap();
            let gauge = snapshot["gauge_pa"][id].as_f64().unwrap();
            assert!((absolute - gauge - 101_325.0).abs() < 1e-4, "{id}");
        }
        let phi = snapshot["phi_min"].as_f64().unwrap();
        assert!(phi > 0.0 && phi <= 1.0);
        assert_eq!(snapshot["state_hash"].as_str().unwrap().len(), 16);
        assert_eq!(snapshot["health"], "trusted");
    }
    assert_eq!(at.len(), 3);
    assert_eq!(report["network_id"].as_str().unwrap().len(), 16);
    // With --json nothing is written unless a folder is named.
    assert!(!folder.path("results").exists());
}

#[test]
fn the_same_run_gives_the_same_hash_and_another_step_another() {
    let folder = Folder::new("json_hash");
    let hash = |step: &str| {
        let (_, report) = run(&folder, &["run", "--step", step, "--until", "1s", "--json"]);
        report["end"]["state_hash"].as_str().unwrap().to_owned()
    };
    assert_eq!(hash("1ms"), hash("1000us"));
    assert_ne!(hash("1ms"), hash("10ms"));
}

#[test]
fn a_diverged_run_is_reported_completely_and_fails() {
    let folder = Folder::new("json_diverged");
    for (step, bars) in [("1ms", 10.85..11.0), ("10ms", 10.7..11.0)] {
        let arguments = ["run", "--method", "euler", "--step", step, "--at", "10s,20s", "--json"];
        let (code, report) = run(&folder, &arguments);
        assert_eq!(code, 1);
        assert_eq!(report["at"].as_array().unwrap().len(), 1, "only what was reached");
        assert_eq!(report["end"]["health"], "diverged");
        let diverged = &report["diverged"];
        assert!(bars.contains(&diverged["t_s"].as_f64().unwrap()), "{diverged}");
        assert!(diverged["tick"].as_u64().unwrap() > 0);
        assert_eq!((&diverged["id"], &diverged["element"]), (&"loop".into(), &"valve".into()));
    }
}

#[test]
fn every_method_comes_to_the_same_steady_flow() {
    let folder = Folder::new("json_methods");
    for method in ["relaxation", "adaptive", "implicit-euler", "tr-bdf2"] {
        let (code, report) = run(&folder, &["run", "--method", method, "--at", "10s", "--json"]);
        assert_eq!(code, 0, "{method}");
        let flow = valve_g_s(&report["at"][0]);
        assert!((flow - 86.4776).abs() < 2e-3, "{method}: {flow}");
    }
}

#[test]
fn several_lines_and_nodes_are_reported_by_id() {
    let folder = Folder::new("json_two");
    std::fs::write(folder.path("two.toml"), include_str!("two_cabins.toml")).unwrap();
    let (code, report) = run(&folder, &["run", "two.toml", "--at", "0s,30s", "--json", "--out", "out"]);
    assert_eq!(code, 0);
    let at = &report["at"][1];
    let flow = |id: &str| at["flows_kg_s"][id].as_f64().unwrap();
    // What comes through the valve goes back through the hatch, but for what the leak takes.
    assert!((flow("imv") - flow("hatch")).abs() < 1e-3 * flow("imv"), "{at}");
    assert!(flow("leak") > 0.0 && flow("leak") < 1e-4);
    let pressure = |id: &str| at["pressures_pa"][id].as_f64().unwrap();
    assert!(pressure("imv_fan") > pressure("lab") && pressure("imv_valve") < pressure("imv_fan"));
    assert!((pressure("imv_duct") - pressure("node1")).abs() < 1e-9, "the last outlet is the node");
    assert!(pressure("vacuum").abs() < 1e-9);
    assert!(folder.path("out/run_adaptive.csv").exists());
    let (code, _, err) = folder.say(&["stability", "two.toml"]);
    assert!(code == 2 && err.contains("method `adaptive` does not step"), "{err}");
    let (code, out, _) = folder.say(&["stability", "two.toml", "--method", "relaxation", "--step", "1ms"]);
    assert!(code == 0 && out.contains("line `imv`, input `imv_valve.opening`"), "{out}");
    assert!(!out.contains("line `hatch`"), "a line without inputs has nothing to sweep: {out}");
}

/// The signals that `signals` lists for a network without `record` are those that a run writes, as columns and in the JSON.
#[test]
fn the_list_of_signals_is_what_a_run_writes() {
    let folder = Folder::new("json_signals");
    let thcs = concat!(env!("CARGO_MANIFEST_DIR"), "/../networks/thcs.toml");
    let text = std::fs::read_to_string(thcs).unwrap();
    let (head, rest) = text.split_once("record = [").unwrap();
    let (_, rest) = rest.split_once("\n]\n").unwrap();
    std::fs::write(folder.path("all.toml"), format!("{head}{rest}")).unwrap();
    let (code, list) = run(&folder, &["signals", "all.toml", "--json"]);
    assert_eq!(code, 0);
    let listed = list["signals"].as_array().unwrap();
    let standard = || listed.iter().filter(|row| row["standard"] == true);
    let (code, report) = run(&folder, &["run", "all.toml", "--until", "100ms", "--out", "out", "--json"]);
    assert_eq!(code, 0);
    let csv = std::fs::read_to_string(folder.path("out/run_implicit-euler.csv")).unwrap();
    let columns: Vec<_> = csv.lines().next().unwrap().split(',').skip(1).collect();
    assert_eq!(columns, standard().map(|row| row["column"].as_str().unwrap()).collect::<Vec<_>>());
    assert!(columns.contains(&"cabin.pressure_gauge_pa") && columns.contains(&"cabin.total_pressure_pa"));
    let last = report["at"].as_array().unwrap().last().unwrap();
    let row: Vec<_> = csv.lines().last().unwrap().split(',').skip(1).collect();
    for (signal, cell) in standard().zip(row) {
        let name = signal["name"].as_str().unwrap();
        let owner = name.rsplit_once('.').map_or(name, |(owner, _)| owner);
        let value = ["flows_kg_s", "gauge_pa"].map(|key| &last[key][owner]);
        let value = match signal["display"].as_str().unwrap() {
            "gauge_pressure" => value[1],
            "mass_flow" if name.ends_with(".mass_flow") => value[0],
            _ if name == "phi" => &last["phi_min"],
            _ if name == "spectral_bound" => &last[name],
            _ => ["inputs", "climate"]
                .map(|key| &last[key][name])
                .into_iter()
                .find(|v| !v.is_null())
                .unwrap_or(&Value::Null),
        };
        let [value, cell] =
            [value.as_f64(), cell.parse::<f64>().ok()].map(|number| number.map(|number| number as f32));
        assert_eq!(value, cell, "{name}");
    }
    let (code, text, _) = folder.say(&["signals", "all.toml"]);
    assert_eq!((code, text.lines().count()), (0, listed.len()));
    assert!(
        text.lines()
            .any(|line| line.starts_with("cabin.pressure ") && line.ends_with("Pa     gauge pressure")),
        "{text}"
    );
}
