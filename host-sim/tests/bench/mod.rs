//! What tests of the real-time loop share: jobs, and a controller at the other end of a link.

pub(crate) mod console;

use std::num::NonZeroU32;
use std::path::PathBuf;
use std::pin::pin;
use std::task::{Context, Waker};
use std::thread::JoinHandle;

use eclss_core::Settings;
use eclss_core::protocol::{Config, Link as Session, Role};
use eclss_host_sim::Source;
use eclss_host_sim::hil::board::Pc;
use eclss_host_sim::hil::pace::Pace;
use eclss_host_sim::hil::runner::{Job, run};
use eclss_host_sim::hil::tap::Tap;
use eclss_target::controller::{Controller, FLOW};
use eclss_target::coupling::link_counts;
use eclss_target::wire::{Address, open};
use eclss_target::{control, controller::run as run_controller};

/// A network that ships.
pub(crate) fn network(name: &str) -> Source {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../networks").join(name);
    Source::file(&path).unwrap()
}

/// A file or folder of this test alone.
pub(crate) fn place(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    let _ = std::fs::remove_file(&path);
    path
}

/// A run of so many ticks of `step_us`, and nothing else.
pub(crate) fn job(source: &Source, step_us: u32, ticks: u64) -> Job {
    Job {
        settings: Settings { method: source.loaded.run.method, step_us },
        link: None,
        key: None,
        ticks: Some(ticks),
        pace: Pace::Real,
        core: None,
        arm: false,
        record: None,
        start: None,
        resume: false,
        checkpoint: None,
        stall: None,
        operator: false,
        shows: false,
        interrupts: false,
        loopback: None,
        page: None,
    }
}

/// The state of a network that has come to rest in INIT, which without hardware need not take real time.
pub(crate) fn settled(source: &Source, step_us: u32) -> Vec<u8> {
    let file = place(&format!("settled-{step_us}-{:?}", std::thread::current().id()));
    let job = Job {
        pace: Pace::Scaled(f64::INFINITY),
        checkpoint: Some(file.clone()),
        ..job(source, step_us, 20_000_000 / u64::from(step_us))
    };
    let report = run(source, &job, &mut std::io::sink()).unwrap();
    assert_eq!(report.mode, "READY", "it comes to rest within 20 s");
    std::fs::read(file).unwrap()
}

/// The session of either end for `source`.
pub(crate) fn config(source: &Source, role: Role, step_us: u32) -> Config {
    let loaded = &source.loaded;
    let (inputs, outputs) = loaded.process.with_image(|image| link_counts(&image));
    let (network_id, process_id) = (loaded.network().id(), loaded.process.id());
    Config { role, network_id, process_id, step_us, inputs, outputs, ..Config::default() }
}

/// Runs the controller of `networks/hil.toml` for so many ticks in a thread of its own, then cuts the link.
pub(crate) fn controller(source: &Source, address: &Address, step_us: u32, ticks: u64) -> JoinHandle<()> {
    let mut session = Session::new(config(source, Role::Controller, step_us), 77);
    let address = address.clone();
    std::thread::spawn(move || {
        let (link, _keeper) = open(&address).unwrap();
        let tap = Tap::new(Vec::new(), 0, None, None);
        let (_orders, orders) = rtrb::RingBuffer::new(1);
        let mut board = Pc::new(&tap, Some(link), orders, (true, true), None);
        let step_s = step_us as f32 * 1e-6;
        let mut controller = Controller::new(FLOW, 1.0, [0.02, 1.0], step_s);
        let settings = control::Settings {
            period_us: NonZeroU32::new(step_us).unwrap(),
            ticks: Some(ticks),
            startup_ticks: 0,
            overruns_to_safe: u32::MAX,
            lag_to_safe_us: u64::MAX,
            start_safe: false,
            settled: false,
            status_every: NonZeroU32::new(1_000).unwrap(),
        };
        let looped = pin!(run_controller(&mut board, &mut session, &mut controller, &settings, |_| {}));
        assert!(looped.poll(&mut Context::from_waker(Waker::noop())).is_ready());
    })
}
