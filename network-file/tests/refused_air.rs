//! What could be built of heat, air and control and would make no sense is refused by id, at its line.

use eclss_network_file::parse;

const FILE: &str = include_str!("../../networks/thcs.toml");

/// Replaces the first `old` by `new`; the file must be refused for `reason` in the line of `at`.
#[track_caller]
fn spoil(old: &str, new: &str, at: &str, reason: &str) {
    assert!(FILE.contains(old), "`{old}` must stand in the file");
    let text = FILE.replacen(old, new, 1);
    let line = text[..text.find(at).expect(at)].matches('\n').count() + 1;
    let Err(error) = parse(&text, "thcs.toml") else { panic!("was accepted: {new}") };
    let found: Vec<_> = error.problems().iter().map(ToString::to_string).collect();
    let start = format!("thcs.toml:{line}:");
    assert!(
        found.iter().any(|problem| problem.starts_with(&start) && problem.contains(reason)),
        "wanted {start} {reason}\nfound  {found:#?}"
    );
}

#[test]
fn controls_that_make_no_sense() {
    let drives = "drives = \"gases.oxygen\"";
    let own = "drives = \"oxygen_control.setpoint\"";
    spoil(drives, own, own, "`oxygen_control.setpoint` is an input of this control itself");
    let opposite = "opposite = \"equipment.heat\"";
    spoil("opposite = \"bypass_valve.opening\"", opposite, opposite, "`opposite` one in W");
    spoil("open = -8000.0", "open = 0.0", "open = 0.0", "`closed` and `open` are the same");
    spoil("setpoint = 101325.0", "setpoint = 3e5", "setpoint = 3e5", "lies outside what the sensor reads");
    spoil(
        "sensor_max = 323.0",
        "sensor_max = 200.0",
        "sensor_max = 200.0",
        "`sensor_max` must lie above `sensor_min`",
    );
    spoil("gain = -0.2", "gain = 0.0", "gain = 0.0", "`gain` must not be 0");
}

#[test]
fn codes_that_are_no_codes() {
    let first = "[[schedule]]\n";
    let fault =
        |rest: &str| format!("[[schedule]]\ninput = \"cabin_temperature.sensor_fault\"\n{rest}\n\n{first}");
    let points = "points = [[0.0, 0.0], [10.0, 2.0]]";
    let at = "input = \"cabin_temperature.sensor_fault\"";
    spoil(first, &fault(points), at, "is a code, which has no values between two");
    let half = "interpolation = \"hold\"\npoints = [[0.0, 0.0], [10.0, 1.5]]";
    spoil(first, &fault(half), "points = [[0.0, 0.0], [10.0, 1.5]]", "is a code, 1.5 is no whole number");
    let good = FILE.replacen(first, &fault(&format!("interpolation = \"hold\"\n{points}")), 1);
    assert!(parse(&good, "thcs.toml").is_ok());
}

#[test]
fn parts_where_they_do_nothing() {
    let equipment = "id = \"equipment\"\nnode = \"cabin\"";
    let space = "id = \"equipment\"\nnode = \"space\"";
    let text = FILE.replacen(equipment, space, 1);
    let at = text.find(space).unwrap();
    let line = text[..at].matches('\n').count() + 2;
    let Err(error) = parse(&text, "thcs.toml") else { panic!("was accepted") };
    let found: Vec<_> = error.problems().iter().map(ToString::to_string).collect();
    assert!(
        found.iter().any(|problem| problem.starts_with(&format!("thcs.toml:{line}:"))
            && problem.contains("`space` is a boundary")),
        "{found:#?}"
    );
    let first = "[[schedule]]\n";
    let flow = format!("[[schedule]]\ninput = \"che.coolant_flow\"\npoints = [[0.0, 0.1]]\n\n{first}");
    spoil(first, &flow, "input = \"che.coolant_flow\"", "`che` has a coolant side");
}

#[test]
fn temperatures_that_are_not_followed() {
    let hot = "temperature_k = 395.3";
    spoil("temperature_k = 295.35", hot, hot, "200 … 395.15 K");
    spoil(
        "temperature_k = 277.5",
        "temperature_k = 270.0",
        "temperature_k = 270.0",
        "freezes below 273.15 K",
    );
    assert!(
        parse(&FILE.replacen("temperature_k = 295.35", "temperature_k = 395.15", 1), "thcs.toml").is_ok()
    );
}

#[test]
fn a_bound_that_the_step_sets_is_told_as_a_number() {
    let weak = "capacity_j_k = 0.5";
    spoil("capacity_j_k = 1e6", weak, weak, "`capacity_j_k` must be at least 0.6200 J/K for a step of 10 ms");
}

/// A control of the dew point that drives the set point of the one of the temperature.
const OUTER: &str = "[[control]]\nid = \"outer\"\nmeasures = \"cabin.dew_point\"\nkind = \"thermostat\"\nhalf_band = 1.0\n\
                     on_when = \"high\"\ndrives = \"cabin_temperature.setpoint\"\nclosed = 295.0\nopen = 294.0\n\
                     sensor_min = 200.0\nsensor_max = 400.0\nsetpoint = 283.0\n\n";

#[test]
fn cascades_that_make_no_sense() {
    let first = "[[control]]\n";
    let cascade = |old: &str, new: &str| format!("{}{first}", OUTER.replace(old, new));
    spoil(first, &cascade("closed = 295.0", "closed = 1e3"), "closed = 1e3", "its sensor reads 273 … 323");
    let opposite = "opposite = \"oxygen_control.setpoint\"\n";
    let both = cascade("closed = 295.0", &format!("{opposite}closed = 295.0"));
    spoil(first, &both, opposite, "`drives` takes a value in K, `opposite` one in Pa");
    let ring = FILE.replacen("drives = \"che_valve.opening\"", "drives = \"outer.setpoint\"", 1);
    let Err(error) = parse(&ring.replacen(first, &cascade("", ""), 1), "thcs.toml") else {
        panic!("a ring was accepted")
    };
    let reason = "`outer` drives its own set point in the end, through others";
    assert!(error.problems().iter().any(|problem| problem.to_string().contains(reason)), "{error}");
}

#[test]
fn a_control_may_drive_the_set_point_of_another_wherever_that_stands() {
    let (first, last) = ("[[control]]\n", "[[schedule]]\n");
    for before in [first, last] {
        let text = FILE.replacen(before, &format!("{OUTER}{before}"), 1);
        if let Err(error) = parse(&text, "thcs.toml") {
            panic!(
                "before {before}: {:#?}",
                error.problems().iter().map(ToString::to_string).collect::<Vec<_>>()
            );
        }
    }
}
