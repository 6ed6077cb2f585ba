//! Access to the boards' memory-mapped registers: the one place with raw addresses.
#![allow(unsafe_code, reason = "registers are reached by address")]

/// CMSDK timer 0: the alarm.
pub(super) const TIMER0: u32 = 0x4000_0000;
/// CMSDK timer 1: the free-running clock.
pub(super) const TIMER1: u32 = 0x4000_1000;
/// Timer registers, relative to a timer.
pub(super) const CTRL: u32 = 0x0;
pub(super) const VALUE: u32 = 0x4;
pub(super) const RELOAD: u32 = 0x8;
pub(super) const INTCLEAR: u32 = 0xC;
/// CMSDK UART 0.
pub(super) const UART_DATA: u32 = 0x4000_4000;
pub(super) const UART_STATE: u32 = 0x4000_4004;
pub(super) const UART_CTRL: u32 = 0x4000_4008;
pub(super) const UART_INTERRUPT: u32 = 0x4000_400C;
pub(super) const UART_BAUD: u32 = 0x4000_4010;
/// LEDs of the FPGA's I/O block.
pub(super) const LED: u32 = 0x4002_8000;

/// Reads one of the registers above.
pub(super) fn read(register: u32) -> u32 {
    // SAFETY: the addresses are device registers of both boards; reading has no effect on memory.
    unsafe { (register as *const u32).read_volatile() }
}

/// Writes one of the registers above.
pub(super) fn write(register: u32, value: u32) {
    // SAFETY: the addresses are device registers of both boards, none of which accesses memory.
    unsafe { (register as *mut u32).write_volatile(value) }
}
