//! Hardware in the loop over a real byte stream: an emulated board's serial line, with a controller on the host, with
//! the plant on the host, and with the client in Python. Every frame is accounted for on both sides.
//!
//! `ECLSS_HIL_SECONDS=60` makes the plant run for so many seconds.

use std::process::Command;

use crate::emulator::{Run, linked};
use crate::wire::{Wire, network, socket};
use eclss_core::mode::{Mode, Request};
use eclss_core::process::{InputState, OutputState, Process};
use eclss_core::protocol::{Command as LinkCommand, Outcome, Outgoing, Role};
use eclss_core::{Health, LiveInput, Method};
use eclss_target::controller::{Controller, FLOW};
use eclss_tests::product::with_simulator;

/// Seconds that the plant needs to settle, at most, before it can be armed.
const SETTLING_S: u32 = 12;

/// Packets that may be under way when the emulator stops: what its board's buffer, its own and the socket hold.
const UNDER_WAY: u32 = 60;

/// Seconds of plant time in RUN.
fn seconds() -> u32 {
    std::env::var("ECLSS_HIL_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(12)
}

/// Numbers behind these words in the last line that has the first of them.
fn last(run: &Run, words: &[&str]) -> Vec<u32> {
    let line = run.log.iter().rev().find(|line| line.contains(words[0]));
    let line = line.unwrap_or_else(|| panic!("no `{}` in\n{}", words[0], run.log.join("\n")));
    let number = |word: &&str| {
        let rest = &line[line.find(word).unwrap_or_else(|| panic!("no `{word}` in {line}")) + word.len()..];
        rest.trim_start().split(|c: char| !c.is_ascii_digit()).next().and_then(|text| text.parse().ok())
    };
    words
        .iter()
        .map(|word| number(word).unwrap_or_else(|| panic!("no number behind `{word}` in {line}")))
        .collect()
}

/// The board saw nothing that was not sent, and nothing damaged; returns how many packets it took and sent.
fn board_account(run: &Run) -> (u32, u32) {
    let [frames, taken, handshake, lost] = last(run, &["frames ", "taken ", "handshake ", "lost "])[..]
    else {
        panic!("four numbers")
    };
    let others = last(run, &["late ", "twice ", "damaged ", "foreign "]);
    assert_eq!(frames, taken + handshake, "every frame is one or the other");
    assert_eq!((lost, &others[..]), (0, &[0; 4][..]), "{}", run.log.join("\n"));
    (taken, last(run, &["sent "])[0])
}

/// What one end has sent, the other has taken, but for what was under way when the emulator stopped.
fn assert_accounted(wire: &Wire, run: &Run) {
    let (taken, sent) = board_account(run);
    let ours = wire.link.counters();
    assert_eq!((ours.damaged(), ours.foreign(), ours.lost, ours.late, ours.duplicate), (0, 0, 0, 0, 0));
    assert!(ours.accepted <= sent && sent - ours.accepted <= UNDER_WAY, "{} of {sent} came", ours.accepted);
    let under_way = wire.link.sent_packets() - taken;
    assert!(under_way <= UNDER_WAY, "{taken} of {} were taken", wire.link.sent_packets());
    println!("host took {} of {sent}, board took {taken} of {}", ours.accepted, wire.link.sent_packets());
}

#[test]
fn a_controller_on_the_host_holds_the_flow_of_the_plant_in_the_emulator() {
    let path = socket("plant");
    let running = linked(&path, &[&format!("seconds={}", seconds() + SETTLING_S)]);
    let mut wire = Wire::connect(&path, Role::Controller, &network());
    let mut controller = Controller::new(FLOW, 0.2, [0.02, 1.0], 1e-3);
    let (mut mode, mut newest, mut first_run) = (Mode::PowerUp, 0, None);
    let (mut flows, mut asked) = (Vec::new(), 0_u64);
    while wire.read() {
        let data = wire.link.take_data().cloned();
        if let Some(data) = data {
            let tick = wire.link.newest().tick;
            mode = data.mode;
            for _ in newest..tick {
                // Between two samples the newest holds, as in the plant.
                controller.measure(data.values[0], mode == Mode::Run);
            }
            newest = tick;
            if mode == Mode::Run {
                let first = *first_run.get_or_insert(tick);
                flows.push((tick - first, data.values[0]));
                // Halfway the set point changes.
                if tick - first > u64::from(seconds()) * 500 {
                    controller.parameters.set_point = 0.05;
                }
            }
        }
        asked += 1;
        if mode == Mode::Ready && asked.is_multiple_of(50) && !wire.link.is_commanding() {
            wire.link.command(LinkCommand::Mode(Request::Arm));
        }
        let values = [controller.output(), 1.0];
        if !wire.send(&Outgoing { mode: Mode::Run, values: &values, ..Outgoing::default() }) {
            break;
        }
    }
    let run = running.join().expect("the emulator ran");
    assert!(run.status.success(), "{}", run.log.join("\n"));
    assert_accounted(&wire, &run);
    run.line("mode READY to RUN");
    assert_eq!(run.count("safe from"), 0);
    run.line("overruns 0, 0 in start-up, 0 in a row, skipped 0");
    let half = u64::from(seconds()) * 500;
    let before = flows.iter().rev().find(|(tick, _)| *tick < half).expect("it ran").1;
    let after = flows.last().expect("it ran").1;
    println!("{} samples, {before} kg/s before the set point changed, {after} after", flows.len());
    assert!((before - 0.06).abs() < 2e-3 && (after - 0.05).abs() < 2e-3, "{before}, {after}");
}

/// The controller in the emulator, the plant here: it steps when a packet of the controller comes.
#[test]
fn a_controller_in_the_emulator_holds_the_flow_of_the_plant_on_the_host() {
    let path = socket("controller");
    let running = linked(&path, &["role=controller", &format!("seconds={}", seconds() + 4)]);
    let loaded = network();
    let mut wire = Wire::connect(&path, Role::Plant, &loaded);
    let (inputs, outputs) = (loaded.process.input_channels(), loaded.process.output_channels());
    let image = eclss_core::process::Image { inputs: &inputs, outputs: &outputs, ..Default::default() };
    let (mut input_states, mut output_states) = ([InputState::new(1.0); 2], [OutputState::new(0.0); 2]);
    let mut process = Process::new(image, 1e-3, &mut input_states, &mut output_states).expect("two each");
    let flow = with_simulator(&loaded.network(), Method::TrBdf2, 1_000, |simulator| {
        (0..10_000).for_each(|_| assert_eq!(simulator.step(), Health::Trusted));
        let live: Vec<LiveInput> = inputs
            .iter()
            .map(|channel| simulator.live_input(channel.slot as usize).expect("an input"))
            .collect();
        process.start_from(|channel| simulator.inputs()[channel.slot as usize]);
        let mut peer_tick = None;
        while wire.read() {
            if let Some(command) = wire.link.take_command() {
                wire.link.acknowledge(command.id, Outcome::Mode(Mode::Run));
            }
            if wire.link.take_data().is_some() {
                let newest = wire.link.newest().clone();
                // As many plant ticks as the controller's: it is the emulator that cannot be hurried.
                let passed = newest.tick.saturating_sub(peer_tick.unwrap_or(newest.tick));
                peer_tick = Some(newest.tick);
                for step in 1..=passed {
                    // The sample is of the newest of these ticks; in those before, none came.
                    let came = step == passed;
                    let raw = [0, 1].map(|index| newest.data.value(index).filter(|_| came));
                    process.ingest(&raw, Mode::Run.conduct());
                    for (live, (_, applied)) in live.iter().zip(process.applied()) {
                        simulator.set_live(live, applied.value, applied.slope_per_s).expect("in range");
                    }
                    assert_eq!(simulator.step(), Health::Trusted);
                    process.emit(|signal| simulator.signal(signal), Mode::Run.conduct());
                }
            }
            let values: Vec<f32> = process.outputs().iter().map(OutputState::value).collect();
            if !wire.send(&Outgoing { mode: Mode::Run, values: &values, ..Outgoing::default() }) {
                break;
            }
        }
        simulator.line_flow_kg_s(0)
    });
    let flow = flow.expect("the network was checked");
    let run = running.join().expect("the emulator ran");
    assert!(run.status.success(), "{}", run.log.join("\n"));
    assert_accounted(&wire, &run);
    println!("flow {flow} kg/s");
    assert!((flow - 0.06).abs() < 2e-3, "{flow}");
    assert_eq!(process.inputs()[0].rejected().total(), 0, "nothing was unbelievable");
}

/// The protocol from its document: another language in place of the host.
#[test]
fn the_client_in_python_holds_the_flow_of_the_plant_in_the_emulator() {
    let path = socket("python");
    let running = linked(&path, &[&format!("seconds={}", seconds() + SETTLING_S)]);
    let loaded = network();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../clients/python/hold_flow.py");
    let python = Command::new("python3")
        .arg(script)
        .args(["--network-id", &format!("{:#x}", loaded.network().id())])
        .args(["--process-id", &format!("{:#x}", loaded.process.id())])
        .args(["--seconds", "1000", &format!("unix:{}", path.display())])
        .output()
        .expect("python3 is installed");
    let run = running.join().expect("the emulator ran");
    let told = String::from_utf8_lossy(&python.stdout);
    println!("{told}");
    assert!(python.status.success(), "{told}{}", String::from_utf8_lossy(&python.stderr));
    let number = |name: &str| -> f64 {
        let rest =
            told.split(&format!("\"{name}\": ")).nth(1).unwrap_or_else(|| panic!("no {name} in {told}"));
        rest.split([',', '}']).next().and_then(|text| text.parse().ok()).expect("a number")
    };
    let (taken, sent) = board_account(&run);
    let most = f64::from(UNDER_WAY);
    assert!(number("sent") - f64::from(taken) <= most && f64::from(sent) - number("accepted") <= most);
    for clean in ["lost", "late", "duplicate", "damaged", "foreign"] {
        assert!(number(clean).abs() < 0.5, "{clean}: {told}");
    }
    assert!((number("flow_kg_s") - 0.06).abs() < 2e-3, "{told}");
    assert_eq!(run.count("safe from"), 0);
}
