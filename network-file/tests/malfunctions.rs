//! Every component can go wrong: each malfunction is an input that is there, follows a schedule, is commanded live, and
//! acts. The table here is the one of `docs/network-file.md`.

use crate::support::signal;
use std::collections::BTreeSet;

use crate::support::with_network;
use eclss_core::fluid::medium::{CARBON_DIOXIDE, OXYGEN};
use eclss_core::{Health, Simulator};
use eclss_network_file::{Loaded, parse};

const FILE: &str = include_str!("files/malfunctions.toml");
const REFERENCE: &str = include_str!("../../docs/network-file.md");

/// Where a malfunction shows.
#[derive(Debug, Clone, Copy)]
enum Shows {
    Flow(&'static str),
    Temperature(&'static str),
    Partial(&'static str, usize),
    Humidity(&'static str),
    Liquid(&'static str),
    Input(&'static str),
    Signal(&'static str),
}
use Shows::*;

impl Shows {
    fn read(self, loaded: &Loaded, simulator: &Simulator<'_>) -> f32 {
        let index = |list: &[String], id: &str| list.iter().position(|name| name == id).expect(id);
        let air = |id: &str| simulator.air(index(&loaded.names.nodes, id)).expect(id);
        match self {
            Flow(line) => simulator.line_flow_kg_s(index(&loaded.names.lines, line)),
            Temperature(node) => simulator.node_temperature_k(index(&loaded.names.nodes, node)),
            Partial(node, part) => air(node).partial_pa[part],
            Humidity(node) => air(node).relative_humidity,
            Liquid(node) => air(node).liquid_kg,
            Input(name) => simulator.inputs()[index(&loaded.names.inputs, name)],
            Signal(name) => signal(loaded, simulator, name),
        }
    }
}

/// Kind of component, its id and input, the value of the malfunction, where it shows, and whether that rises.
type Row = (&'static str, &'static str, f32, Shows, bool);

const ROWS: [Row; 50] = [
    ("pipe", "filter.opening", 0.1, Flow("loop"), false),
    // Elements that cannot be blocked have a hatch beside them.
    ("reference_pipe", "screen_blockage.opening", 0.02, Flow("loop"), false),
    ("valve", "damper.opening", 0.1, Flow("side"), true),
    ("fan", "fan.speed", 0.0, Flow("loop"), false),
    ("fan", "fan.speed", 0.7, Flow("loop"), false),
    ("pump", "pump.speed", 0.0, Flow("pumped"), false),
    ("condenser", "coil.opening", 0.1, Flow("loop"), false),
    ("condenser", "coil.fouling", 0.9, Signal("coil.heat"), false),
    ("condenser", "coil.separator_efficiency", 0.0, Liquid("plenum"), true),
    ("condenser", "coil.discharge", 0.0, Signal("coil.tank"), false),
    ("coolant_side", "coolant.opening", 0.02, Signal("coil.coolant_heat"), false),
    ("interface_exchanger", "interface.opening", 0.02, Flow("back"), false),
    ("interface_exchanger", "interface.fouling", 0.9, Temperature("tank"), true),
    ("interface_exchanger", "interface.coolant_flow", 0.0, Temperature("tank"), true),
    ("interface_exchanger", "interface.coolant_temperature", 290.0, Temperature("tank"), true),
    ("heater", "heater.power", 0.0, Temperature("cabin"), false),
    ("heater", "heater.opening", 0.1, Flow("return"), false),
    ("measured", "hardware.measured_flow", 0.002, Flow("rig"), true),
    ("orifice", "hole.opening", 1.0, Flow("port"), true),
    ("leak", "crack.opening", 1.0, Flow("hull"), true),
    ("check_valve", "flapper.fault", 2.0, Flow("intake"), false),
    ("relief_valve", "relief.fault", 2.0, Flow("overboard"), true),
    ("pressure_regulator", "regulator.fault", 2.0, Flow("makeup"), true),
    ("hatch", "door.opening", 0.05, Flow("return"), false),
    ("accumulator", "tank_leak.opening", 1.0, Flow("spill"), true),
    ("source", "load.heat", 5_000.0, Temperature("cabin"), true),
    ("source", "load.nitrogen", -2e-4, Partial("cabin", 0), false),
    ("source", "load.oxygen", -2e-4, Partial("cabin", OXYGEN), false),
    ("source", "load.carbon_dioxide", 2e-4, Partial("cabin", CARBON_DIOXIDE), true),
    ("source", "load.vapour", 2e-4, Humidity("cabin"), true),
    ("source", "load.trace", 2e-4, Partial("cabin", 4), true),
    ("source", "load.liquid", 2e-4, Liquid("cabin"), true),
    ("crew", "crew.count", 12.0, Partial("cabin", CARBON_DIOXIDE), true),
    ("crew", "crew.activity", 3.0, Humidity("cabin"), true),
    ("remover", "scrubber.air_flow", 0.0, Partial("cabin", CARBON_DIOXIDE), true),
    ("remover", "scrubber.efficiency", 0.0, Partial("cabin", CARBON_DIOXIDE), true),
    ("wall", "shell.outside", 250.0, Temperature("cabin"), false),
    ("control", "warmth.setpoint", 290.0, Input("flap.opening"), true),
    ("control", "warmth.sensor_bias", 3.0, Input("flap.opening"), true),
    ("control", "warmth.sensor_fault", 2.0, Input("flap.opening"), false),
    ("control", "warmth.actuator_fault", 2.0, Input("flap.opening"), true),
    ("control", "warmth.actuator_fault", 3.0, Input("flap.opening"), false),
    ("control", "oxygen.setpoint", 30_000.0, Partial("cabin", OXYGEN), true),
    ("control", "oxygen.sensor_bias", -15_000.0, Input("gases.oxygen"), true),
    ("control", "oxygen.sensor_fault", 2.0, Input("gases.oxygen"), true),
    ("control", "oxygen.actuator_fault", 2.0, Input("gases.oxygen"), true),
    ("condenser", "own.coolant_flow", 0.0, Signal("own.coolant_heat"), false),
    ("condenser", "own.coolant_temperature", 290.0, Signal("own.coolant_heat"), false),
    ("heat_exchanger", "beside.opening", 0.02, Flow("loop"), false),
    ("bed", "beside.opening", 0.02, Flow("loop"), false),
];

/// A condenser with coolant from outside.
const OWN_COOLANT: &str = r#"
schema = 1
name = "own"
reference_pressure_pa = 101325.0
[run]
method = "adaptive"
step = "50ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 20.0
pressure_pa = 101325.0
temperature_k = 298.15
dew_point_k = 285.0
[[line]]
id = "loop"
from = "cabin"
to = "cabin"
[[line.element]]
id = "fan"
kind = "fan"
shutoff_pa = 400.0
quadratic_pa_s2_kg2 = 9000.0
[[line.element]]
id = "own"
kind = "condenser"
resistance_pa_s2_kg2 = 3000.0
coolant_flow = 0.07 # own.coolant_flow
coolant_temperature = 278.0 # own.coolant_temperature
"#;

/// What takes out a fixed share is for networks of flows only.
const FIXED_SHARES: &str = r#"
schema = 1
name = "shares"
reference_pressure_pa = 101325.0
[run]
method = "adaptive"
step = "50ms"
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 20.0
pressure_pa = 101325.0
temperature_k = 298.15
[[line]]
id = "loop"
from = "cabin"
to = "cabin"
[[line.element]]
id = "fan"
kind = "fan"
shutoff_pa = 400.0
quadratic_pa_s2_kg2 = 9000.0
[[line.element]]
id = "exchanger"
kind = "heat_exchanger"
resistance_pa_s2_kg2 = 3000.0
liquid_fraction = 0.005
separator_efficiency = 0.9
[[line.element]]
id = "sorbent"
kind = "bed"
resistance_pa_s2_kg2 = 3000.0
mass_fraction = 0.006
capture_efficiency = 0.8
[[line.element]]
id = "beside"
kind = "hatch"
resistance_pa_s2_kg2 = 100.0
"#;

fn text_of(input: &str) -> &'static str {
    match input.split('.').next() {
        Some("own") => OWN_COOLANT,
        Some("beside") => FIXED_SHARES,
        _ => FILE,
    }
}

/// Steps before the malfunction, and with it.
const BEFORE: u64 = 400;
const WITH: u64 = 800;

fn slot(loaded: &Loaded, input: &str) -> usize {
    loaded.names.inputs.iter().position(|name| name == input).unwrap_or_else(|| panic!("no input {input}"))
}

/// What shows without a malfunction.
fn sound(text: &str, shows: Shows) -> f32 {
    with_network(text, |loaded, simulator| {
        assert_eq!(simulator.step_times(BEFORE + WITH), Health::Trusted);
        shows.read(loaded, simulator)
    })
}

fn live(text: &str, input: &str, value: f32, shows: Shows) -> f32 {
    with_network(text, |loaded, simulator| {
        simulator.step_times(BEFORE);
        simulator.set_input(slot(loaded, input), value).unwrap_or_else(|error| panic!("{input}: {error}"));
        assert_eq!(simulator.step_times(WITH), Health::Trusted, "{input}");
        shows.read(loaded, simulator)
    })
}

/// The file with a schedule for an input in place of its start value.
fn with_schedule(text: &str, input: &str, value: f32) -> String {
    let normal = with_network(text, |loaded, _| loaded.inputs[slot(loaded, input)]);
    let mark = format!("# {input}");
    let kept: Vec<_> = text.lines().filter(|line| !line.ends_with(&mark)).collect();
    let at = 0.05 * BEFORE as f64;
    let points = format!("points = [[0.0, {normal:?}], [{at}, {normal:?}], [{at}, {value:?}]]");
    format!("{}\n[[schedule]]\ninput = \"{input}\"\ninterpolation = \"hold\"\n{points}\n", kept.join("\n"))
}

#[test]
fn every_malfunction_is_an_input_that_acts_live_and_by_schedule() {
    for (kind, input, value, shows, rises) in ROWS {
        let text = text_of(input);
        let sound = sound(text, shows);
        let failed = live(text, input, value, shows);
        let change = if rises { failed - sound } else { sound - failed };
        assert!(change > 1e-4 * sound.abs() + 1e-7, "{kind} {input} = {value}: {sound}, failed {failed}");
        let scheduled = with_network(&with_schedule(text, input, value), |loaded, simulator| {
            assert_eq!(simulator.step_times(BEFORE + WITH), Health::Trusted, "{input}");
            shows.read(loaded, simulator)
        });
        // Implicit steps see a scheduled jump at the step's end.
        let close = 0.02 * change;
        assert!((scheduled - failed).abs() <= close, "{kind} {input}: live {failed}, scheduled {scheduled}");
    }
}

/// `kind` and `input` of every row of the reference's table of malfunctions.
fn documented() -> BTreeSet<(String, String)> {
    let start = REFERENCE.find("### Malfunctions").expect("a table of malfunctions");
    let table = REFERENCE[start..].lines().skip_while(|line| !line.starts_with("| `"));
    let mut list = BTreeSet::new();
    for line in table.take_while(|line| line.starts_with('|')) {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let words =
            |cell: &str| -> Vec<String> { cell.split('`').skip(1).step_by(2).map(str::to_owned).collect() };
        for kind in words(cells[1]) {
            list.extend(words(cells[3]).into_iter().map(|input| (kind.clone(), input)));
        }
    }
    list
}

#[test]
fn the_reference_lists_them_and_no_kind_is_left_out() {
    let tested: BTreeSet<_> = ROWS
        .iter()
        .map(|(kind, input, ..)| ((*kind).to_owned(), input.split('.').nth(1).unwrap().to_owned()))
        .collect();
    assert_eq!(documented(), tested);
    let error = parse(&FILE.replacen("kind = \"fan\"", "kind = \"?\"", 1), "x").unwrap_err();
    let help = error.problems()[0].help.clone().expect("the list of kinds");
    for kind in help.split_once("kind is one of ").expect("the list of kinds").1.split(", ") {
        assert!(tested.iter().any(|(tested, _)| tested == kind.trim()), "no malfunction of a {kind}");
    }
}

/// A valve that acts by itself, stuck and closed when it should open.
#[test]
fn valves_that_should_open_stay_as_their_fault_has_them() {
    let crack = FILE.replacen(
        "crack_pa = 104000.0\nreseat_pa = 103000.0",
        "crack_pa = 90000.0\nreseat_pa = 80000.0",
        1,
    );
    let feed = FILE.replacen("set_point_pa = 100000.0", "set_point_pa = 120000.0", 1);
    let forward = FILE.replacen("pressure_pa = 101600.0", "pressure_pa = 90000.0", 1);
    for (text, input, line) in [
        (&crack, "relief.fault", "overboard"),
        (&feed, "regulator.fault", "makeup"),
        (&forward, "flapper.fault", "intake"),
    ] {
        let open = sound(text, Flow(line));
        let closed = live(text, input, 3.0, Flow(line));
        assert!(closed < 0.01 * open && open > 1e-4, "{input}: {open}, closed {closed} kg/s");
        let stuck = live(text, input, 1.0, Flow(line));
        assert!((stuck / open - 1.0).abs() < 0.05, "{input}: {open}, stuck {stuck} kg/s");
    }
}
