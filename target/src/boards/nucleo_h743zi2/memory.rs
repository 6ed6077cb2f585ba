//! What happens to memory before and across a reset.

use crate::board::ResetReason;
use crate::machine;
use core::ptr::{addr_of, addr_of_mut};
use embassy_stm32::pac::RCC;

#[allow(unsafe_code, reason = "symbols of the linker script")]
unsafe extern "C" {
    static mut __itcm_start: u8;
    static __itcm_load: u8;
    static __itcm_size: u8;
}

/// Copies the hot code to where it runs; nothing in it may be called before.
pub(super) fn load_hot_code() {
    // SAFETY: the linker reserves both ranges, with the size as the third symbol's address.
    #[allow(unsafe_code, reason = "code is copied as bytes")]
    unsafe {
        let size = addr_of!(__itcm_size) as usize;
        core::ptr::copy_nonoverlapping(addr_of!(__itcm_load), addr_of_mut!(__itcm_start), size);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Why the processor started; asking forgets it.
pub(super) fn reset_reason() -> ResetReason {
    let flags = RCC.rsr().read();
    RCC.rsr().modify(|w| w.set_rmvf(true));
    // After power-on the record's memory holds noise whose error correction bits do not even match.
    if flags.porrstf() {
        machine::forget_fault();
        return ResetReason::PowerOn;
    }
    let fault = machine::take_fault();
    match fault {
        Some(fault) => ResetReason::Fault(fault),
        None if flags.iwdg1rstf() => ResetReason::Watchdog,
        None => ResetReason::PowerOn,
    }
}
