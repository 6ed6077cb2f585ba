//! The computer as a board of the loop: its clock, its link, and what it measures of every tick.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::time::Duration;

use eclss_core::mode::{Machine, Mode, Request};
use eclss_target::account::Account;
use eclss_target::board::{Board, Converters, Forcing};
use eclss_target::coupling::Coupling;
use rtrb::Consumer;

use super::pace::{Clock, Pace, sleep_until_wall, wall_ns};
use super::tap::Tap;
use super::timing::Times;
use eclss_target::wire::{Link, LinkCounts};

/// Forces that may wait for their ticks.
const FORCES: usize = 64;
/// How often a clock that stands looks for orders [ns].
const PAUSE_NS: u64 = 1_000_000;

/// What an operator asks of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Something in a channel's place.
    Force(Forcing),
    /// A change of mode.
    Mode(Request),
    /// Another pace.
    Pace(Pace),
    /// So many ticks of a clock that stands.
    Ticks(u32),
    /// The end.
    Quit,
}

/// A tick that is made too long on purpose, to see that it is noticed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stall {
    /// The tick, from 0.
    pub tick: u64,
    /// By how much.
    pub by: Duration,
}

/// What the board measured.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// From a tick's release to its begin.
    pub wake: Times,
    /// From a tick's begin to its end (TET).
    pub tick: Times,
    /// From reading inputs to giving out the outputs that follow from them.
    pub in_out: Times,
    /// Orders that were refused.
    pub refused: u32,
}

/// The computer.
#[derive(Debug)]
pub struct Pc<'t> {
    clock: Clock,
    start_ns: u64,
    tap: &'t RefCell<Tap>,
    link: Option<Link>,
    orders: Consumer<Order>,
    /// Whether hardware can be armed at all.
    bound: bool,
    latched: bool,
    stall: Option<Stall>,
    request: Option<Request>,
    forces: VecDeque<Forcing>,
    steps: u32,
    quits: bool,
    ticks: u64,
    begun_ns: u64,
    begun_us: u64,
    late_ns: u64,
    read_ns: u64,
    measured: Measured,
}

impl<'t> Pc<'t> {
    /// Makes a board; all of its memory is allocated here.
    pub fn new(
        tap: &'t RefCell<Tap>,
        link: Option<Link>,
        orders: Consumer<Order>,
        (bound, latched): (bool, bool),
        stall: Option<Stall>,
    ) -> Self {
        let clock = Clock::new();
        Self {
            start_ns: clock.now_ns(),
            clock,
            tap,
            link,
            orders,
            bound,
            latched,
            stall,
            request: None,
            forces: VecDeque::with_capacity(FORCES),
            steps: 0,
            quits: false,
            ticks: 0,
            begun_ns: 0,
            begun_us: 0,
            late_ns: 0,
            read_ns: 0,
            measured: Measured::default(),
        }
    }

    /// Sets the pace before the loop begins.
    pub fn start_at(&mut self, pace: Pace) -> Result<(), &'static str> {
        self.clock.set(pace, self.bound)
    }

    /// Ends the last tick, whose successor never came, and returns what was measured.
    pub fn measured(&mut self) -> &Measured {
        self.finish();
        &self.measured
    }

    /// What the link did.
    pub fn link_counts(&self) -> Option<LinkCounts> {
        self.link.as_ref().map(Link::counts)
    }

    /// Hands the tick that has just ended over.
    fn finish(&mut self) {
        if self.begun_ns == 0 {
            return;
        }
        let tick_ns = wall_ns().saturating_sub(self.begun_ns);
        self.measured.tick.add(tick_ns);
        self.tap.borrow_mut().finish(self.ticks, self.begun_us, self.late_ns, tick_ns);
        self.ticks += 1;
        self.begun_ns = 0;
    }

    /// Takes the orders that have come.
    fn take_orders(&mut self) {
        let armed = self.bound && self.tap.borrow().present_mode().is_armed();
        // One request a tick: what a second one finds is the mode that the first has made. A clock that stands does none.
        while self.request.is_none() || self.clock.pace() == Pace::Paused {
            let Ok(order) = self.orders.pop() else { break };
            match order {
                Order::Quit => self.quits = true,
                // Within what was made room for, because nothing is allocated here.
                Order::Force(forcing) if self.forces.len() < FORCES => self.forces.push_back(forcing),
                Order::Mode(_) if self.request == Some(Request::Stop) => {}
                Order::Mode(request) => self.request = Some(request),
                Order::Pace(pace) => {
                    self.measured.refused += u32::from(self.clock.set(pace, armed).is_err());
                }
                Order::Ticks(ticks) if self.clock.pace() == Pace::Paused => self.steps += ticks,
                Order::Force(_) | Order::Ticks(_) => self.measured.refused += 1,
            }
        }
        if armed && self.clock.pace() != Pace::Real {
            // Armed at another pace: from now on time is the wall's, which is never refused.
            let _ = self.clock.set(Pace::Real, armed);
        }
    }
}

impl Board for Pc<'_> {
    const COUNTER_HZ: u32 = 1_000_000_000;
    // Some 50 µs of work: a controller that sends sixty frames a tick loses no command.
    const LINK_BYTES: usize = 4_096;

    fn name(&self) -> &'static str {
        "pc"
    }

    fn now_us(&self) -> u64 {
        self.clock.now_ns().saturating_sub(self.start_ns) / 1_000
    }

    /// Blocks the thread, which is the loop's own. Never ready again once the end was ordered.
    async fn sleep_until(&mut self, at_us: u64) {
        self.finish();
        self.take_orders();
        while self.clock.pace() == Pace::Paused && self.steps == 0 && !self.quits {
            sleep_until_wall(wall_ns() + PAUSE_NS);
            self.take_orders();
        }
        if self.quits {
            core::future::pending::<()>().await;
        }
        self.steps = self.steps.saturating_sub(1);
        self.late_ns = self.clock.sleep_until(self.start_ns + at_us * 1_000);
        self.begun_ns = wall_ns();
        self.begun_us = self.now_us();
        self.measured.wake.add(self.late_ns);
    }

    fn counter(&self) -> u32 {
        wall_ns() as u32
    }

    fn read_inputs(&mut self, _converters: &mut Converters) {}

    fn write_outputs(&mut self, _converters: &Converters, _armed: bool) {
        let now = wall_ns();
        if self.read_ns > 0 {
            self.measured.in_out.add(now.saturating_sub(self.read_ns));
        }
        // Latched, this comes right after reading, and the outputs belong to what the tick before has read.
        self.read_ns = if self.latched { self.begun_ns } else { 0 };
    }

    fn skip_link(&mut self, keep: usize) {
        if let Some(link) = &mut self.link {
            link.skip(keep);
        }
    }

    fn read_link(&mut self, bytes: &mut [u8]) -> usize {
        self.link.as_mut().map_or(0, |link| link.read(bytes))
    }

    fn write_link(&mut self, bytes: &[u8]) -> usize {
        self.link.as_mut().map_or(bytes.len(), |link| link.write(bytes))
    }

    fn force(&mut self) -> Option<Forcing> {
        self.forces.pop_front()
    }

    fn request(&mut self) -> Option<Request> {
        self.request.take()
    }

    fn observe(&mut self, account: &Account, machine: &Machine, coupling: &Coupling<'_>) {
        self.tap.borrow_mut().observe(account, machine, coupling);
    }

    fn safe_outputs(&mut self) {}

    /// The first thing in a tick: the watchdog is the kernel's, but here the tick is stalled where that was asked for.
    fn feed_watchdog(&mut self) {
        if let Some(stall) = self.stall.filter(|stall| stall.tick == self.ticks) {
            let until = wall_ns() + stall.by.as_nanos() as u64;
            while wall_ns() < until {}
        }
        if !self.latched {
            self.read_ns = wall_ns();
        }
    }
}

/// What the loop tells, taken note of for the present tick.
pub fn note(tap: &RefCell<Tap>, event: &eclss_target::control::Event) {
    use eclss_target::control::Event;
    let mut tap = tap.borrow_mut();
    match event {
        Event::Overrun { skipped, .. } => tap.skipped(*skipped),
        Event::Mode { to, .. } => tap.mode(*to),
        Event::Safe { .. } => tap.mode(Mode::Safe),
        Event::Status { mode, .. } | Event::Ended { mode, .. } => tap.mode(*mode),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};
    use rtrb::RingBuffer;

    /// Goes through the begin of one tick, which was due at once.
    fn tick(board: &mut Pc<'_>) -> Poll<()> {
        let at_us = board.now_us();
        let slept = pin!(board.sleep_until(at_us));
        slept.poll(&mut Context::from_waker(Waker::noop()))
    }

    #[test]
    fn a_clock_that_stands_gives_out_ticks_by_number_and_ends_on_order() {
        let tap = Tap::new(Vec::new(), 0, None, None);
        let (mut orders, taken) = RingBuffer::new(8);
        let mut board = Pc::new(&tap, None, taken, (false, true), None);
        for order in [Order::Ticks(1), Order::Pace(Pace::Paused), Order::Ticks(3)] {
            orders.push(order).unwrap();
        }
        for _ in 0..3 {
            assert_eq!(tick(&mut board), Poll::Ready(()));
        }
        orders.push(Order::Quit).unwrap();
        assert_eq!(tick(&mut board), Poll::Pending);
        let measured = board.measured();
        assert_eq!((measured.wake.summary().count, measured.tick.summary().count), (3, 3));
        assert_eq!(measured.refused, 1, "ticks of a clock that runs");
    }

    /// Nobody makes armed hardware wait: the pace stays, and one that was set before ends.
    #[test]
    fn with_hardware_armed_only_the_walls_time_is_taken() {
        let tap = Tap::new(Vec::new(), 0, None, None);
        let (mut orders, taken) = RingBuffer::new(8);
        let mut board = Pc::new(&tap, None, taken, (true, true), None);
        orders.push(Order::Pace(Pace::Scaled(50.0))).unwrap();
        assert_eq!(tick(&mut board), Poll::Ready(()));
        assert_eq!(board.clock.pace(), Pace::Scaled(50.0));
        tap.borrow_mut().mode(Mode::Run);
        assert_eq!(tick(&mut board), Poll::Ready(()));
        assert_eq!(board.clock.pace(), Pace::Real);
        for order in [Order::Pace(Pace::Paused), Order::Pace(Pace::Scaled(0.5)), Order::Ticks(1)] {
            orders.push(order).unwrap();
        }
        assert_eq!(tick(&mut board), Poll::Ready(()));
        assert_eq!((board.clock.pace(), board.measured().refused), (Pace::Real, 3));
    }

    #[test]
    fn a_request_is_asked_once() {
        let tap = Tap::new(Vec::new(), 0, None, None);
        let (mut orders, taken) = RingBuffer::new(8);
        let mut board = Pc::new(&tap, None, taken, (true, true), None);
        orders.push(Order::Mode(Request::Hold)).unwrap();
        assert_eq!(tick(&mut board), Poll::Ready(()));
        assert_eq!((board.request(), board.request()), (Some(Request::Hold), None));
    }
}
