//! Channels: bound to what there is, refused with their place where they are wrong, the same on host and board.

use std::path::Path;

use eclss_core::process::{Hold, Order, Port};
use eclss_core::{Health, Output, Settings, Simulator};
use eclss_network_file::{Loaded, load, parse};

const HIL: &str = include_str!("../../networks/hil.toml");
const ZOO: &str = include_str!("files/zoo.toml");

fn hil() -> Loaded {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks/hil.toml")).expect("the file loads")
}

/// Replaces `old` by `new`; the file must be refused for `reason` on the line where `new` stands.
#[track_caller]
fn spoil(old: &str, new: &str, reason: &str) {
    assert!(HIL.contains(old), "`{old}` must stand in the file");
    let text = HIL.replacen(old, new, 1);
    let Err(error) = parse(&text, "hil.toml") else { panic!("was accepted with {new}") };
    let place = HIL.find(old).unwrap();
    let line = HIL[..place].matches('\n').count() + 1;
    let found: Vec<_> = error.problems().iter().map(ToString::to_string).collect();
    let near = |problem: &String| {
        let at: usize = problem.split(':').nth(1).and_then(|line| line.parse().ok()).unwrap_or(0);
        at.abs_diff(line) <= 10 && problem.contains(reason)
    };
    assert!(found.iter().any(near), "wanted {line}: {reason}\nfound  {found:#?}");
}

#[test]
fn what_is_wrong_is_refused_at_its_place() {
    spoil("\"valve.opening\"", "\"valve.opennig\"", "there is no signal `valve.opennig`");
    spoil("bind = \"fan.speed\"", "bind = \"loop.mass_flow\"", "is no input");
    spoil("bind = \"fan.speed\"", "bind = \"valve.opening\"", "has such a channel already");
    spoil("direction = \"in\"", "direction = \"both\"", "`both` is not a direction");
    spoil("direction = \"in\"\n", "", "`direction` is missing");
    spoil("min = -0.02\n", "", "needs its range");
    spoil("max = 0.12", "max = 0.12\nhold = \"zero\"", "unknown key `hold`");
    spoil("min = 0.02", "min = -0.02", "wider than the input's own");
    spoil("min = -0.02", "min = 0.2", "`max`");
    spoil("safe_value = 0.5", "safe_value = 1.5", "`safe_value` lies outside");
    spoil("safe_value = 0.5\n", "", "`safe_value` is missing");
    spoil("stale_ticks = 30", "stale_ticks = 2.5", "must be a whole number");
    spoil("stale_ticks = 30", "stale_ticks = 0", "`stale_ticks` must lie in 1");
    spoil("safe_after_ticks = 20", "safe_after_ticks = 0", "`safe_after_ticks` must lie in 1");
    spoil("order = \"latched\"", "order = \"soon\"", "`soon` is not a order");
    spoil("loss = \"go_on\"", "loss = \"ignore\"", "`ignore` is not a loss");
    spoil("safe_value = 0.5", "scale = [[1.0, 1.0]]\nsafe_value = 0.5", "needs 2 … 256 pairs");
    spoil("safe_value = 0.5", "scale = [[1.0, 1.0], 2.0]\nsafe_value = 0.5", "is a list of pairs");
    spoil("safe_value = 0.5", "scale = [[1.0, 1.0], [1.0, 2.0]]\nsafe_value = 0.5", "`scale` lies outside");
    spoil("safe_value = 0.5", "wire = [20.0, 4.0]\nsafe_value = 0.5", "`wire` lies outside");
    spoil("safe_value = 0.5", "wire = [20.0]\nsafe_value = 0.5", "smallest and the largest");
    spoil("safe_value = 0.5", "calibration_date = \"2026-02-30\"\nsafe_value = 0.5", "is no day");
    spoil("safe_value = 0.5", "calibration_id = \"µ\"\nsafe_value = 0.5", "plain text");
    spoil("safe_value = 0.5", "analog = 64\nsafe_value = 0.5", "`analog` must lie in 0 … 15");
    let scheduled = format!("{HIL}\n[[schedule]]\ninput = \"valve.opening\"\npoints = [[0.0, 1.0]]\n");
    let error = parse(&scheduled, "hil.toml").unwrap_err().to_string();
    assert!(error.contains("no hardware can drive the input: it follows a schedule"), "{error}");
    let twice = HIL
        .replace("min = -0.02", "analog = 1\nmin = -0.02")
        .replace("min = -500.0", "analog = 1\nmin = -500.0");
    let error = parse(&twice, "hil.toml").unwrap_err().to_string();
    assert!(error.contains("another output goes to this converter"), "{error}");
}

/// Hardware may be a heater's switch or a crew's load as well as a valve, but not what a control loop drives.
#[test]
fn climates_have_inputs_for_hardware_too() {
    const THCS: &str = include_str!("../../networks/thcs.toml");
    let bound = |input: &str, safe_value: f32| {
        let channel = format!("bind = \"{input}\"\ndirection = \"in\"\nsafe_value = {safe_value}");
        parse(&format!("{THCS}\n[[channel]]\n{channel}\n"), "thcs.toml")
    };
    let loaded = bound("cold_plate.power", 0.0).expect("it is free");
    assert_eq!(loaded.process.inputs.len(), 1);
    let error = bound("che_valve.opening", 0.5).unwrap_err().to_string();
    assert!(error.contains("no hardware can drive the input: a control loop drives it"), "{error}");
}

#[test]
fn keys_become_channels_with_their_defaults() {
    let process = hil().process;
    assert_eq!((process.order, process.safe_after_ticks), (Order::Latched, 20));
    let [valve, fan] = &process.input_channels()[..] else { panic!("two inputs") };
    assert_eq!(
        (valve.hold, valve.essential, valve.stale_ticks, valve.port),
        (Hold::Linear, true, 30, Port::Link)
    );
    assert_eq!((fan.hold, fan.essential, fan.extrapolate_ticks), (Hold::Zero, false, 1));
    assert!((fan.event_step - 0.12).abs() < 1e-6 && fan.filter_s.abs() < 1e-9);
    let [flow, pressure] = &process.output_channels()[..] else { panic!("two outputs") };
    assert_eq!(flow.signal, Output::MassFlow.of(0));
    assert_eq!(pressure.signal, Output::OutletPressure.of(1));
    assert!(flow.max_rate_per_s.is_infinite());
    let zoo = parse(ZOO, "zoo").unwrap();
    let [regulator, _] = &zoo.process.input_channels()[..] else { panic!("two inputs") };
    assert_eq!((regulator.port, regulator.saturates), (Port::Analog(1), true));
    assert_eq!((regulator.scaling.calibration.id, regulator.scaling.calibration.date), ("K-17", 20_260_131));
    let count = 65_535.0 * 12.0 / 20.625;
    let engineering = regulator.scaling.engineering.forward(regulator.scaling.electrical.forward(count));
    assert!((engineering - 0.45).abs() < 1e-5);
    let [_, scrubber, hatch] = &zoo.process.output_channels()[..] else { panic!("three outputs") };
    assert_eq!(scrubber.signal, Output::SegmentFlow.of(4));
    assert_eq!(zoo.names.segments[4], "scrubber");
    assert_eq!(hatch.signal.output, Output::Input);
    assert_eq!(zoo.names.inputs[hatch.signal.owner as usize], "hatch.opening");
}

/// Every key counts for the id of the image, so that two ends that disagree about one never talk.
#[test]
fn every_value_counts_for_the_id_of_the_image() {
    let id = |text: &str| parse(text, "zoo").expect("the file is right").process.id();
    let original = id(ZOO);
    for (old, new) in [
        ("\"immediate\"", "\"latched\""),
        ("safe_after_ticks = 50", "safe_after_ticks = 51"),
        ("analog = 1", "analog = 2"),
        ("20.625", "20.626"),
        ("[12.0, 0.45]", "[12.0, 0.46]"),
        ("wire = [3.6, 20.5]", "wire = [3.5, 20.5]"),
        ("K-17", "K-18"),
        ("2026-01-31", "2026-01-30"),
        ("\"limit\"", "\"reject\""),
        ("max_rate_per_s = 20.0", "max_rate_per_s = 21.0"),
        ("filter_s = 0.01", "filter_s = 0.02"),
        ("\"linear\"\nextrapolate", "\"zero\"\nextrapolate"),
        ("extrapolate_ticks = 3", "extrapolate_ticks = 4"),
        ("event_step = 0.2", "event_step = 0.3"),
        ("stale_ticks = 30", "stale_ticks = 31"),
        ("safe_value = 0.25", "safe_value = 0.26"),
        ("safe_rate_per_s = 0.5", "safe_rate_per_s = 0.6"),
        ("loss = \"go_on\"", "loss = \"safe\""),
        ("bind = \"scrubber.mass_flow\"", "bind = \"hatch.mass_flow\""),
        ("max = 5000.0", "max = 5001.0"),
    ] {
        assert_eq!(ZOO.matches(old).count(), 1, "{old}");
        assert_ne!(id(&ZOO.replace(old, new)), original, "{old}");
    }
    assert_eq!(id(&ZOO.replace("One of each", "Each of one")), original);
}

/// The steady start is one: once the pressures inside the line have found their places, which takes ten seconds of
/// INIT, nothing that an output carries moves by a ten-thousandth of its range, and the flow is the paper's.
#[test]
fn a_steady_start_stands_still() {
    let loaded = hil();
    let network = loaded.network();
    let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = eclss_core::Buffers {
        state: &mut state,
        work: &mut work,
        inputs: &mut inputs,
        cursors: &mut cursors,
    };
    let mut simulator = Simulator::new(&network, settings, buffers).expect("the file was checked");
    let values = |simulator: &Simulator<'_>| [simulator.line_flow_kg_s(0), simulator.outlet_gauge_pa(0, 1)];
    assert!((simulator.line_flow_kg_s(0) - 0.086_477_6).abs() < 1e-6);
    (0..10_000).for_each(|_| assert_eq!(simulator.step(), Health::Trusted));
    let start = values(&simulator);
    assert!((start[0] - 0.086_477_6).abs() < 1e-5, "{start:?}");
    for _ in 0..5_000 {
        assert_eq!(simulator.step(), Health::Trusted);
        for ((now, start), channel) in
            values(&simulator).into_iter().zip(start).zip(loaded.process.output_channels())
        {
            assert!((now - start).abs() < 1e-4 * (channel.max - channel.min), "{now} was {start}");
        }
    }
}

#[test]
fn a_network_that_never_rests_has_no_steady_start() {
    let paper = include_str!("../../networks/paper.toml");
    let error = parse(&paper.replace("[run]", "[run]\nstart = \"steady\""), "paper.toml").unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("paper.toml:16:9: no steady state: `cabin` have no boundary"), "{text}");
}
