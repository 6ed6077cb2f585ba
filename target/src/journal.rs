//! The log: what the loop tells, put into words, by defmt on a board and in plain text on a computer.
//!
//! Lines are short on purpose: a defmt frame is written with interrupts off, and would delay a tick.

use crate::account::Spread;
use crate::board::{Board, ResetReason, StackUse};
use crate::control::{Cause, Event, SHOWN_OUTPUTS, Settings};
use crate::coupling::LinkReport;
use crate::display;
use crate::fault::Fault;
use crate::network::NetworkPlant;
#[cfg(target_os = "none")]
use defmt::{error, info, warn};

#[cfg(not(target_os = "none"))]
macro_rules! info { ($($words:tt)*) => { println!("INFO  {}", format_args!($($words)*)) }; }
#[cfg(not(target_os = "none"))]
macro_rules! warn { ($($words:tt)*) => { println!("WARN  {}", format_args!($($words)*)) }; }
#[cfg(not(target_os = "none"))]
macro_rules! error { ($($words:tt)*) => { println!("ERROR {}", format_args!($($words)*)) }; }

/// Writes the log of one run.
pub struct Journal {
    /// Names of the lines, where they are known.
    line_names: &'static [&'static str],
    /// Counts of the board's counter in a period.
    period_counts: u32,
    /// Flows at the last status.
    flows: [f32; SHOWN_OUTPUTS],
}

impl Journal {
    /// Logs what is known before the loop starts.
    pub fn start<B: Board>(
        board: &B,
        plant: &NetworkPlant,
        settings: &Settings,
        reason: ResetReason,
    ) -> Self {
        let period_us = settings.period_us.get();
        let run = plant.settings();
        info!("board {}, counter {} Hz", board.name(), B::COUNTER_HZ);
        info!("network {} {:016x}", plant.name(), plant.network_id());
        info!("method {}, step {} us", run.method.name(), run.step_us);
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
        info!("tick {} us", period_us);
        let period_counts = u64::from(B::COUNTER_HZ) * u64::from(period_us) / 1_000_000;
        Self {
            line_names: plant.line_names(),
            period_counts: u32::try_from(period_counts).unwrap_or(u32::MAX).max(1),
            flows: [f32::NAN; SHOWN_OUTPUTS],
        }
    }

    /// Logs an event.
    pub fn event(&mut self, event: &Event) {
        match *event {
            Event::Status { account, outputs, mode, link } => {
                info!(
                    "tick {}: {} mHz of {}, lag {} us, {}",
                    account.ticks,
                    account.actual_millihertz(),
                    account.target_millihertz(),
                    account.lag_us(),
                    mode.name()
                );
                self.counts("tick", account.tick_counts);
                self.counts("step", account.step_counts);
                if let Some(link) = link {
                    self.counts("link", account.link_counts);
                    link_state(&link);
                }
                let late = account.lateness_us;
                info!("late {}/{}/{} us", late.min(), late.mean(), late.max());
                self.flows(outputs);
            }
            Event::Overrun { tick, skipped } => warn!("tick {} overran, {} skipped", tick, skipped),
            Event::Mode { tick, from, to } => info!("mode {} to {} at tick {}", from.name(), to.name(), tick),
            Event::Safe { tick, cause } => safe(tick, cause),
            Event::Ended { account, state_hash, values_hash, mode, link } => {
                info!(
                    "ended after {} ticks, {} us of plant time in {} us, {}",
                    account.ticks,
                    account.plant_us(),
                    account.wall_us(),
                    mode.name()
                );
                if let Some(link) = link {
                    link_state(&link);
                }
                info!(
                    "overruns {}, {} in start-up, {} in a row, skipped {}",
                    account.overruns,
                    account.startup_overruns,
                    account.worst_consecutive_overruns,
                    account.skipped
                );
                info!("state {:016x}, values {:016x}", state_hash, values_hash);
            }
        }
    }

    /// Smallest, mean and largest, and the largest as part of the period.
    fn counts(&self, name: &str, spread: Spread) {
        let (min, mean, max) = (spread.min(), spread.mean(), spread.max());
        let share = u64::from(max) * 1_000 / u64::from(self.period_counts);
        info!("{} {}/{}/{} counts, {} of 1000 of the period", name, min, mean, max, share);
    }

    /// Flows, and how far the fastest of them has changed since the last status as part of the largest.
    fn flows(&mut self, flows: [f32; SHOWN_OUTPUTS]) {
        let (mut largest, mut change) = (0.0_f32, 0.0_f32);
        for (index, (flow, last)) in
            flows.into_iter().zip(self.flows).enumerate().filter(|(_, (w, _))| w.is_finite())
        {
            if let Some(name) = self.line_names.get(index) {
                info!("flow {} {} kg/s", *name, flow);
            } else {
                info!("flow of line {} {} kg/s", index, flow);
            }
            largest = largest.max(flow.abs());
            change = change.max((flow - last).abs());
        }
        if self.flows[0].is_finite() && largest > 0.0 {
            info!("change {} dB", display::level_db(change / largest) as i32);
        }
        self.flows = flows;
    }
}

fn safe(tick: u64, cause: Cause) {
    match cause {
        Cause::Reset => error!("safe from tick {}: the last run did not end well", tick),
        Cause::Overruns { in_a_row } => error!("safe from tick {}: {} overruns in a row", tick, in_a_row),
        Cause::Lag { lag_us } => error!("safe from tick {}: {} us behind", tick, lag_us),
        Cause::Silence { ticks } => error!("safe from tick {}: {} ticks of silence", tick, ticks),
        Cause::Input { channel } => error!("safe from tick {}: input {} lost", tick, channel),
        Cause::Operator => warn!("safe from tick {}: asked for", tick),
        Cause::Plant(fault) => error!("safe from tick {}: {:?} cannot be trusted", tick, fault.place),
    }
}

/// Logs what became of each frame.
fn link_state(link: &LinkReport) {
    let c = link.counters;
    info!("link up {}, {} sessions, silent {}", link.connected, c.sessions, link.silence);
    info!("sent {}, no room for {}", link.sent, c.unsent);
    info!("frames {}, taken {}, handshake {}, lost {}", c.frames(), c.accepted, c.handshake, c.lost);
    info!("late {}, twice {}, damaged {}, foreign {}", c.late, c.duplicate, c.damaged(), c.foreign());
}

/// Logs the id of the process image, which the other end of the link has to know.
pub fn process(id: u64) {
    info!("process image {:016x}", id);
}

/// Logs how deep the stack has been.
pub fn stack(stack: StackUse) {
    info!("stack {} of {} bytes", stack.deepest, stack.size);
}

/// Logs events that had no room in the queue.
pub fn lost(events: u32) {
    warn!("{} events lost", events);
}
