//! The clock tree: 8 MHz from the debug probe to 480 MHz.

use embassy_stm32::Config;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, HSIPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource,
    Sysclk, VoltageScale, mux,
};
use embassy_stm32::time::Hertz;

/// 8 MHz / 1 × 120 / 2 = 480 MHz for the processor, 240 MHz for buses, 120 MHz for peripherals.
pub(super) fn config() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    // The probe's clock comes as a square wave, not as a crystal.
    rcc.hse = Some(Hse { freq: Hertz(8_000_000), mode: HseMode::Bypass });
    // The converters' clock, independent of the processor's.
    rcc.hsi = Some(HSIPrescaler::DIV1);
    rcc.mux.adcsel = mux::Adcsel::PER;
    rcc.pll1 = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV1,
        mul: PllMul::MUL120,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV8),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    // Only this scale allows more than 400 MHz.
    rcc.voltage_scale = VoltageScale::Scale0;
    config
}
