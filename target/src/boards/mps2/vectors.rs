//! Interrupt vectors: there is no device crate for these boards, so the table is written here.
#![allow(unsafe_code, reason = "a vector table is placed by the linker and read by the processor")]

use super::{timer, uart};
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

/// Number of an interrupt line.
#[derive(Clone, Copy)]
pub(super) struct Irq(u16);

impl Irq {
    pub(super) const UART0_RECEIVED: Self = Self(0);
    pub(super) const TIMER0: Self = Self(8);
    pub(super) const TIMER1: Self = Self(9);
    /// No device uses it: it runs the executor.
    pub(super) const SPARE: Self = Self(31);

    pub(super) fn unmask(self) {
        // SAFETY: all handlers are in the table before any line is unmasked, and none relies on a mask.
        unsafe { NVIC::unmask(self) }
    }
}

// SAFETY: `number` is the line's number and never changes.
unsafe impl InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
}

extern "C" fn on_spare() {
    // SAFETY: called from the interrupt that the executor was started with, and from nowhere else.
    unsafe { super::EXECUTOR.on_interrupt() }
}

unsafe extern "C" {
    fn DefaultHandler();
}

/// The processor's table, after its sixteen own entries; cortex-m-rt places it.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = {
    let mut table = [DefaultHandler as unsafe extern "C" fn(); 32];
    table[Irq::UART0_RECEIVED.0 as usize] = uart::on_received;
    table[Irq::TIMER0.0 as usize] = timer::on_alarm;
    table[Irq::TIMER1.0 as usize] = timer::on_wrap;
    table[Irq::SPARE.0 as usize] = on_spare;
    table
};
