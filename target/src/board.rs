//! The one seam between the application and a board.

use crate::account::Account;
use crate::coupling::Coupling;
use eclss_core::mode::{Machine, Request};
use eclss_core::process::{CONVERTERS, Direction, Force};
use embassy_time::{Instant, Timer};

/// Raw counts by the converter's number.
pub type Converters = [Option<f32>; CONVERTERS];

/// Why the processor started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetReason {
    /// Power came on or someone pressed reset.
    PowerOn,
    /// The watchdog was not fed in time.
    Watchdog,
    /// The firmware stopped itself; the record says what it had noted before.
    Fault(crate::fault::Fault),
}

/// How much of the stack has ever been used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StackUse {
    /// Bytes there are.
    pub size: u32,
    /// Bytes used at the deepest moment since start-up.
    pub deepest: u32,
}

/// A force on a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forcing {
    /// Which way the channel goes.
    pub direction: Direction,
    /// Its number in the process image.
    pub channel: u16,
    /// Value in its place.
    pub force: Force,
}

/// What the loop needs of a board. No method may wait for hardware: a tick must never hang on a peripheral.
pub trait Board {
    /// Rate of [`Board::counter`] \[Hz\].
    const COUNTER_HZ: u32;
    /// Bytes of the link that are looked at in a tick, where its session needs no more to keep step with its peer.
    const LINK_BYTES: usize = 256;

    /// The board's name, as `cargo xtask` knows it.
    fn name(&self) -> &'static str;
    /// Time since start-up \[µs\].
    fn now_us(&self) -> u64 {
        Instant::now().as_micros()
    }
    /// Sleeps until `at_us` \[µs since start-up\]; not at all when that is past.
    fn sleep_until(&mut self, at_us: u64) -> impl Future<Output = ()> {
        Timer::at(Instant::from_micros(at_us))
    }
    /// A free-running counter for execution times; wraps.
    fn counter(&self) -> u32;
    /// Fills in the newest raw count of each converter, by its number. Those that the board does not have stay `None`.
    fn read_inputs(&mut self, converters: &mut Converters);
    /// Hands over one raw count per converter, where there is one; `armed` says whether the plant drives them.
    fn write_outputs(&mut self, converters: &Converters, armed: bool);
    /// Leaves out what has waited longest at the link, by whole frames, until at most `keep` bytes wait. A board whose
    /// link is no faster than its loop has nothing to leave out.
    fn skip_link(&mut self, _keep: usize) {}
    /// Takes what has come over the link, as much as `bytes` holds; returns how much. Without a link, nothing.
    fn read_link(&mut self, _bytes: &mut [u8]) -> usize {
        0
    }
    /// Hands over bytes for the link; returns how many were taken. The rest is offered again.
    fn write_link(&mut self, bytes: &[u8]) -> usize {
        bytes.len()
    }
    /// What an operator at this board asks for, once; nobody is there on most boards.
    fn request(&mut self) -> Option<Request> {
        None
    }
    /// Value that an operator at this board forces on a channel, once.
    fn force(&mut self) -> Option<Forcing> {
        None
    }
    /// Shows how the tick went, when it is over, to a board that displays it; nothing to write on one that does not.
    fn observe(&mut self, _account: &Account, _machine: &Machine, _coupling: &Coupling<'_>) {}
    /// Puts every output into the state in which connected hardware is harmless. May be called at any time
    /// and any number of times.
    fn safe_outputs(&mut self);
    /// Tells the watchdog that the loop lives; called once a tick.
    fn feed_watchdog(&mut self);
}
