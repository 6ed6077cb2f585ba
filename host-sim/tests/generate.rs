//! `generate` and `steady`: what is made up is accepted, runs, and comes to the rest that is computed for it.

use crate::common::Folder;
use serde_json::Value;

/// Runs the program and reads what it says.
fn json(folder: &Folder, arguments: &[&str]) -> Value {
    let (code, out, err) = folder.say(arguments);
    assert_eq!(code, 0, "{arguments:?}: {err}");
    serde_json::from_str(&out).expect("JSON")
}

#[test]
fn every_shape_runs_with_adaptive_and_tr_bdf2() {
    for shape in ["chain", "star", "tree", "mesh"] {
        let folder = Folder::new(&format!("generate_{shape}"));
        let (code, out, err) =
            folder.say(&["generate", shape, "--nodes", "50", "--seed", "3", "-o", "made.toml"]);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains("made.toml, 50 nodes"), "{out}");
        let (code, _, err) = folder.say(&["check", "made.toml"]);
        assert_eq!(code, 0, "{err}");
        for method in ["adaptive", "tr-bdf2"] {
            json(&folder, &["run", "made.toml", "--method", method, "--until", "15s", "--json"]);
        }
    }
}

#[test]
fn methods_come_to_the_rest_that_is_computed() {
    let folder = Folder::new("generate_rest");
    for shape in ["chain", "star", "tree", "mesh"] {
        let (code, text, err) = folder.say(&["generate", shape, "--nodes", "12"]);
        assert_eq!(code, 0, "{err}");
        let held = text.split("[[schedule]]").next().expect("a beginning");
        std::fs::write(folder.path("made.toml"), held).expect("a file");
        let rest = json(&folder, &["steady", "made.toml", "--json"]);
        let lines = rest["lines"].as_array().expect("lines");
        let flow = |line: &Value| line["mass_flow_kg_s"].as_f64().expect("a number");
        let most = lines.iter().map(|line| flow(line).abs()).fold(0.0, f64::max);
        for method in ["adaptive", "tr-bdf2"] {
            let run =
                ["run", "made.toml", "--method", method, "--step", "10ms", "--until", "10min", "--json"];
            let flows = &json(&folder, &run)["at"][0]["flows_kg_s"];
            for line in lines {
                let id = line["id"].as_str().expect("an id");
                let off = (flows[id].as_f64().expect("a flow") - flow(line)).abs() / most;
                assert!(off < 1e-4, "{shape}, {method}, {id}: {off:.1e} of the largest flow");
            }
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_file_and_without_a_file_it_is_printed() {
    let folder = Folder::new("generate_printed");
    let say = |seed: &str| {
        let (code, out, err) = folder.say(&["generate", "tree", "--nodes", "9", "--seed", seed]);
        assert_eq!(code, 0, "{err}");
        out
    };
    assert!(say("1").starts_with("schema = 1"));
    assert_eq!(say("1"), say("1"));
    assert_ne!(say("1"), say("2"));
}

#[test]
fn wrong_shapes_and_sizes_are_usage() {
    let folder = Folder::new("generate_wrong");
    for (arguments, reason) in [
        (["generate", "knot", "--nodes", "9"], "there are chain, star, tree, mesh, ring, modules"),
        (["generate", "ring", "--nodes", "1"], "at least 2 nodes"),
        (["generate", "star", "--nodes", "2"], "at least 3 nodes"),
        (["generate", "mesh", "--nodes", "99999"], "at most 16384 nodes"),
    ] {
        let (code, _, err) = folder.say(&arguments);
        assert!(code == 2 && err.contains(reason), "{arguments:?}: {code} {err}");
    }
}

#[test]
fn steady_balances_every_module() {
    let folder = Folder::new("steady_balance");
    let (code, _, err) = folder.say(&["generate", "mesh", "--nodes", "30", "-o", "made.toml"]);
    assert_eq!(code, 0, "{err}");
    let (code, out, err) = folder.say(&["steady", "made.toml", "--json"]);
    assert_eq!(code, 0, "{err}");
    let report: Value = serde_json::from_str(&out).expect("JSON");
    let nodes = report["nodes"].as_array().expect("nodes");
    // The first node is the supply and the last the exhaust.
    for node in &nodes[1..29] {
        let id = &node["id"];
        let flow = |line: &Value| line["mass_flow_kg_s"].as_f64().expect("a number");
        let lines = report["lines"].as_array().expect("lines").iter();
        let net: f64 = lines
            .map(|line| {
                let (into, out_of) = (&line["to"] == id, &line["from"] == id);
                flow(line) * (f64::from(u8::from(into)) - f64::from(u8::from(out_of)))
            })
            .sum();
        assert!(net.abs() < 1e-9, "{id}: {net} kg/s");
    }
    let (code, out, err) = folder.say(&["steady", "made.toml"]);
    assert!(code == 0 && out.contains("flow [g/s]"), "{err}");
}
