//! Networks that cannot be solved, or never rest, by the command line: refused or told with ids and the file's lines.

use crate::common::Folder;

const METHODS: [&str; 4] = ["relaxation", "adaptive", "implicit-euler", "tr-bdf2"];

fn head(name: &str) -> String {
    let run = "[run]\nmethod = \"implicit-euler\"\nuntil = \"5s\"";
    format!("schema = 1\nname = \"{name}\"\nreference_pressure_pa = 101325.0\n{run}\n")
}

fn node(id: &str, kind: &str, rest: &str) -> String {
    let state = "pressure_pa = 101325.0\ntemperature_k = 295.15";
    format!("[[node]]\nid = \"{id}\"\nkind = \"{kind}\"\n{state}\n{rest}\n")
}

fn line(id: &str, from: &str, to: &str, element: &str) -> String {
    let elements = format!("[[line.element]]\nid = \"{id}_element\"\n{element}\n");
    format!("[[line]]\nid = \"{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n{elements}")
}

const PIPE: &str = "kind = \"pipe\"\nresistance_pa_s2_kg2 = 1000.0";
const FAN: &str = "kind = \"fan\"\nshutoff_pa = 300.0\nquadratic_pa_s2_kg2 = 13000.0";

/// Line of the text in which `part` stands first, counted from 1.
fn line_of(text: &str, part: &str) -> usize {
    text[..text.find(part).expect("the text has it")].matches('\n').count() + 1
}

#[test]
fn an_island_without_volume_and_boundary_is_refused_by_all_methods() {
    let folder = Folder::new("unrest_island");
    let mut text = head("island") + &node("cabin", "cabin", "volume_m3 = 60.0");
    text += &(node("tee_a", "junction", "") + &node("tee_b", "junction", ""));
    text += &(line("loop", "cabin", "cabin", FAN) + &line("out", "tee_a", "tee_b", FAN));
    text += &line("back", "tee_b", "tee_a", PIPE);
    std::fs::write(folder.path("island.toml"), &text).unwrap();
    let place = format!("island.toml:{}:", line_of(&text, "\"tee_a\"\nkind") + 1);
    for command in ["check", "steady", "run"] {
        for method in METHODS {
            let more: &[&str] = if command == "steady" { &[] } else { &["--method", method] };
            let (code, _, err) = folder.say(&[&[command, "island.toml"], more].concat());
            assert_eq!(code, 2, "{command} {method}: {err}");
            assert!(err.contains(&place) && err.contains("tee_a, tee_b"), "{command} {method}: {err}");
        }
    }
}

#[test]
fn fans_head_to_head_without_a_loss_are_refused_by_all_methods() {
    let folder = Folder::new("unrest_fans");
    for (loss, reason) in [("0.0", "must lie in 1e-6"), ("1e-6", "more than 1000")] {
        let (one, other) =
            (FAN.replace("13000.0", loss), FAN.replace("13000.0", loss).replace("300.0", "200.0"));
        let mut text = head("fans") + &node("cabin", "cabin", "volume_m3 = 60.0");
        text += &node("plenum", "cabin", "volume_m3 = 1.0");
        text += &(line("one", "cabin", "plenum", &one) + &line("other", "plenum", "cabin", &other));
        std::fs::write(folder.path("fans.toml"), &text).unwrap();
        for command in ["check", "steady", "run"] {
            for method in METHODS {
                let more: &[&str] = if command == "steady" { &[] } else { &["--method", method] };
                let (code, _, err) = folder.say(&[&[command, "fans.toml"], more].concat());
                let places = err.matches("fans.toml:").count();
                assert!(code == 2 && places == 2 && err.contains(reason), "{command} {method} {loss}: {err}");
            }
        }
    }
}

/// Two cabins of 0.5 m³ that a heat exchanger drains, and no supply.
fn drained() -> String {
    let drain = "kind = \"heat_exchanger\"\nresistance_pa_s2_kg2 = 14000.0\nliquid_fraction = 0.05\n\
                 separator_efficiency = 1.0";
    let mut text = head("drained").replace("5s", "600s");
    text += &(node("one", "cabin", "volume_m3 = 0.5") + &node("other", "cabin", "volume_m3 = 0.5"));
    text += &(line("dry", "one", "other", drain) + &line("back", "other", "one", FAN));
    text
}

#[test]
fn a_drained_network_is_told_and_ends_where_it_is_empty() {
    let folder = Folder::new("unrest_drained");
    let text = drained();
    std::fs::write(folder.path("drained.toml"), &text).unwrap();
    let told = format!("drained.toml:{}: no steady state: `one`, `other`", line_of(&text, "\"dry\""));
    let (code, out, _) = folder.say(&["check", "drained.toml"]);
    assert!(code == 0 && out.contains(&format!("note: {told}")) && out.contains("`dry`"), "{out}");
    let (code, out, err) = folder.say(&["steady", "drained.toml"]);
    assert!(code == 1 && out.is_empty() && err.contains(&told) && err.contains("`dry`"), "{err}");
    for method in METHODS {
        let (code, out, err) = folder.say(&["run", "drained.toml", "--method", method]);
        assert!(
            code == 1 && out.contains("DIVERGED") && out.contains("left its range"),
            "{method}: {out}{err}"
        );
    }
}

#[test]
fn a_drained_cabin_behind_a_closed_valve_is_as_drained() {
    let folder = Folder::new("unrest_vacuum");
    let valve = "kind = \"valve\"\nopen_resistance_pa_s2_kg2 = 1e5\nexponent = 2.4\nopening = 0.0";
    let mut text = drained() + &node("supply", "boundary", "");
    text += &line("feed", "supply", "one", valve);
    std::fs::write(folder.path("vacuum.toml"), &text).unwrap();
    let (code, out, _) = folder.say(&["check", "vacuum.toml"]);
    let told = format!("vacuum.toml:{}: no steady state: `one`, `other`", line_of(&text, "\"dry\""));
    assert!(code == 0 && out.contains(&format!("note: {told}")) && out.contains("`dry`"), "{out}");
    let (code, _, err) = folder.say(&["steady", "vacuum.toml"]);
    assert!(code == 1 && err.contains(&told) && err.contains("`dry`"), "{err}");
}

#[test]
fn a_source_into_a_tank_without_outlet_is_told() {
    let folder = Folder::new("unrest_source");
    let mut text = head("tank") + &node("tank", "cabin", "volume_m3 = 1.0");
    text += &(line("stir", "tank", "tank", FAN) + "[air]\n");
    text += "[[source]]\nid = \"bottle\"\nnode = \"tank\"\nnitrogen = 0.01\n";
    std::fs::write(folder.path("tank.toml"), &text).unwrap();
    let told = format!("tank.toml:{}: no steady state: source `bottle`", line_of(&text, "\"bottle\""));
    let (code, out, err) = folder.say(&["check", "tank.toml"]);
    assert!(code == 0 && out.contains(&format!("note: {told}")), "{out}{err}");
    // With an outlet there is nothing to tell.
    let open = text.clone() + &node("outside", "boundary", "") + &line("out", "tank", "outside", PIPE);
    std::fs::write(folder.path("open.toml"), open).unwrap();
    let (code, out, err) = folder.say(&["check", "open.toml"]);
    assert!(code == 0 && !out.contains("no steady state"), "{out}{err}");
}

#[test]
fn a_node_that_the_operator_slows_is_named() {
    let folder = Folder::new("unrest_slowed");
    let mut text = head("slowed") + &node("lab", "cabin", "volume_m3 = 60.0");
    text += &(node("closet", "cabin", "volume_m3 = 0.001") + &node("outside", "boundary", ""));
    text += &(line("fan", "outside", "lab", FAN) + &line("door", "lab", "closet", PIPE));
    text += &line("gap", "closet", "outside", PIPE);
    std::fs::write(folder.path("slowed.toml"), &text).unwrap();
    let (code, out, _) = folder.say(&["run", "slowed.toml", "--method", "adaptive"]);
    assert!(code == 0 && out.contains("slowed            node `closet`, φ "), "{out}");
    let (code, out, _) = folder.say(&["run", "slowed.toml", "--method", "implicit-euler"]);
    assert!(code == 0 && !out.contains("slowed  "), "{out}");
}

/// The flow to space is summed and named in a warning, line by line; a tight valve causes no warning.
#[test]
fn check_sums_what_leaks_to_space() {
    let folder = Folder::new("unrest_leaks");
    let space = node("space", "boundary", "").replace("101325.0", "0.0");
    let valve = "kind = \"relief_valve\"\ncrack_pa = 104000.0\nreseat_pa = 103000.0\ndischarge_coefficient = 0.8\n\
                 diameter_m = 0.05";
    let leak = "kind = \"leak\"\nleak_kg_d = 0.5\npressure_drop_pa = 101325.0";
    let seat = format!("{valve}\nseat_leak_kg_d = 0.25\nseat_leak_pressure_pa = 101325.0");
    for (element, sum, warns) in [(valve, "2.", false), (&seat, "7.50", true)] {
        let mut text = head("leaks") + &node("hab", "cabin", "volume_m3 = 60.0") + &space;
        text += &line("relief", "hab", "space", element);
        if warns {
            text += &line("hull", "space", "hab", leak);
        }
        std::fs::write(folder.path("leaks.toml"), &text).unwrap();
        let (code, out, err) = folder.say(&["check", "leaks.toml"]);
        assert_eq!(code, 0, "{out}{err}");
        assert!(out.contains(&format!("to space    {sum}")), "{out}");
        let warning =
            out.lines().find(|line| line.starts_with("warning") && line.contains("leave for space"));
        assert_eq!(warning.is_some(), warns, "{out}");
        assert!(
            warning.is_none_or(|line| line.contains("7.500e-1 kg/d") && line.contains("`hull`")),
            "{out}"
        );
    }
}
