//! The firmware for QEMU's `mps2-an386`.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    eclss_target::boards::mps2::start("qemu-mps2-an386")
}
