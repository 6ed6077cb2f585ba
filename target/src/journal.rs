//! The firmware's log: what the loop tells, put into words.
//!
//! Lines are short on purpose: a defmt frame is written with interrupts off, and would delay a tick.

use crate::board::{Board, ResetReason, StackUse};
use crate::control::{Cause, Event, Settings};
use crate::fault::Fault;
use defmt::{error, info, warn};

/// Logs what is known before the loop starts.
pub fn start<B: Board>(board: &B, settings: &Settings, reason: ResetReason) {
    info!("board {=str}, counter {=u32} Hz", board.name(), B::COUNTER_HZ);
    match reason {
        ResetReason::PowerOn => info!("reset: power-on"),
        ResetReason::Watchdog => error!("reset: watchdog"),
        ResetReason::Fault(Fault::Panic { line }) => error!("reset: panic at line {=u32}", line),
        ResetReason::Fault(Fault::StackOverflow { sp }) => {
            error!("reset: stack overflow at {=u32:#010x}", sp)
        }
        ResetReason::Fault(Fault::HardFault { pc }) => error!("reset: hard fault at {=u32:#010x}", pc),
        ResetReason::Fault(Fault::UnexpectedInterrupt { number }) => {
            error!("reset: interrupt {=i32}", number)
        }
    }
    info!("tick {=u32} us", settings.period_us.get());
}

/// Logs an event.
pub fn event(event: &Event) {
    match *event {
        Event::Status { account, outputs, safe } => {
            info!(
                "tick {=u64}: {=u32} mHz of {=u32}, lag {=u64} us, safe {=bool}",
                account.ticks,
                account.actual_millihertz(),
                account.target_millihertz(),
                account.lag_us(),
                safe
            );
            counts("tick", account.tick_counts);
            counts("step", account.step_counts);
            let late = account.lateness_us;
            info!("late {=u32}/{=u32}/{=u32} us", late.min(), late.mean(), late.max());
            info!("outputs {}", outputs);
        }
        Event::Overrun { tick, skipped } => warn!("tick {=u64} overran, {=u32} skipped", tick, skipped),
        Event::Safe { tick, cause } => match cause {
            Cause::Reset => error!("safe from tick {=u64}: the last run did not end well", tick),
            Cause::Overruns { in_a_row } => {
                error!("safe from tick {=u64}: {=u32} overruns in a row", tick, in_a_row)
            }
            Cause::Lag { lag_us } => error!("safe from tick {=u64}: {=u64} us behind", tick, lag_us),
            Cause::Plant { element } => {
                error!("safe from tick {=u64}: element {=u16} broke down", tick, element)
            }
        },
        Event::Ended { account, state_hash, safe } => {
            info!(
                "ended after {=u64} ticks, {=u64} us of plant time in {=u64} us, safe {=bool}",
                account.ticks,
                account.plant_us(),
                account.wall_us(),
                safe
            );
            info!(
                "overruns {=u32}, {=u32} in start-up, {=u32} in a row, skipped {=u64}",
                account.overruns,
                account.startup_overruns,
                account.worst_consecutive_overruns,
                account.skipped
            );
            info!("state {=u32:08x}", state_hash);
        }
    }
}

/// Logs how deep the stack has been.
pub fn stack(stack: StackUse) {
    info!("stack {=u32} of {=u32} bytes", stack.deepest, stack.size);
}

/// Logs events that had no room in the queue.
pub fn lost(events: u32) {
    warn!("{=u32} events lost", events);
}

fn counts(name: &str, spread: crate::account::Spread) {
    info!("{=str} {=u32}/{=u32}/{=u32} counts", name, spread.min(), spread.mean(), spread.max());
}
