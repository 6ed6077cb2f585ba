//! What happens beside the loop and never holds it up: record, display, operator.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use eclss_core::Settings;
use eclss_core::mode::{Cause, Mode, Request};
use eclss_target::account::Account;
use eclss_target::control::Event;
use rtrb::{Consumer, Producer};

use super::{Job, Outcome, Seen, cause, told};
use crate::Failure;
use crate::hil::arming::Arming;
use crate::hil::board::Order;
use crate::hil::force::Channels;
use crate::hil::handover::Taker;
use crate::hil::operator::{interrupts, type_along};
use crate::hil::pace::Pace;
use crate::hil::page::Page;
use crate::hil::recorder::Recorder;
use crate::hil::report::RecordFigures;
use crate::hil::shot::Album;

/// Status events between two lines of the display, and between two attempts to arm.
const SHOW_EVERY: u32 = 10;

/// Time between two moments at which the record is handed to the system.
const FLUSH: Duration = Duration::from_secs(1);
/// Typed orders that may wait for the loop.
const FEW_ORDERS: usize = 4;

/// The other side of the loop's rings.
pub(super) struct Housekeeping<'o> {
    out: &'o mut dyn Write,
    shows: bool,
    channels: Channels,
    arming: Arming,
    recorder: Option<Recorder>,
    /// Why the record ended early.
    failed: Option<Failure>,
    rows: Option<Taker>,
    flushed: Instant,
    events: Consumer<Event>,
    orders: Producer<Order>,
    typed: Option<Receiver<String>>,
    /// Set by an interrupt.
    interrupted: Arc<AtomicBool>,
    account: Option<Account>,
    mode: Mode,
    cause: Option<Cause>,
    until_shown: u32,
    begun_us: u64,
    page: Option<(Page, Album)>,
}

impl<'o> Housekeeping<'o> {
    #[allow(clippy::too_many_arguments, reason = "each is a part that the runner owns")]
    pub(super) fn new(
        out: &'o mut dyn Write,
        job: &Job,
        channels: Channels,
        recorder: Option<Recorder>,
        rows: Option<Taker>,
        events: Consumer<Event>,
        orders: Producer<Order>,
        page: Option<(Page, Album)>,
    ) -> Self {
        Self {
            out,
            shows: job.shows,
            channels,
            arming: Arming::new(job.arm),
            recorder,
            failed: None,
            rows,
            flushed: Instant::now(),
            events,
            orders,
            typed: job.operator.then(type_along),
            interrupted: if job.interrupts { interrupts() } else { Arc::default() },
            account: None,
            mode: Mode::PowerUp,
            cause: None,
            until_shown: 0,
            begun_us: 0,
            page,
        }
    }

    /// Takes whatever has come.
    pub(super) fn turn(&mut self) {
        while let Ok(event) = self.events.pop() {
            self.event(event);
        }
        self.record();
        if let Some((page, album)) = &mut self.page {
            album.look(|shot| page.show(shot));
        }
        self.take_orders();
        // The ring is never full for long: typed orders leave room.
        if self.interrupted.load(Ordering::Relaxed) && self.orders.push(Order::Quit).is_ok() {
            self.interrupted.store(false, Ordering::Relaxed);
        }
    }

    /// Writes down what has come, and once a second hands it to the system, for whom the end of this program is none.
    fn record(&mut self) {
        let Some(rows) = &mut self.rows else { return };
        let mut done = Ok(());
        while let Some(row) = rows.take() {
            self.begun_us = row.head.begun_us;
            if let Some(recorder) = self.recorder.as_mut().filter(|_| done.is_ok()) {
                done = recorder.row(row);
            }
        }
        if let Some(recorder) = self.recorder.as_mut().filter(|_| done.is_ok())
            && self.flushed.elapsed() >= FLUSH
        {
            self.flushed = Instant::now();
            done = recorder.flush();
        }
        if let Err(failure) = done {
            // The loop goes on: hardware does not care for the record.
            self.recorder = None;
            self.show(&format!("the record ends here: {failure}"));
            self.failed = Some(failure);
        }
    }

    fn event(&mut self, event: Event) {
        match event {
            Event::Status { account, mode, .. } => {
                (self.account, self.mode) = (Some(account), mode);
                self.arming.observe(mode);
                let due = self.until_shown == 0;
                self.until_shown = if due { SHOW_EVERY } else { self.until_shown } - 1;
                if due {
                    if self.arming.is_due(mode) {
                        self.order(Order::Mode(Request::Arm));
                    }
                    self.show_status(&event);
                }
            }
            Event::Overrun { tick, skipped } => {
                self.say(tick, &format!("tick {tick} overran, {skipped} releases skipped"));
            }
            Event::Mode { tick, from, to } => {
                (self.mode, self.cause) = (to, None);
                self.arming.observe(to);
                self.say(tick, &format!("{} → {}", from.name(), to.name()));
            }
            Event::Safe { tick, cause: why } => {
                let from = self.mode.name();
                (self.mode, self.cause) = (Mode::Safe, Some(why));
                self.arming.observe(Mode::Safe);
                self.say(tick, &format!("{from} → SAFE: {}", cause(why)));
            }
            Event::Ended { account, mode, .. } => (self.account, self.mode) = (Some(account), mode),
        }
    }

    fn show_status(&mut self, event: &Event) {
        let Event::Status { account, mode, link, .. } = event else { return };
        if !self.shows {
            return;
        }
        let us = |counts: u32| f64::from(counts) / 1e3;
        let link = link.map_or(String::new(), |link| {
            let state = if link.connected { "up" } else { "down" };
            format!(", link {state}, {} lost, {} damaged", link.counters.lost, link.counters.damaged())
        });
        let _ = writeln!(
            self.out,
            "{:>9.1} s  {:<7} {:.1} Hz, tick {:.1}/{:.1} µs mean/max, late by {} µs at most, overruns {}, lag {} \
             µs{link}",
            account.plant_us() as f64 * 1e-6,
            mode.name(),
            f64::from(account.actual_millihertz()) / 1e3,
            us(account.tick_counts.mean()),
            us(account.tick_counts.max()),
            account.lateness_us.max(),
            account.overruns,
            account.lag_us()
        );
        let _ = self.out.flush();
    }

    fn say(&mut self, tick: u64, text: &str) {
        if let Some(recorder) = &mut self.recorder
            && let Err(failure) = recorder.event(self.begun_us, tick, text)
        {
            self.failed = Some(failure);
            self.recorder = None;
        }
        self.show(text);
    }

    fn show(&mut self, text: &str) {
        if self.shows {
            // Who does not read our output does not stop hardware.
            let _ = writeln!(self.out, "            {text}");
        }
    }

    /// Takes a line, unless the loop has not done the last few: whoever types without end is slowed down.
    fn take_orders(&mut self) {
        let Some(typed) = &self.typed else { return };
        if self.orders.slots() > self.orders.buffer().capacity().saturating_sub(FEW_ORDERS) {
            match typed.try_recv() {
                Ok(line) => match parse(line.trim()) {
                    Some(order) => {
                        if let Order::Mode(request) = order {
                            self.arming.request(request);
                        }
                        self.order(order);
                    }
                    None if line.trim().is_empty() => {}
                    None if self.force(line.trim()) => {}
                    None => self.show(ORDERS),
                },
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => self.typed = None,
            }
        }
    }

    /// Does an order that forces a channel or releases it; returns whether it was one. What is forced is in the record.
    fn force(&mut self, line: &str) -> bool {
        match self.channels.read(line) {
            None => return false,
            Some(Err(why)) => self.show(&why),
            Some(Ok(forcing)) => {
                self.say(0, &format!("operator: {line}"));
                self.order(Order::Force(forcing));
            }
        }
        true
    }

    fn order(&mut self, order: Order) {
        if self.orders.push(order).is_err() {
            self.say(0, "the loop takes no orders");
        }
    }

    /// Ends the record and returns what was seen.
    pub(super) fn end(mut self, outcome: &Outcome, settings: Settings) -> Result<Seen, Failure> {
        let mut record = None;
        if let Some(recorder) = self.recorder.take() {
            let (rows, captures) = (recorder.taken(), recorder.captures());
            let mut run = told(settings);
            run.extend([
                ("steps".to_owned(), outcome.plant_ticks.to_string()),
                ("state_hash".to_owned(), format!("{:016x}", outcome.state_hash)),
                ("mode".to_owned(), self.mode.name().to_owned()),
            ]);
            let files = recorder.finish(run, outcome.dropped)?;
            let files = files.iter().map(|file| file.display().to_string()).collect();
            record = Some(RecordFigures { files, rows, dropped: outcome.dropped, captures });
        }
        match self.failed {
            Some(failure) => Err(failure),
            None => Ok(Seen { account: self.account, mode: self.mode, cause: self.cause, record }),
        }
    }
}

const ORDERS: &str = "orders are settle, arm, hold, resume, disarm, acknowledge, restart, stop, quit, force, release; and while no hardware is \
                      armed: pause, step [N], go, speed X, speed max";

/// Reads an order.
fn parse(line: &str) -> Option<Order> {
    let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
    Some(match (word, rest.trim()) {
        ("arm", "") => Order::Mode(Request::Arm),
        ("hold", "") => Order::Mode(Request::Hold),
        ("resume", "") => Order::Mode(Request::Resume),
        ("disarm", "") => Order::Mode(Request::Disarm),
        ("acknowledge", "") => Order::Mode(Request::Acknowledge),
        ("restart", "") => Order::Mode(Request::Restart),
        ("stop", "") => Order::Mode(Request::Stop),
        ("settle", "") => Order::Mode(Request::Settle),
        ("quit", "") => Order::Quit,
        ("pause", "") => Order::Pace(Pace::Paused),
        ("go", "") => Order::Pace(Pace::Real),
        ("step", "") => Order::Ticks(1),
        ("step", ticks) => Order::Ticks(ticks.parse().ok()?),
        ("speed", "max") => Order::Pace(Pace::Scaled(f64::INFINITY)),
        ("speed", speed) => Order::Pace(Pace::Scaled(speed.parse().ok()?)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read() {
        assert_eq!(parse("arm"), Some(Order::Mode(Request::Arm)));
        assert_eq!(parse("step 12"), Some(Order::Ticks(12)));
        assert_eq!(parse("step"), Some(Order::Ticks(1)));
        assert_eq!(parse("speed 2.5"), Some(Order::Pace(Pace::Scaled(2.5))));
        assert_eq!(parse("speed max"), Some(Order::Pace(Pace::Scaled(f64::INFINITY))));
        for wrong in ["", "fly", "arm now", "step x", "speed"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
