//! Counts the instructions of a step on an emulated board, one figure a line.
//!
//! Under `-icount shift=7` an instruction takes 128 ns of guest time and the boards' timers count 40 ns, so that a
//! difference of two readings gives the number of instructions exactly. The program first counts a known number of
//! instructions and refuses to go on under any other setting. What calling costs is measured on an empty call and
//! taken off.
//!
//! The word `figures=all` on the emulator's command line asks for all of them; `trace=METHOD` instead runs the paper's scenario a thousand times as fast, with every step between
//! calls of [`trace_begin`] and [`trace_end`]: short enough for the emulator to write down each instruction.

mod laws;
mod link;
mod networks;

use crate::boards::mps2::{semihosting, timer};
use crate::machine;
use core::hint::black_box;
use defmt::{error, info};
use eclss_core::{Element, Health, Simulator};

/// Whether this is the program of the day: what another program has beside it changes what is inlined.
const DAY: bool = cfg!(feature = "measure-day");
/// Instructions of the block that checks the emulator's setting.
const KNOWN: u32 = 1_000;

/// Counts of one figure \[instructions\].
struct Figure {
    samples: u32,
    min: u32,
    max: u32,
    sum: u64,
}

impl Figure {
    const EMPTY: Self = Self { samples: 0, min: u32::MAX, max: 0, sum: 0 };

    fn add(&mut self, instructions: u32) {
        self.samples += 1;
        self.min = self.min.min(instructions);
        self.max = self.max.max(instructions);
        self.sum += u64::from(instructions);
    }

    /// One line of the report: kind, name, samples, smallest, sum, largest.
    fn report(&self, kind: &str, name: &str) {
        info!(
            "{=str} {=str} {=u32} {=u32} {=u64} {=u32}",
            kind, name, self.samples, self.min, self.sum, self.max
        );
    }
}

/// Runs a counted call and returns its instructions, with those of calling it.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) -> u32 {
    let begun = timer::counter();
    work();
    let counts = timer::counter().wrapping_sub(begun);
    // 128 ns over 40 ns is 16/5; the nearest whole number is exact.
    (counts * 5 + 8) / 16
}

/// Runs the program.
pub fn start() -> ! {
    machine::prepare_stack();
    timer::init();
    let line = semihosting::command_line();
    let known = counted(&mut || known_block()) - calling();
    // Besides the block there are the calls of it and back.
    if known.abs_diff(KNOWN) > 8 {
        error!("{=u32} instructions were counted as {=u32}: not under `-icount shift=7`", KNOWN, known);
        semihosting::exit(false);
    }
    let well = match line.split_once('=') {
        Some(("trace", method)) if !DAY => networks::trace(method),
        Some(("figures", "all")) if DAY => networks::day(networks::DAY_STEPS).is_some(),
        Some(("steps", count)) if DAY => count.parse().is_ok_and(|steps| networks::day(steps).is_some()),
        Some(("figures", "all")) => {
            laws::measure();
            link::measure() && networks::measure()
        }
        _ => false,
    };
    if !well {
        error!("`{=str}` did not end well", line.as_str());
    }
    let stack = machine::stack_use();
    info!("stack {=u32} of {=u32} bytes", stack.deepest, stack.size);
    semihosting::exit(well)
}

/// Instructions of a counted call of nothing.
fn calling() -> u32 {
    counted(&mut || {
        black_box(());
    })
}

/// Steps `simulator` through `steps` steps, counting each. False when the run is no longer trusted; what comes
/// after that is not counted, because a simulator that stands still costs nothing.
fn steps<E: Element, S>(
    kind: &str,
    name: &str,
    steps: u32,
    simulator: &mut S,
    step: fn(&mut S) -> Health,
    view: fn(&S) -> &Simulator<'_, E>,
) {
    let calling = calling();
    let mut figure = Figure::EMPTY;
    for _ in 0..steps {
        let mut health = Health::Trusted;
        let count = counted(&mut || health = step(simulator));
        if health != Health::Trusted {
            break;
        }
        figure.add(count - calling);
    }
    figure.report(kind, name);
    let simulator = view(simulator);
    let (id, hash) = (simulator.network_id(), simulator.state_hash());
    info!("run {=str} {=str} {=u64} {=u64:016x} {=u64:016x}", kind, name, simulator.tick(), id, hash);
}

/// A thousand instructions.
#[inline(never)]
fn known_block() {
    // SAFETY: does nothing.
    #[allow(unsafe_code, reason = "a known number of instructions")]
    unsafe {
        core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack, preserves_flags));
    }
}

/// What follows its return up to [`trace_end`] is one traced step.
#[unsafe(no_mangle)]
#[inline(never)]
#[allow(unsafe_code, reason = "found in the trace by its name")]
extern "C" fn trace_begin() {
    // SAFETY: does nothing, but cannot be left out.
    unsafe {
        core::arch::asm!("nop");
    }
}

/// Ends a traced step.
#[unsafe(no_mangle)]
#[inline(never)]
#[allow(unsafe_code, reason = "found in the trace by its name")]
extern "C" fn trace_end() {
    // SAFETY: does nothing, but cannot be left out.
    unsafe {
        core::arch::asm!("nop", "nop");
    }
}
