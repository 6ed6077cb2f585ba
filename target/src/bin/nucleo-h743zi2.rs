//! The firmware for a NUCLEO-H743ZI2.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    eclss_target::boards::nucleo_h743zi2::start()
}
