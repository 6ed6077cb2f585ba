//! The log: what the loop tells, put into words, by defmt on a board and in plain text on a computer.
//!
//! Lines are short on purpose: a defmt frame is written with interrupts off, and would delay a tick.

use crate::account::Spread;
use crate::board::{Board, ResetReason, StackUse};
use crate::control::{Cause, Event, Settings};
use crate::fault::Fault;
#[cfg(target_os = "none")]
use defmt::{error, info, warn};

#[cfg(not(target_os = "none"))]
macro_rules! info { ($($words:tt)*) => { println!("INFO  {}", format_args!($($words)*)) }; }
#[cfg(not(target_os = "none"))]
macro_rules! warn { ($($words:tt)*) => { println!("WARN  {}", format_args!($($words)*)) }; }
#[cfg(not(target_os = "none"))]
macro_rules! error { ($($words:tt)*) => { println!("ERROR {}", format_args!($($words)*)) }; }

/// Logs what is known before the loop starts.
pub fn start<B: Board>(board: &B, network_id: u64, settings: &Settings, reason: ResetReason) {
    info!("board {}, counter {} Hz", board.name(), B::COUNTER_HZ);
    info!("network {:016x}", network_id);
    match reason {
        ResetReason::PowerOn => info!("reset: power-on"),
        ResetReason::Watchdog => error!("reset: watchdog"),
        ResetReason::Fault(Fault::Panic { line }) => error!("reset: panic at line {}", line),
        ResetReason::Fault(Fault::StackOverflow { sp }) => {
            error!("reset: stack overflow at {:#010x}", sp);
        }
        ResetReason::Fault(Fault::HardFault { pc }) => error!("reset: hard fault at {:#010x}", pc),
        ResetReason::Fault(Fault::UnexpectedInterrupt { number }) => {
            error!("reset: interrupt {}", number);
        }
    }
    info!("tick {} us", settings.period_us.get());
}

/// Logs an event.
pub fn event(event: &Event) {
    match *event {
        Event::Status { account, outputs, safe } => {
            info!(
                "tick {}: {} mHz of {}, lag {} us, safe {}",
                account.ticks,
                account.actual_millihertz(),
                account.target_millihertz(),
                account.lag_us(),
                safe
            );
            counts("tick", account.tick_counts);
            counts("step", account.step_counts);
            let late = account.lateness_us;
            info!("late {}/{}/{} us", late.min(), late.mean(), late.max());
            info!("outputs {:?}", outputs);
        }
        Event::Overrun { tick, skipped } => warn!("tick {} overran, {} skipped", tick, skipped),
        Event::Safe { tick, cause } => match cause {
            Cause::Reset => error!("safe from tick {}: the last run did not end well", tick),
            Cause::Overruns { in_a_row } => {
                error!("safe from tick {}: {} overruns in a row", tick, in_a_row);
            }
            Cause::Lag { lag_us } => error!("safe from tick {}: {} us behind", tick, lag_us),
            Cause::Plant(fault) => error!("safe from tick {}: {:?} cannot be trusted", tick, fault.place),
        },
        Event::Ended { account, state_hash, safe } => {
            info!(
                "ended after {} ticks, {} us of plant time in {} us, safe {}",
                account.ticks,
                account.plant_us(),
                account.wall_us(),
                safe
            );
            info!(
                "overruns {}, {} in start-up, {} in a row, skipped {}",
                account.overruns,
                account.startup_overruns,
                account.worst_consecutive_overruns,
                account.skipped
            );
            info!("state {:016x}", state_hash);
        }
    }
}

/// Logs how deep the stack has been.
pub fn stack(stack: StackUse) {
    info!("stack {} of {} bytes", stack.deepest, stack.size);
}

/// Logs events that had no room in the queue.
pub fn lost(events: u32) {
    warn!("{} events lost", events);
}

fn counts(name: &str, spread: Spread) {
    info!("{} {}/{}/{} counts", name, spread.min(), spread.mean(), spread.max());
}
