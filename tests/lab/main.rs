//! A laboratory's own component in a crate of its own: one file, one line in a list, and everything else follows.
//!
//! A program of its own, because kinds are registered once, before a process reads its first network file.

mod scrubber;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Once};
use std::time::{Duration, Instant};

use eclss_core::component::FileKind;
use eclss_core::{Health, Method, Settings};
use eclss_host_sim::serve::feed::{InputState, Malfunction};
use eclss_host_sim::serve::{Command, Frame, Plant, feed};
use eclss_host_sim::{HostBuffers, Source};
use eclss_network_file::generate::modules;
use eclss_network_file::{Loaded, kinds, parse};
use scrubber::Scrubber;
use serde_json::Value;

/// The laboratory's kinds.
static LAB: [&dyn FileKind; 1] = [<dyn FileKind>::of::<Scrubber>()];

const TEXT: &str = include_str!("../files/lab.toml");
const FIGURES: [&str; 4] = ["scrubber.uptake", "scrubber.loading", "polisher.uptake", "polisher.loading"];

fn register() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| kinds::register(&LAB).expect("registered before the first file is read"));
}

fn read(text: &str) -> Result<Loaded, String> {
    register();
    parse(text, "lab.toml").map_err(|error| error.to_string())
}

fn lab() -> Loaded {
    read(TEXT).expect("a good file")
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("files/lab.toml")
}

/// Line of the file on which `text` stands first.
fn line_of(text: &str) -> usize {
    TEXT.lines().position(|line| line == text).expect("a line of the file") + 1
}

fn slot(loaded: &Loaded, name: &str) -> usize {
    loaded.names.inputs.iter().position(|input| input == name).expect("an input")
}

/// Reads a published figure by its name.
fn figure(loaded: &Loaded, simulator: &eclss_core::Simulator<'_>, name: &str) -> f64 {
    let signals = loaded.signals();
    let named = signals.iter().find(|signal| signal.name == name);
    f64::from(simulator.signal(named.unwrap_or_else(|| panic!("no {name}")).signal))
}

#[test]
fn a_second_list_of_kinds_is_refused() {
    register();
    assert_eq!(kinds::register(&LAB), Err(kinds::RegisterError::Late));
}

#[test]
fn errors_of_its_keys_name_file_line_key_and_range() {
    let wrong = |from: &str, to: &str| read(&TEXT.replacen(from, to, 1)).expect_err("refused");
    let line = line_of("rate_kg_s = 0.02");
    let text = wrong("rate_kg_s = 0.02", "rate_kg_s = -0.02");
    let start = format!("lab.toml:{line}:13: `rate_kg_s` must lie in 1e-6 … 1000 kg/s");
    assert!(text.starts_with(&start), "{text}");
    let text = wrong("rate_kg_s = 0.02", "rat_kg_s = 0.02");
    let start = format!("lab.toml:{}:1: `rate_kg_s` is missing", line_of("id = \"scrubber\"") - 1);
    assert!(text.starts_with(&start), "{text}");
    // A bound of the step: 0.1 s of 0.02 kg/s.
    let text = wrong("capacity_kg = 0.1", "capacity_kg = 1e-5");
    let start = format!("lab.toml:{}:", line_of("capacity_kg = 0.1"));
    assert!(text.starts_with(&start) && text.contains("capacity_kg") && text.contains("0.002"), "{text}");
    // An input's range, and a schedule's.
    let text = wrong("rate_kg_s = 0.005", "rate_kg_s = 0.005\nactivity = 1.5");
    assert!(text.contains("`activity` must lie in 0 … 1"), "{text}");
    let text = wrong("[1800.0, 0.5]", "[1800.0, 1.5]");
    assert!(text.contains("`activity` must lie in 0 … 1"), "{text}");
    // Without heat and moisture nothing carries carbon dioxide.
    let dry = TEXT.replacen("\n[air]\nreference_temperature_k = 295.15\n", "\n\n\n", 1);
    let error = parse(&dry, "lab.toml").expect_err("refused");
    let needs =
        |line| error.problems().iter().any(|found| found.line == line && found.reason.contains("`[air]`"));
    assert!(needs(line_of("id = \"scrubber\"") + 1), "{:?}", error.problems());
}

#[test]
fn its_figures_are_signals_and_channels() {
    let loaded = lab();
    let names: Vec<_> = loaded.standard_signals().into_iter().map(|signal| signal.column()).collect();
    for column in FIGURES {
        let unit = if column.ends_with("uptake") { "_kg_s" } else { "_kg" };
        assert!(names.contains(&format!("{column}{unit}")), "{column}: {names:?}");
    }
    let inputs: Vec<_> = loaded.process.inputs.iter().map(|entry| entry.name.as_str()).collect();
    let outputs: Vec<_> = loaded.process.outputs.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(inputs, ["polisher.activity"]);
    assert_eq!(outputs, ["scrubber.uptake", "polisher.loading"]);
}

#[test]
fn a_run_writes_it_into_json_and_csv() {
    register();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("lab");
    let arguments = ["eclss-rt", "run", "", "--until", "10s", "--every", "1s", "--json", "--out", ""];
    let mut arguments = arguments.map(std::ffi::OsString::from);
    (arguments[2], arguments[9]) = (path().into(), folder.clone().into());
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = eclss_host_sim::main(arguments, &mut out, &mut err);
    assert_eq!(code, 0, "{}", String::from_utf8_lossy(&err));
    let report: Value = serde_json::from_slice(&out).expect("JSON");
    let shown = &report["at"][0]["climate"];
    let mut files =
        std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let csv = files.find(|path| path.extension().is_some_and(|ending| ending == "csv")).expect("a CSV");
    let csv = std::fs::read_to_string(csv).expect("text");
    let columns: Vec<_> = csv.lines().next().expect("names").split(',').collect();
    let last: Vec<_> = csv.lines().last().expect("a row").split(',').collect();
    for name in FIGURES {
        let value = shown[name].as_f64().unwrap_or_else(|| panic!("no {name} in {shown}"));
        assert!(value > 0.0, "{name}: {value}");
        let column = columns.iter().position(|column| column.starts_with(&format!("{name}_kg")));
        let written: f64 =
            last[column.unwrap_or_else(|| panic!("{name}: {columns:?}"))].parse().expect("a number");
        assert!((written / value - 1.0).abs() < 1e-6, "{name}: {written}, {value}");
    }
}

#[test]
fn the_reference_of_kinds_lists_it() {
    register();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let arguments = ["eclss-rt", "kinds", "--markdown"].map(std::ffi::OsString::from);
    assert_eq!(eclss_host_sim::main(arguments, &mut out, &mut err), 0);
    let text = String::from_utf8(out).expect("text");
    for word in ["lab_scrubber", "capture_j_kg", "activity", "uptake"] {
        assert!(text.contains(word), "no {word}");
    }
}

#[test]
fn the_page_lists_it_and_breaks_its_input() {
    register();
    let source = Source::file(&path()).expect("a good file");
    let plant =
        Plant::new(source, Settings { method: Method::ImplicitEuler, step_us: 1_000 }).expect("accepted");
    let (publisher, feed) = feed(plant.catalogue(true));
    let place = |id: &str| feed.catalogue.values.iter().position(|value| value.id == id);
    let places = FIGURES.map(|id| place(id).unwrap_or_else(|| panic!("{id} is not published")));
    let input = |id: &str| feed.catalogue.inputs.iter().position(|input| input.id == id).expect("an input");
    let (scheduled, free) = (input("scrubber.activity"), input("polisher.activity"));
    let drawn =
        feed.catalogue.lines[0].elements.iter().any(|(id, kind)| id == "scrubber" && kind == "lab_scrubber");
    assert!(drawn, "not in the drawing");

    let stop = Arc::new(AtomicBool::new(false));
    let own = Arc::clone(&stop);
    let thread = std::thread::spawn(move || plant.run(publisher, &own));
    let mut frame = Frame::default();
    let mut wait = |holds: &dyn Fn(&Frame) -> bool| {
        let until = Instant::now() + Duration::from_secs(20);
        while Instant::now() < until {
            if feed.fetch(&mut frame) && holds(&frame) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        false
    };
    let worked =
        wait(&|frame| frame.values[places[2]] > 0.0 && frame.inputs[scheduled] == InputState::Scheduled);
    let asked = feed.command(Command::Break { input: free, how: Some(Malfunction::Low) });
    let broke = wait(&|frame| frame.inputs[free] == InputState::Low && frame.values[places[2]] == 0.0);
    stop.store(true, Ordering::Relaxed);
    thread.join().expect("no panic").expect("no failure");
    assert!(worked && asked && broke, "{worked}, {asked}, {broke}: {frame:?}");
}

#[test]
fn ledgers_close_over_an_hour_with_what_it_holds() {
    let loaded = lab();
    let network = loaded.network();
    for method in [Method::ImplicitEuler, Method::TrBdf2] {
        let mut buffers = HostBuffers::default();
        let mut simulator =
            buffers.simulator(&network, Settings { method, step_us: 100_000 }).expect("accepted");
        assert_eq!(simulator.step_times(36_000), Health::Trusted);
        assert!(simulator.time_us() == 3_600_000_000);
        let held: f64 =
            ["scrubber.loading", "polisher.loading"].map(|id| figure(&loaded, &simulator, id)).iter().sum();
        for ledger in simulator.ledgers() {
            let gap = ledger.gap().abs();
            println!(
                "{}, {}: gap {gap:e} of {:e} {}",
                method.name(),
                ledger.name,
                ledger.turned_over,
                ledger.unit
            );
            // A gas that is only moved, as nitrogen here, is turned over in the lines alone.
            let turned = if ledger.turned_over > 0.0 { ledger.turned_over } else { 24.0 };
            assert!(gap <= 1e-6 * turned, "{}, {}: {gap:e} of {turned:e}", method.name(), ledger.name);
        }
        // The crew breathes out some 40 g; more than half of it is in the cells.
        let ledgers = simulator.ledgers();
        let breathed =
            ledgers.iter().find(|ledger| ledger.name == "carbon_dioxide").expect("a ledger").supplied;
        assert!(held > 0.5 * breathed && held < 0.15, "{held} kg of {breathed} kg");
    }
}

#[test]
fn a_checkpoint_goes_on_to_the_same_bits() {
    let loaded = lab();
    let network = loaded.network();
    let settings = Settings { method: Method::ImplicitEuler, step_us: 100_000 };
    let (mut first, mut second) = (HostBuffers::default(), HostBuffers::default());
    let mut ours = first.simulator(&network, settings).expect("accepted");
    let mut theirs = second.simulator(&network, settings).expect("accepted");
    ours.step_times(3_000);
    let mut bytes = vec![0; ours.checkpoint_bytes()];
    ours.save(&mut bytes).expect("room");
    theirs.restore(&bytes).expect("the same network");
    assert_eq!(ours.step_times(3_000), theirs.step_times(3_000));
    assert_eq!(ours.state_hash(), theirs.state_hash());
    for name in FIGURES {
        let (ours, theirs) = (figure(&loaded, &ours, name), figure(&loaded, &theirs, name));
        assert!(ours > 0.0 && ours.to_bits() == theirs.to_bits(), "{name}: {ours}, {theirs}");
    }
}

#[test]
fn its_input_moves_what_it_takes() {
    let loaded = lab();
    let network = loaded.network();
    let settings = Settings { method: Method::ImplicitEuler, step_us: 100_000 };
    let mut buffers = HostBuffers::default();
    let mut simulator = buffers.simulator(&network, settings).expect("accepted");
    simulator.step_times(100);
    assert!(figure(&loaded, &simulator, "polisher.uptake") > 0.0);
    simulator.set_input(slot(&loaded, "polisher.activity"), 0.0).expect("in range");
    simulator.step();
    assert!(figure(&loaded, &simulator, "polisher.uptake").abs() < f64::MIN_POSITIVE);
    assert!(simulator.set_input(slot(&loaded, "polisher.activity"), 1.5).is_err());
}

#[test]
fn generated_source_and_generated_stations_name_it() {
    let loaded = lab();
    let source = loaded.to_rust();
    let kind = std::any::type_name::<Scrubber>();
    assert!(
        source
            .contains(&format!("AnyComponent::foreign::<::{kind}>(&[50000.0, 0.02, 0.1, 1000000.0, 120.0])")),
        "{kind}"
    );
    assert!(source.contains(&format!("Table::new::<::{kind}>(")));
    let station = read(&modules(TEXT, 3, "chamber").expect("a station")).expect("a good file");
    let scrubbers = station.segments.iter().filter(|segment| segment.element.is::<Scrubber>()).count();
    assert_eq!(scrubbers, 6);
    // Saved and read again, the document is the same network.
    let again = read(&loaded.file.to_toml()).expect("a good file");
    assert_eq!(again.network().id(), loaded.network().id());
}
