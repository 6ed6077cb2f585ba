//! Counts the instructions of a day of temperature and humidity control on QEMU's MPS2 boards, see `eclss_target::measure`.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    eclss_target::measure::start()
}
