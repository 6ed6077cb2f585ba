//! A plant that somebody else runs, watched: the bench arms it, sets its inputs, takes orders, records what it says.

use std::io::{self, Write, sink};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::bench::{job, network, place, settled};
use eclss_core::protocol::Key;
use eclss_host_sim::hil::replay::replay;
use eclss_host_sim::hil::runner::{Job, RecordWishes, run};
use eclss_host_sim::hil::watch::{self, WatchReport, watch};
use eclss_target::wire::Address;

/// Text that two threads see.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Shared {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

const STEP_US: u32 = 2_000;

/// Orders by the time at which they are given [ms].
fn watched(
    name: &str,
    arm: bool,
    orders: &[(u64, &str)],
    record: Option<RecordWishes>,
) -> (WatchReport, String) {
    watched_with_keys(name, arm, orders, record, [None; 2])
}

/// The same with the board's key and the bench's.
fn watched_with_keys(
    name: &str,
    arm: bool,
    orders: &[(u64, &str)],
    record: Option<RecordWishes>,
    keys: [Option<Key>; 2],
) -> (WatchReport, String) {
    let source = network("hil.toml");
    let path = place(&format!("{name}.sock"));
    let link = |listens| Address::Unix { path: path.clone(), listens };
    let plant = Job {
        link: Some(link(true)),
        key: keys[0],
        start: Some(settled(&source, STEP_US)),
        ..job(&source, STEP_US, 1_800)
    };
    let (lines, taken) = channel();
    let bench = watch::Job {
        settings: plant.settings,
        link: link(false),
        key: keys[1],
        duration: Some(Duration::from_secs(3)),
        arm,
        record,
        page: None,
        orders: Some(taken),
        shows: true,
        ends: Arc::new(AtomicBool::new(false)),
    };
    let shown = Shared::default();
    let report = std::thread::scope(|scope| {
        scope.spawn(|| run(&source, &plant, &mut sink()).unwrap());
        scope.spawn(move || {
            let begun = std::time::Instant::now();
            for (at_ms, line) in orders {
                std::thread::sleep(Duration::from_millis(*at_ms).saturating_sub(begun.elapsed()));
                // The bench may have ended.
                let _ = lines.send((*line).to_owned());
            }
        });
        watch(&source, &bench, &mut shown.clone()).unwrap()
    });
    (report, shown.text())
}

fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',').position(|known| known == name);
    let place = place.unwrap_or_else(|| panic!("no {name}"));
    lines.filter_map(|line| line.split(',').nth(place)?.parse().ok()).collect()
}

#[test]
fn a_board_is_armed_driven_and_recorded() {
    let folder = place("watched");
    let record = RecordWishes { folder: folder.clone(), every: 1, triggers: Vec::new(), around: (0, 0) };
    let orders =
        [(1_000, "set valve.opening 0.3"), (1_000, "get valve.opening"), (1_000, "set valve.opening 7")];
    let (report, shown) = watched("armed", true, &orders, Some(record));
    assert_eq!((report.mode, report.link.sessions), ("RUN", 1), "{shown}");
    assert_eq!((report.link.bad_crc, report.link.damaged, report.link.foreign), (0, 0, 0));
    assert!(
        report.packets > 500 && report.rate_hz.is_some_and(|rate| (rate - 500.0).abs() < 50.0),
        "{report:?}"
    );
    let opening = report.channels.iter().find(|channel| channel.name == "valve.opening").unwrap();
    assert!((opening.value - 0.3).abs() < 1e-6 && opening.quality == "good", "{opening:?}\n{shown}");
    assert!(shown.contains("refused, valve.opening takes 0.02 to 1"), "{shown}");
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    let (sent, flow) = (column(&csv, "valve.opening_sent"), column(&csv, "loop.mass_flow"));
    // No faster than half of what the channel believes: 4 a second.
    assert!(sent.array_windows().all(|[a, b]| (b - a).abs() <= 2.0 * 2e-3 * 40.0), "it jumps");
    let (before, after) = (flow[flow.len() / 4], flow[flow.len() - 1]);
    assert!(before > 0.086 && after < 0.085, "the flow follows the valve: {before}, then {after}");
    let refused = replay(&folder.join("record.mcap")).unwrap_err().to_string();
    assert!(refused.contains("watched"), "{refused}");
}

#[test]
fn only_a_bench_with_the_key_is_obeyed() {
    let key = Some(Key::new([3; 32]));
    let orders = [(700, "arm"), (1_400, "stop")];
    let (report, shown) = watched_with_keys("stranger", false, &orders, None, [key, None]);
    assert!(report.mode == "READY" && shown.contains("arm: refused: Key"), "{shown}");
    assert!(shown.contains("stop: refused: Key"), "{shown}");
    let (report, shown) = watched_with_keys("friend", false, &orders, None, [key; 2]);
    assert!(report.mode == "SAFE" && shown.contains("arm: granted, RUN"), "{shown}");
}

#[test]
fn its_operator_is_answered() {
    let orders = [
        (700, "arm"),
        (1_100, "hold"),
        (1_400, "set valve.opening 0.9"),
        (1_500, "resume"),
        (1_800, "stop"),
        (2_100, "arm"),
        (2_400, "fly"),
        (2_500, "get no.such"),
    ];
    let (report, shown) = watched("answered", false, &orders, None);
    for told in [
        "arm: granted, RUN",
        "hold: granted, HOLD",
        "resume: granted, RUN",
        "stop: granted, SAFE",
        "arm: refused",
        "orders are",
        "nothing is called `no.such`",
    ] {
        assert!(shown.contains(told), "no `{told}` in\n{shown}");
    }
    assert_eq!((report.mode, report.cause), ("SAFE", Some("somebody asked for it")));
}
