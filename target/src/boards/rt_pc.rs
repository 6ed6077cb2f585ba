//! A Linux computer: the loop in a thread of real-time priority with all memory locked.
//!
//! Without the right to real-time priority (`ulimit -r`, or `CAP_SYS_NICE`) it says so and runs all the same:
//! the account then shows what the kernel made of it. It has no converters, but a link.

use crate::board::{Board, Converters, ResetReason};
use crate::control::Settings;
use crate::coupling::Coupling;
use crate::firmware::{self, Heard, Teller};
use crate::journal::{self, Journal};
use crate::network::{self, NetworkPlant};
use crate::wire::{Address, Keeper, Link, open};
use core::num::NonZeroU32;
use core::time::Duration;
use eclss_core::process::{Image, InputState, OutputState, Process};
use eclss_core::protocol::Role;
use eclss_core::{Buffers, Network, Simulator};
use eclss_network_file::Loaded;
use embassy_executor::Executor;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};
use static_cell::StaticCell;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

/// Priority among real-time threads: above the kernel's interrupt threads it would starve them.
const PRIORITY: i32 = 40;
const CLOCK: ClockId = ClockId::Monotonic;

/// The computer.
#[derive(Default)]
pub struct RtPc {
    link: Option<Link>,
}

impl Board for RtPc {
    const COUNTER_HZ: u32 = 1_000_000_000;

    fn name(&self) -> &'static str {
        "rt-pc"
    }
    fn now_us(&self) -> u64 {
        nanoseconds() / 1_000
    }
    /// Blocks the thread: it is the loop's own, and the kernel's absolute sleep is the most precise there is.
    async fn sleep_until(&mut self, at_us: u64) {
        let tv_nsec = ((at_us % 1_000_000) * 1_000).cast_signed();
        let at = Timespec { tv_sec: (at_us / 1_000_000).cast_signed(), tv_nsec };
        while clock_nanosleep_absolute(CLOCK, &at).is_err() {}
    }
    fn counter(&self) -> u32 {
        nanoseconds() as u32
    }
    fn read_inputs(&mut self, _converters: &mut Converters) {}
    fn write_outputs(&mut self, _converters: &Converters, _armed: bool) {}
    fn read_link(&mut self, bytes: &mut [u8]) -> usize {
        self.link.as_mut().map_or(0, |link| link.read(bytes))
    }
    fn write_link(&mut self, bytes: &[u8]) -> usize {
        self.link.as_mut().map_or(bytes.len(), |link| link.write(bytes))
    }
    fn safe_outputs(&mut self) {}
    fn feed_watchdog(&mut self) {}
}

fn nanoseconds() -> u64 {
    let now = clock_gettime(CLOCK);
    now.tv_sec.cast_unsigned() * 1_000_000_000 + now.tv_nsec.cast_unsigned()
}

/// Runs with the words `seconds=N`, `network=FILE`, `link=LINK` and `peer=ADDRESS:PORT`, the latter two as
/// [`Address::read`] takes them; without `seconds` until interrupted, without `network` the network that is compiled in.
/// Channels take part where there is a link for them.
///
/// # Panics
/// When called twice.
pub fn start(words: impl Iterator<Item = String>) -> ExitCode {
    let request = match Request::read(words) {
        Ok(request) => request,
        Err(word) => {
            eprintln!(
                "cannot make sense of `{word}`; there are seconds=N, network=FILE, link=LINK and \
                       peer=ADDRESS:PORT"
            );
            return ExitCode::FAILURE;
        }
    };
    let built = request.network.as_deref().map_or_else(compiled_in, load);
    let opened = request.open();
    let (plant, process, link) = match built.and_then(|(plant, process)| Ok((plant, process, opened?))) {
        Ok(parts) => parts,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    // The keeper opens the link again when it was lost, as long as the loop runs.
    let (link, _keeper) = link.unzip();
    let coupling = if link.is_some() { couple(&plant, process) } else { Coupling::none() };
    let board = RtPc { link };
    let period_us = NonZeroU32::new(plant.settings().step_us).unwrap_or(NonZeroU32::MIN);
    let per_second = NonZeroU32::new(1_000_000 / period_us).unwrap_or(NonZeroU32::MIN);
    let settings = Settings {
        period_us,
        ticks: request.seconds.map(|seconds| u64::from(seconds) * u64::from(per_second.get())),
        startup_ticks: per_second.get(),
        overruns_to_safe: 5,
        lag_to_safe_us: 1_000_000,
        start_safe: false,
        status_every: per_second,
    };
    let journal = Journal::start(&board, &plant, &settings, ResetReason::PowerOn);
    if coupling.is_bound() {
        journal::process(coupling.process().image().id());
    }
    let (teller, mut listener) = firmware::events(journal);
    std::thread::spawn(move || {
        static EXECUTOR: StaticCell<Executor> = StaticCell::new();
        become_real_time();
        // This thread is started once, so the task's storage is free.
        let start = |task: embassy_executor::Spawner| {
            task.spawn(looping(board, plant, coupling, settings, teller).expect("the loop starts once"));
        };
        EXECUTOR.init(Executor::new()).run(start);
    });
    loop {
        std::thread::sleep(Duration::from_millis(20));
        if let Heard::Ended { well } = listener.log() {
            return if well { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
    }
}

/// A plant and its process image.
type Built = (NetworkPlant, Image<'static>);

fn compiled_in() -> Result<Built, Box<dyn Error>> {
    Ok((network::compiled_in()?, network::compiled_in_process()))
}

/// The image with a link, for which the process identifies itself by number and time.
fn couple(plant: &NetworkPlant, image: Image<'static>) -> Coupling<'static> {
    let nonce = std::process::id() ^ nanoseconds() as u32;
    let step_s = plant.settings().step_us as f32 * 1e-6;
    let inputs = Box::leak(vec![InputState::new(0.0); image.inputs.len()].into_boxed_slice());
    let outputs = Box::leak(vec![OutputState::new(0.0); image.outputs.len()].into_boxed_slice());
    let process = Process::new(image, step_s, inputs, outputs).expect("one state a channel");
    Coupling::new(process, step_s, network::link(plant, &image, Role::Plant, nonce))
}

/// Loads a network file at run time. What it needs stays for the rest of the process.
fn load(path: &str) -> Result<Built, Box<dyn Error>> {
    let loaded: &'static Loaded = Box::leak(Box::new(eclss_network_file::load(Path::new(path))?));
    let network: &'static Network<'static> = Box::leak(Box::new(loaded.network()));
    let settings = eclss_core::Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(network);
    let zeros = |length| Box::leak(vec![0.0; length].into_boxed_slice());
    let buffers = Buffers {
        state: zeros(sizes.state),
        work: zeros(sizes.work),
        inputs: zeros(sizes.inputs),
        cursors: Box::leak(vec![0; sizes.cursors].into_boxed_slice()),
    };
    let names: Vec<&'static str> = loaded.names.lines.iter().map(String::as_str).collect();
    let simulator = Simulator::new(network, settings, buffers)?;
    let image = Image {
        inputs: Box::leak(loaded.process.input_channels().into_boxed_slice()),
        outputs: Box::leak(loaded.process.output_channels().into_boxed_slice()),
        order: loaded.process.order,
        safe_after_ticks: loaded.process.safe_after_ticks,
    };
    Ok((network::loaded(simulator, &loaded.file.name, Box::leak(names.into_boxed_slice())), image))
}

#[embassy_executor::task]
async fn looping(
    mut board: RtPc,
    mut plant: NetworkPlant,
    mut coupling: Coupling<'static>,
    settings: Settings,
    teller: Teller,
) {
    firmware::run(&mut board, &mut plant, &mut coupling, &settings, teller).await;
}

/// What the command line asks for.
#[derive(Debug, Default, PartialEq, Eq)]
struct Request {
    seconds: Option<u32>,
    network: Option<String>,
    link: Option<String>,
    peer: Option<String>,
}

impl Request {
    /// Takes every word or names the one that makes no sense.
    fn read(words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut request = Self::default();
        for word in words {
            let taken = match word.split_once('=') {
                Some(("seconds", value)) => value.parse().map(|value| request.seconds = Some(value)).is_ok(),
                Some(("network", value)) => {
                    request.network = Some(value.into());
                    true
                }
                Some(("link", value)) => {
                    request.link = Some(value.into());
                    true
                }
                Some(("peer", value)) => {
                    request.peer = Some(value.into());
                    true
                }
                _ => false,
            };
            if !taken {
                return Err(word);
            }
        }
        Ok(request)
    }

    /// Opens the link, if there is to be one.
    fn open(&self) -> Result<Option<(Link, Keeper)>, Box<dyn Error>> {
        let Some(link) = &self.link else { return Ok(None) };
        Ok(Some(open(&Address::read(link, self.peer.as_deref())?)?))
    }
}

/// Locks all memory, so that no page fault delays a tick, and asks for real-time priority.
fn become_real_time() {
    if let Err(error) = mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE) {
        eprintln!("memory is not locked: {error}");
    }
    let parameter = libc::sched_param { sched_priority: PRIORITY };
    // SAFETY: the call reads one struct, which lives through it; 0 is the calling thread.
    #[allow(unsafe_code, reason = "a system call without a safe wrapper")]
    let refused = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameter) } != 0;
    if refused {
        eprintln!("no real-time priority: {}", std::io::Error::last_os_error());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant as _;

    fn read(line: &str) -> Result<Request, String> {
        Request::read(line.split(' ').map(str::to_owned))
    }

    #[test]
    fn words_are_taken_or_named() {
        let request = read("seconds=3 network=a.toml").unwrap();
        assert_eq!(
            request,
            Request { seconds: Some(3), network: Some("a.toml".into()), ..Request::default() }
        );
        assert_eq!(read("seconds=x"), Err("seconds=x".into()));
        assert_eq!(read("seconds=3 hurry"), Err("hurry".into()));
    }

    /// Compiled in and loaded at run time: the same network, and the same bits after the valve has closed.
    #[test]
    fn a_loaded_network_is_the_compiled_one() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../networks/paper.toml");
        let (mut ours, mut theirs) = (network::compiled_in().unwrap(), load(path).unwrap().0);
        assert_ne!(ours.origin(), theirs.origin());
        assert_eq!((ours.name(), ours.network_id()), (theirs.name(), theirs.network_id()));
        assert_eq!(ours.line_names(), theirs.line_names());
        for tick in 0..26_000 {
            assert_eq!((ours.step(), theirs.step()), (Ok(()), Ok(())), "tick {tick}");
        }
        assert_eq!(ours.state_hash(), theirs.state_hash());
        assert_eq!(ours.outputs(), theirs.outputs());
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let Err(error) = load("no/such.toml") else { panic!("it is there") };
        assert!(error.to_string().contains("no/such.toml"), "{error}");
    }

    #[test]
    fn sleeping_ends_at_or_after_its_time() {
        let mut pc = RtPc::default();
        let at_us = pc.now_us() + 2_000;
        {
            let mut sleep = core::pin::pin!(pc.sleep_until(at_us));
            let mut context = core::task::Context::from_waker(core::task::Waker::noop());
            assert!(sleep.as_mut().poll(&mut context).is_ready());
        }
        assert!(pc.now_us() >= at_us);
    }
}
