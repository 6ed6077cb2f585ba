//! Time: CMSDK timer 1 runs freely as the clock, timer 0 is the alarm that wakes the loop.

use super::registers::{CTRL, INTCLEAR, RELOAD, TIMER0, TIMER1, VALUE, read, write};
use super::vectors::Irq;
use core::cell::{Cell, RefCell};
use core::task::Waker;
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// Rate of both timers \[Hz\].
pub(super) const HZ: u32 = 25_000_000;
/// Counts per tick of `embassy-time`, which runs at 1 MHz.
const COUNTS_PER_US: u64 = HZ as u64 / 1_000_000;
/// Timer enabled, interrupt enabled.
const RUN: u32 = 0b1001;
/// The alarm is set again at least this often \[counts\], well below the timer's 32 bits.
const FAR: u64 = 0xF000_0000;

struct Timer {
    /// Upper half of the clock.
    wraps: Mutex<Cell<u32>>,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static TIMER: Timer = Timer {
    wraps: Mutex::new(Cell::new(0)),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

impl Timer {
    /// The clock \[counts since start-up\].
    fn counts(&self, cs: CriticalSection) -> u64 {
        let mut wraps = self.wraps.borrow(cs).get();
        let mut low = counter();
        if read(TIMER1 + INTCLEAR) & 1 != 0 {
            // Wrapped, and the interrupt that counts it has not run yet.
            wraps = wraps.wrapping_add(1);
            low = counter();
        }
        u64::from(wraps) << 32 | u64::from(low)
    }

    /// Wakes whatever is due and sets the alarm for what is next.
    fn set_alarm(&self, cs: CriticalSection) {
        let mut queue = self.queue.borrow(cs).borrow_mut();
        loop {
            let now = self.counts(cs);
            let next_us = queue.next_expiration(now / COUNTS_PER_US);
            write(TIMER0 + CTRL, 0);
            if next_us == u64::MAX {
                return;
            }
            let Some(wait @ 1..) = (next_us * COUNTS_PER_US).checked_sub(now) else { continue };
            write(TIMER0 + RELOAD, 0);
            // The value first: enabling a timer that stands at 0 stops it for good.
            write(TIMER0 + VALUE, wait.min(FAR) as u32);
            write(TIMER0 + CTRL, RUN);
            return;
        }
    }
}

impl Driver for Timer {
    fn now(&self) -> u64 {
        critical_section::with(|cs| self.counts(cs)) / COUNTS_PER_US
    }
    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            if self.queue.borrow(cs).borrow_mut().schedule_wake(at, waker) {
                self.set_alarm(cs);
            }
        });
    }
}

/// Lower half of the clock \[counts\], wrapping every 172 s. The timer counts down.
pub(crate) fn counter() -> u32 {
    !read(TIMER1 + VALUE)
}

/// Starts the clock.
pub(crate) fn init() {
    write(TIMER1 + CTRL, 0);
    write(TIMER1 + RELOAD, u32::MAX);
    write(TIMER1 + VALUE, u32::MAX);
    write(TIMER1 + INTCLEAR, 1);
    write(TIMER1 + CTRL, RUN);
    Irq::TIMER0.unmask();
    Irq::TIMER1.unmask();
}

pub(super) extern "C" fn on_alarm() {
    critical_section::with(|cs| {
        write(TIMER0 + INTCLEAR, 1);
        TIMER.set_alarm(cs);
    });
}

pub(super) extern "C" fn on_wrap() {
    critical_section::with(|cs| {
        write(TIMER1 + INTCLEAR, 1);
        let wraps = TIMER.wraps.borrow(cs);
        wraps.set(wraps.get().wrapping_add(1));
    });
}
