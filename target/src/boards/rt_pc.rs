//! A Linux computer: the loop in a thread of real-time priority with all memory locked.
//!
//! Without the right to real-time priority (`ulimit -r`, or `CAP_SYS_NICE`) it says so and runs all the same:
//! the account then shows what the kernel made of it. It has no process inputs or outputs of its own.

use crate::board::{Board, ResetReason};
use crate::control::Settings;
use crate::firmware::{self, Teller};
use crate::journal;
use crate::network::{self, NetworkPlant};
use core::num::NonZeroU32;
use core::time::Duration;
use embassy_executor::Executor;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};
use static_cell::StaticCell;
use std::process::ExitCode;

/// Priority among real-time threads: above the kernel's interrupt threads it would starve them.
const PRIORITY: i32 = 40;
const CLOCK: ClockId = ClockId::Monotonic;

/// The computer.
pub struct RtPc;

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
    fn read_inputs(&mut self, _inputs: &mut [f32]) {}
    fn write_outputs(&mut self, _outputs: &[f32]) {}
    fn safe_outputs(&mut self) {}
    fn feed_watchdog(&mut self) {}
}

fn nanoseconds() -> u64 {
    let now = clock_gettime(CLOCK);
    now.tv_sec.cast_unsigned() * 1_000_000_000 + now.tv_nsec.cast_unsigned()
}

/// Runs with the words `seconds=N` and `period=MICROSECONDS`; without `seconds` until interrupted.
///
/// # Panics
/// When called twice.
pub fn start(words: impl Iterator<Item = String>) -> ExitCode {
    let (seconds, period_us) = match parse(words) {
        Ok(request) => request,
        Err(word) => {
            eprintln!("cannot make sense of `{word}`; there are seconds=N and period=MICROSECONDS");
            return ExitCode::FAILURE;
        }
    };
    let per_second = NonZeroU32::new(1_000_000 / period_us).unwrap_or(NonZeroU32::MIN);
    let settings = Settings {
        period_us,
        ticks: seconds.map(|seconds| u64::from(seconds) * u64::from(per_second.get())),
        startup_ticks: per_second.get(),
        overruns_to_safe: 5,
        lag_to_safe_us: 1_000_000,
        start_safe: false,
        status_every: per_second,
    };
    let plant = network::plant(period_us);
    journal::start(&RtPc, plant.network_id(), &settings, ResetReason::PowerOn);
    let (teller, mut listener) = firmware::events();
    std::thread::spawn(move || {
        static EXECUTOR: StaticCell<Executor> = StaticCell::new();
        become_real_time();
        // This thread is started once, so the task's storage is free.
        let start = |task: embassy_executor::Spawner| {
            task.spawn(looping(plant, settings, teller).expect("the loop starts once"));
        };
        EXECUTOR.init(Executor::new()).run(start);
    });
    loop {
        std::thread::sleep(Duration::from_millis(20));
        if let Some(well) = listener.log() {
            return if well { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
    }
}

#[embassy_executor::task]
async fn looping(mut plant: NetworkPlant, settings: Settings, teller: Teller) {
    firmware::run(&mut RtPc, &mut plant, &settings, teller).await;
}

fn parse(words: impl Iterator<Item = String>) -> Result<(Option<u32>, NonZeroU32), String> {
    let mut seconds = None;
    let mut period_us = NonZeroU32::new(1_000).unwrap_or(NonZeroU32::MIN);
    for word in words {
        let taken = match word.split_once('=') {
            Some(("seconds", value)) => value.parse().map(|value| seconds = Some(value)).is_ok(),
            Some(("period", value)) => value.parse().map(|value| period_us = value).is_ok(),
            _ => false,
        };
        if !taken {
            return Err(word);
        }
    }
    Ok((seconds, period_us))
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

    fn words(line: &str) -> impl Iterator<Item = String> {
        line.split(' ').map(str::to_owned)
    }

    #[test]
    fn words_are_taken_or_named() {
        let (seconds, period_us) = parse(words("seconds=3 period=500")).unwrap();
        assert_eq!((seconds, period_us.get()), (Some(3), 500));
        assert_eq!(parse(words("period=0")), Err("period=0".into()));
        assert_eq!(parse(words("seconds=3 hurry")), Err("hurry".into()));
    }

    #[test]
    fn sleeping_ends_at_or_after_its_time() {
        let mut pc = RtPc;
        let at_us = pc.now_us() + 2_000;
        {
            let mut sleep = core::pin::pin!(pc.sleep_until(at_us));
            let mut context = core::task::Context::from_waker(core::task::Waker::noop());
            assert!(sleep.as_mut().poll(&mut context).is_ready());
        }
        assert!(pc.now_us() >= at_us);
    }
}
