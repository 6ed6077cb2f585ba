//! The real-time loop on this computer: link, record, replay, counters. Nothing here depends on how punctual the
//! computer is.

use std::io::sink;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::bench::{config, controller, job, network, place, settled};
use eclss_core::mode::Mode;
use eclss_core::protocol::{Config, Link as Session, Outgoing, Role};
use eclss_host_sim::hil::board::Stall;
use eclss_host_sim::hil::pace::Pace;
use eclss_host_sim::hil::recorder::Trigger;
use eclss_host_sim::hil::replay::replay;
use eclss_host_sim::hil::report::Report;
use eclss_host_sim::hil::runner::{Job, Loopback, RecordWishes, run};
use eclss_host_sim::{Failure, Source};
use eclss_target::wire::{Address, open};

fn recorded(job: Job, name: &str, every: u64, triggers: Vec<Trigger>) -> Job {
    let record = RecordWishes { folder: place(name), every, triggers, around: (50, 50) };
    Job { record: Some(record), ..job }
}

/// Rows of a table as columns by name.
fn column(csv: &str, name: &str) -> Vec<String> {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place =
        names.iter().position(|known| *known == name).unwrap_or_else(|| panic!("no {name}: {names:?}"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), names.len(), "{line}");
            cells[place].to_owned()
        })
        .collect()
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    column(csv, name).iter().map(|cell| cell.parse().unwrap()).collect()
}

/// A controller over a socket arms the plant and moves its valve; when the link is cut the plant goes to SAFE. The
/// record of all of it is replayed to the same state.
#[test]
fn a_controlled_run_is_recorded_and_replayed_to_the_bit() {
    let source = network("hil.toml");
    let step_us = 2_000;
    let path = place("controlled.sock");
    let address = |listens| Address::Unix { path: path.clone(), listens };
    let start = Some(settled(&source, step_us));
    let job = Job { link: Some(address(true)), start, ..job(&source, step_us, 2_500) };
    let job = recorded(job, "controlled", 5, vec![Trigger::Safe]);
    let other = controller(&source, &address(false), step_us, 1_800);
    let report = run(&source, &job, &mut sink()).unwrap();
    other.join().unwrap();

    let link = report.link.as_ref().unwrap();
    assert_eq!((link.sessions, link.bad_crc, link.damaged, link.foreign), (1, 0, 0, 0), "{link:?}");
    assert!(link.accepted > 1_000, "{link:?}");
    let cause = report.cause.as_deref().unwrap_or("none");
    assert!(cause.contains("silent"), "{cause}");

    let folder = &job.record.as_ref().unwrap().folder;
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    let modes = column(&csv, "mode");
    assert!(modes.iter().filter(|mode| *mode == "RUN").count() > 50, "it was armed");
    assert_eq!(modes.last().map(String::as_str), Some("SAFE"));
    // The controller closes the valve, at its integral gain, as long as the flow is above its set point.
    let openings = numbers(&csv, "valve.opening");
    assert!(openings.iter().any(|opening| *opening < 0.95), "the valve was moved: {openings:?}");
    let (last, low, high) = (
        numbers(&csv, "valve.mass_flow_kg_s"),
        numbers(&csv, "valve.mass_flow_kg_s_min"),
        numbers(&csv, "valve.mass_flow_kg_s_max"),
    );
    assert!(last.iter().zip(&low).zip(&high).all(|((last, low), high)| low <= last && last <= high));
    // SAFE was captured tick by tick.
    let capture = std::fs::read_to_string(folder.join("capture_1.csv")).unwrap();
    let ticks = numbers(&capture, "tick");
    assert!(ticks.array_windows().all(|[a, b]| (b - a - 1.0).abs() < 1e-9) && ticks.len() > 50);
    let modes = column(&capture, "mode");
    assert!(modes.contains(&"RUN".to_owned()) && modes.contains(&"SAFE".to_owned()));

    let replayed = replay(&folder.join("record.mcap")).unwrap();
    assert_eq!(replayed.state_hash, report.state_hash);
    assert!(replayed.agrees() && replayed.steps > 1_000, "{replayed:?}");
}

/// 5 ms too long in one tick are one overrun and the ticks that it ran over, in counters, record and capture.
#[test]
fn a_stall_is_found_in_the_counters() {
    let source = network("paper-p.toml");
    let stall = Some(Stall { tick: 300, by: Duration::from_millis(5) });
    let job = Job { stall, ..job(&source, 1_000, 600) };
    let job = recorded(job, "stall", 1, vec![Trigger::Overrun]);
    let report = run(&source, &job, &mut sink()).unwrap();
    assert_eq!(report.ticks, 600);
    assert!(report.overruns.total >= 1 && report.missed_ticks >= 5, "{:?}", report.overruns);
    assert!(report.tick.max_us >= 5_000.0 && report.headroom <= -4.0);
    assert!(report.lag_s >= 4.9e-3, "{}", report.lag_s);
    let folder = &job.record.as_ref().unwrap().folder;
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    let (skipped, took) = (numbers(&csv, "skipped"), numbers(&csv, "tick_us"));
    assert!(skipped[300] >= 5.0 && took[300] >= 5_000.0);
    assert_eq!(skipped.iter().sum::<f64>() as u64, report.missed_ticks, "each is in the record");
    assert!(folder.join("capture_1.csv").is_file());
}

fn without_hardware(start: Option<Vec<u8>>, ticks: u64, checkpoint: Option<&str>) -> Report {
    let source = network("paper-p.toml");
    let job = Job {
        pace: Pace::Scaled(f64::INFINITY),
        start,
        checkpoint: checkpoint.map(place),
        ..job(&source, 1_000, ticks)
    };
    run(&source, &job, &mut sink()).unwrap()
}

/// Stopped while the valve closes and started again from the file: the same bits as in one go.
#[test]
fn a_restart_from_a_checkpoint_gives_the_same_bits() {
    let file = place("middle.eckp");
    without_hardware(None, 10_600, Some("middle.eckp"));
    let middle = std::fs::read(&file).unwrap();
    let parts = without_hardware(Some(middle.clone()), 1_400, None);
    let whole = without_hardware(None, 12_000, None);
    assert_eq!(parts.state_hash, whole.state_hash);
    assert!((whole.plant_s - 12.0).abs() < 1e-9 && (parts.plant_s - 12.0).abs() < 1e-9);

    let source = network("paper-p.toml");
    let mut spoilt = middle;
    spoilt[100] ^= 1;
    let job = Job { start: Some(spoilt), ..job(&source, 1_000, 10) };
    let refused = run(&source, &job, &mut sink()).unwrap_err();
    assert!(refused.to_string().contains("damaged") && refused.exit_code() == 2, "{refused}");
}

/// A checkpoint from the middle of a transient: resumed, the plant stands there to the bit until it is armed, where a plain
/// start goes on to settle. Armed, it takes the step that an unbroken run would have taken.
#[test]
fn a_run_is_resumed_from_any_state() {
    let source = network("hil.toml");
    let file = place("transient.eckp");
    let fast = |ticks| Job { pace: Pace::Scaled(f64::INFINITY), ..job(&source, 2_000, ticks) };
    let saved = run(&source, &Job { checkpoint: Some(file.clone()), ..fast(300) }, &mut sink()).unwrap();
    assert_eq!(saved.mode, "INIT", "it has not come to rest");
    let start = Some(std::fs::read(&file).unwrap());
    let settling = recorded(Job { start: start.clone(), ..fast(300) }, "settling", 1, Vec::new());
    let record =
        |job: &Job| std::fs::read_to_string(job.record.as_ref().unwrap().folder.join("record.csv")).unwrap();
    let unbroken = (run(&source, &settling, &mut sink()).unwrap(), record(&settling));
    let (settling, unbroken) = (unbroken.0, numbers(&unbroken.1, "valve.mass_flow_kg_s"));
    assert!(settling.mode == "INIT" && settling.state_hash != saved.state_hash);
    let standing =
        run(&source, &Job { start: start.clone(), resume: true, ..fast(300) }, &mut sink()).unwrap();
    assert_eq!((standing.mode, &standing.state_hash), ("READY", &saved.state_hash));

    let path = place("resumed.sock");
    let address = |listens| Address::Unix { path: path.clone(), listens };
    let job = Job { link: Some(address(true)), start, resume: true, ..job(&source, 2_000, 1_500) };
    let job = recorded(job, "resumed", 1, Vec::new());
    let other = controller(&source, &address(false), 2_000, 1_500);
    run(&source, &job, &mut sink()).unwrap();
    other.join().unwrap();
    let csv = record(&job);
    let (modes, flows) = (column(&csv, "mode"), numbers(&csv, "valve.mass_flow_kg_s"));
    assert!(!modes.contains(&"INIT".to_owned()));
    let run = modes.iter().position(|mode| mode == "RUN").expect("it was armed");
    // The step that an unbroken run would have taken: its input has not moved yet.
    assert!(
        (flows[run] - unbroken[0]).abs() < 1e-6,
        "{:?}, unbroken {:?}",
        &flows[run..run + 3],
        &unbroken[..3]
    );
}

#[test]
fn time_is_not_scaled_with_hardware_on_it() {
    let source = network("hil.toml");
    let path = place("scaled.sock");
    let link = Some(Address::Unix { path, listens: true });
    let job = Job { link, pace: Pace::Scaled(2.0), ..job(&source, 1_000, 10) };
    assert!(matches!(run(&source, &job, &mut sink()), Err(Failure::BadInput(_))));
}

/// Whatever is spoilt in a record is refused, and never taken for a run.
#[test]
fn a_spoilt_record_is_refused() {
    let source = network("paper.toml");
    let job = Job { pace: Pace::Scaled(f64::INFINITY), ..job(&source, 1_000, 200) };
    let job = recorded(job, "spoilt", 10, Vec::new());
    run(&source, &job, &mut sink()).unwrap();
    let path = job.record.as_ref().unwrap().folder.join("record.mcap");
    assert!(replay(&path).unwrap().agrees());
    let good = std::fs::read(&path).unwrap();
    // The index for viewers follows the data.
    for cut in [0, 8, good.len() / 4, good.len() / 2] {
        std::fs::write(&path, &good[..cut]).unwrap();
        let cut_short = replay(&path);
        assert!(!cut_short.is_ok_and(|replayed| replayed.agrees()), "cut at {cut}");
    }
    let mut survived = 0;
    for byte in (0..good.len()).step_by(41) {
        let mut spoilt = good.clone();
        spoilt[byte] ^= 0x10;
        std::fs::write(&path, &spoilt).unwrap();
        // What is only for viewers may be spoilt without an effect on the run.
        survived += u32::from(replay(&path).is_ok_and(|replayed| replayed.agrees()));
    }
    assert!((survived as usize) < good.len() / 41);
}

/// Records that somebody has made up: whatever stands in them, a replay ends, with a reason or without anything to show.
#[test]
fn a_crafted_record_neither_panics_nor_runs_for_ever() {
    let source = network("paper.toml");
    let job = Job { pace: Pace::Scaled(f64::INFINITY), ..job(&source, 10_000, 60) };
    let job = recorded(job, "crafted", 10, Vec::new());
    run(&source, &job, &mut sink()).unwrap();
    let path = job.record.as_ref().unwrap().folder.join("record.mcap");
    let mut good = std::fs::read(&path).unwrap();
    // Without check sums of chunks, which whoever makes a record up would make up as well.
    let (mut at, mut places) = (8, Vec::new());
    while at + 9 < good.len() {
        let length = u64::from_le_bytes(good[at + 1..at + 9].try_into().unwrap()) as usize;
        if good[at] == 6 {
            good[at + 33..at + 37].fill(0);
        }
        places.push(at);
        at += 9 + length;
    }
    std::fs::write(&path, &good).unwrap();
    assert!(replay(&path).unwrap().agrees());
    let mut dice = 1_u64;
    let mut roll = |most: usize| {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (dice >> 33) as usize % most.max(1)
    };
    for case in 0..1_500 {
        let mut spoilt = good.clone();
        let place = places[roll(places.len())];
        match case % 4 {
            // Lengths, kinds, heads, anything.
            0 => spoilt[place + 1..place + 9].copy_from_slice(&(1_u64 << roll(64)).to_le_bytes()),
            1 => spoilt[place] = roll(16) as u8,
            2 => spoilt[(place + 9 + roll(64)).min(good.len() - 1)] = [0, 1, 0x7f, 0xff][roll(4)],
            _ => (0..4).for_each(|_| spoilt[roll(good.len())] = roll(256) as u8),
        }
        std::fs::write(&path, &spoilt).unwrap();
        let _ = replay(&path);
    }
    // More steps than its rows stand for.
    let string = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let most = u64::MAX.to_string();
    let pairs = [("method", "relaxation"), ("step_us", "10000"), ("steps", &most), ("rows", &most)];
    let pairs = [&pairs[..], &[("rows_dropped", "0"), ("state_hash", "0")]].concat();
    let map: Vec<u8> = pairs.iter().flat_map(|(key, value)| [string(key), string(value)].concat()).collect();
    let body = [string("run"), (map.len() as u32).to_le_bytes().to_vec(), map].concat();
    let record = [&[12][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let at = *places.iter().rfind(|place| good[**place] == 12).unwrap();
    let length = u64::from_le_bytes(good[at + 1..at + 9].try_into().unwrap()) as usize;
    std::fs::write(&path, [&good[..at], &record, &good[at + 9 + length..]].concat()).unwrap();
    let refused = replay(&path).unwrap_err().to_string();
    assert!(refused.contains("more steps than ticks"), "{refused}");
}

/// Two floods, of the listed peer's nonsense and of strangers: every tick runs, looks at a bounded number of bytes,
/// and nothing is armed.
#[test]
fn a_flood_delays_nothing() {
    let source = network("hil.toml");
    let (peer, stranger) = (UdpSocket::bind("127.0.0.1:0").unwrap(), UdpSocket::bind("127.0.0.1:0").unwrap());
    let local = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let link = Some(Address::Udp { local, peer: peer.local_addr().unwrap() });
    let start = Some(settled(&source, 2_000));
    let job = Job { link, arm: true, start, ..job(&source, 2_000, 500) };
    let ends = Arc::new(AtomicBool::new(false));
    let floods: Vec<_> = [peer, stranger]
        .into_iter()
        .enumerate()
        .map(|(number, socket)| {
            let ends = Arc::clone(&ends);
            std::thread::spawn(move || {
                let mut sent = 0u64;
                while !ends.load(Ordering::Relaxed) {
                    // Each datagram ends a frame, so that all of it is looked at.
                    let bytes = [&[number as u8 + 1; 63][..], &[0]].concat();
                    sent += u64::from(socket.send_to(&bytes, local).is_ok());
                    if sent.is_multiple_of(64) {
                        std::thread::sleep(Duration::from_micros(100));
                    }
                }
                sent
            })
        })
        .collect();
    let report = run(&source, &job, &mut sink()).unwrap();
    ends.store(true, Ordering::Relaxed);
    let sent: Vec<u64> = floods.into_iter().map(|flood| flood.join().unwrap()).collect();
    let link = report.link.as_ref().unwrap();
    assert_eq!(report.ticks, 500);
    assert!(sent.iter().all(|sent| *sent > 1_000), "{sent:?}");
    assert!(link.bytes.bytes_in <= 500 * 4_096, "{link:?}");
    assert!(link.damaged + link.bad_crc > 100 && link.accepted == 0 && !link.connected, "{link:?}");
    assert_eq!(report.mode, "READY");
    assert!(report.tick.p50_us < 1_000.0, "{:?}", report.tick);
}

/// A controller that sends some two hundred frames a tick, more than a tick reads: the plant runs on its newest values. Each value
/// tells which of the plant's ticks had come when it was sent.
#[test]
fn a_controller_that_is_too_fast_is_heard_as_it_speaks_now() {
    const STEP_US: u32 = 10_000;
    let source = network("hil.toml");
    let path = place("fast.sock");
    let address = |listens| Address::Unix { path: path.clone(), listens };
    let start = Some(settled(&source, STEP_US));
    let job = Job { link: Some(address(true)), start, arm: true, ..job(&source, STEP_US, 600) };
    let job = recorded(job, "fast", 1, Vec::new());
    // Two hundred of its ticks are but one of the plant's.
    let config = Config { silent_ticks: 100_000, ..config(&source, Role::Controller, STEP_US) };
    let opening = |tick: u64| 0.6 + 0.003 * (tick % 200).abs_diff(100) as f32;
    let (ends, address) = (Arc::new(AtomicBool::new(false)), address(false));
    let other = {
        let ends = Arc::clone(&ends);
        std::thread::spawn(move || {
            let (mut link, _keeper) = open(&address).unwrap();
            let mut session = Session::new(config, 5);
            let mut bytes = vec![0; 2_048];
            for tick in 0.. {
                if ends.load(Ordering::Relaxed) {
                    return;
                }
                let length = link.read(&mut bytes);
                session.feed(&bytes[..length], tick);
                let values = [opening(session.newest().tick), 1.0];
                let outgoing = Outgoing { mode: Mode::Run, values: &values, ..Outgoing::default() };
                for _ in 0..4 {
                    session.send_tick(tick, tick, &outgoing);
                    let taken = link.write(session.outgoing());
                    session.sent(taken);
                }
                std::thread::sleep(Duration::from_micros(100));
            }
        })
    };
    let report = run(&source, &job, &mut sink()).unwrap();
    ends.store(true, Ordering::Relaxed);
    other.join().unwrap();
    let link = report.link.as_ref().unwrap();
    assert!(link.bytes.bytes_skipped > 0 && link.bad_crc + link.damaged == 0, "{link:?}");
    let csv = std::fs::read_to_string(job.record.as_ref().unwrap().folder.join("record.csv")).unwrap();
    let (ticks, openings) = (numbers(&csv, "tick"), numbers(&csv, "valve.opening"));
    let run =
        column(&csv, "mode").iter().position(|mode| mode == "RUN").unwrap_or_else(|| panic!("{report:?}"));
    let rows = ticks.iter().zip(&openings).skip(run + 250);
    let behind =
        |tick: u64, value: f64| (0..200).find(|ago| (f64::from(opening(tick - ago)) - value).abs() < 1e-4);
    let mut behind: Vec<u64> =
        rows.map(|(tick, value)| behind(*tick as u64, *value).unwrap_or(200)).collect();
    behind.sort_unstable();
    assert!(behind.len() > 100 && behind[behind.len() / 2] <= 4, "{behind:?}");
}

/// Two ends over datagrams: data both ways and orders, while a stranger whose packets would be sound is not heard.
#[test]
fn a_session_over_udp_hears_its_peer_alone() {
    let source = network("hil.toml");
    let step_us = 2_000;
    let free = || UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (ours, theirs) = (free(), free());
    let start = Some(settled(&source, step_us));
    let link = Some(Address::Udp { local: ours, peer: theirs });
    let job = recorded(Job { link, start, ..job(&source, step_us, 1_500) }, "datagrams", 5, Vec::new());
    let other = controller(&source, &Address::Udp { local: theirs, peer: ours }, step_us, 1_100);
    let ends = Arc::new(AtomicBool::new(false));
    let stranger = {
        let (ends, config) = (Arc::clone(&ends), config(&source, Role::Controller, step_us));
        std::thread::spawn(move || {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            let mut session = Session::new(config, 99);
            let mut sent = 0;
            while !ends.load(Ordering::Relaxed) {
                session.send_quiet_tick(sent, sent);
                let _ = socket.send_to(session.outgoing(), ours);
                session.sent(session.outgoing().len());
                sent += 1;
                std::thread::sleep(Duration::from_micros(500));
            }
            (sent, socket.set_nonblocking(true).is_ok() && socket.recv(&mut [0; 600]).is_err())
        })
    };
    let report = run(&source, &job, &mut sink()).unwrap();
    ends.store(true, Ordering::Relaxed);
    other.join().unwrap();
    let (sent, unanswered) = stranger.join().unwrap();
    assert!(sent > 100 && unanswered, "the stranger was there, and was not answered");
    let link = report.link.as_ref().unwrap();
    assert_eq!(
        (link.sessions, link.bad_crc, link.damaged, link.foreign, link.late),
        (1, 0, 0, 0, 0),
        "{link:?}"
    );
    assert!(link.accepted > 500 && link.bytes.bytes_out > 10_000, "{link:?}");
    let folder = &job.record.as_ref().unwrap().folder;
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    assert!(column(&csv, "mode").contains(&"RUN".to_owned()), "its orders were heard");
    assert!(numbers(&csv, "valve.opening").iter().any(|opening| *opening < 0.95), "and its values");
}

/// Measured over the bytes of a link: a tick when latched, none when immediate, whatever the computer does meanwhile.
#[test]
fn the_delay_is_measured_by_loopback() {
    let shipped = include_str!("../../networks/hil.toml");
    for (order, ticks) in [("latched", 1), ("immediate", 0)] {
        let text = shipped.replace("order = \"latched\"", &format!("order = \"{order}\""));
        let source = Source::text(text.as_bytes(), "hil.toml", order.into()).unwrap();
        let start = Some(settled(&source, 2_000));
        let job = Job { loopback: Some(Loopback::Inside), start, ..job(&source, 2_000, 1_000) };
        let report = run(&source, &job, &mut sink()).unwrap();
        assert_eq!((report.mode, report.order), ("RUN", order));
        let loopback = report.loopback.unwrap();
        assert_eq!(
            (loopback.channel.as_str(), loopback.ticks),
            ("valve.opening", [ticks; 2]),
            "{loopback:?}"
        );
        assert!(loopback.in_out.count > 100 && loopback.end_to_end.min_us >= 0.0, "{loopback:?}");
        let least = f64::from(ticks) * 2_000.0;
        assert!((loopback.in_out.p50_us - least).abs() < 1_000.0, "{loopback:?}");
        assert!(report.channels.iter().any(|channel| channel.name == "valve.opening (loopback)"));
    }
}

/// What hardware sends and nobody believes is counted by channel and reason, and moves nothing.
#[test]
fn rejects_are_reported_by_channel() {
    let source = network("hil.toml");
    let step_us = 2_000;
    let path = place("rejects.sock");
    let start = Some(settled(&source, step_us));
    let link = Some(Address::Unix { path: path.clone(), listens: true });
    let job = Job { link, start, arm: true, ..job(&source, step_us, 1_000) };
    let config = config(&source, Role::Controller, step_us);
    let other = std::thread::spawn(move || {
        let (mut link, _keeper) = open(&Address::Unix { path, listens: false }).unwrap();
        let mut session = Session::new(config, 5);
        let (mut tick, mut turn, mut sent, mut bytes) = (0, 0, [0; 4], [0; 2_048]);
        let begun = std::time::Instant::now();
        while begun.elapsed() < Duration::from_millis(2_600) {
            let length = link.read(&mut bytes);
            session.feed(&bytes[..length], tick);
            // Unasked now and then, so that the plant hears of us.
            turn += 1;
            if session.take_data().is_some() || turn % 16 == 0 {
                let bad = (tick % 8) as usize;
                let opening = [f32::NAN, 1.0, 5.0, 1.0, 0.5, 1.0, f32::NEG_INFINITY, 1.0][bad];
                let outgoing = Outgoing { mode: Mode::Run, values: &[opening, 1.0], ..Outgoing::default() };
                session.send_tick(tick, tick, &outgoing);
                if session.is_connected() {
                    for (count, counted) in
                        sent.iter_mut().zip([[0, 6].as_slice(), &[2], &[4], &[1, 3, 5, 7]])
                    {
                        *count += u32::from(counted.contains(&bad));
                    }
                }
                let taken = link.write(session.outgoing());
                session.sent(taken);
                tick += 1;
            }
            std::thread::sleep(Duration::from_micros(300));
        }
        sent
    });
    let report = run(&source, &job, &mut sink()).unwrap();
    let [not_finite, out_of_range, halved, full] = other.join().unwrap();
    let valve = report.channels.iter().find(|channel| channel.name == "valve.opening").unwrap();
    // Packets that come in one tick leave the newest, and the first ones may be before the session.
    assert!(valve.not_finite > 50 && valve.not_finite <= not_finite, "{valve:?} of {not_finite}");
    assert!(valve.out_of_range > 25 && valve.out_of_range <= out_of_range, "{valve:?} of {out_of_range}");
    // On a busy computer half an opening may be believed after a pause; then a full one is too fast for a while.
    assert!(valve.too_fast > 25 && valve.too_fast <= halved + full, "{valve:?} of {halved} and {full}");
    let fan = report.channels.iter().find(|channel| channel.name == "fan.speed").unwrap();
    assert_eq!((fan.not_finite, fan.out_of_range, fan.too_fast), (0, 0, 0), "each signal by itself");
    let flow = report.channels.iter().find(|channel| channel.name == "loop.mass_flow").unwrap();
    assert_eq!((flow.direction, flow.not_finite), ("out", 0));
}

/// The page of a running loop: plant, mode, channels and link, with frames that nobody fetched counted.
#[test]
fn a_page_shows_loop_and_hardware() {
    let source = network("hil.toml");
    let address = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let start = Some(settled(&source, 2_000));
    let page = Some(address);
    let job = Job { loopback: Some(Loopback::Inside), page, start, ..job(&source, 2_000, 1_500) };
    let looked = std::thread::spawn(move || {
        let ask = |path: &str| {
            let mut answer = ureq::get(&format!("http://{address}{path}")).call().ok()?;
            serde_json::from_str::<serde_json::Value>(&answer.body_mut().read_to_string().ok()?).ok()
        };
        let begun = std::time::Instant::now();
        while begun.elapsed() < Duration::from_secs(30) {
            if let (Some(network), Some(frame)) = (ask("/network"), ask("/frame"))
                && frame["hardware"]["mode"] == "RUN"
                && frame["hardware"]["link"]["accepted"].as_u64().is_some_and(|count| count > 100)
            {
                return (network, frame);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("the page never shows RUN");
    });
    let report = run(&source, &job, &mut sink()).unwrap();
    let (network, frame) = looked.join().unwrap();
    assert_eq!(report.mode, "RUN");
    assert_eq!(
        (network["control"].as_bool(), network["channels"].as_array().map(Vec::len)),
        (Some(false), Some(4))
    );
    let hardware = &frame["hardware"];
    assert_eq!(hardware["quality"][2], "good");
    assert_eq!(
        (hardware["link"]["connected"].as_bool(), hardware["link"]["lost"].as_u64()),
        (Some(true), Some(0))
    );
    assert!(frame["missed"].is_u64() && frame["figures"]["overruns"].is_u64());
    let flow = network["values"].as_array().unwrap().iter().position(|value| value["id"] == "loop.mass_flow");
    assert!(frame["values"][flow.unwrap()].as_f64().is_some_and(|flow| (flow - 0.0865).abs() < 1e-3));
}
