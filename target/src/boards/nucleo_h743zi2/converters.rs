//! Analogue inputs and outputs, without a single wait in the loop.

use crate::board::Converters;
use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AdcChannel, Instance, SampleTime};
use embassy_stm32::dac::Dac;
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::adc::vals::{Exten, Ovrmod};
use embassy_stm32::pac::timer::vals::Mms;
use embassy_stm32::pac::{self, adc};
use embassy_stm32::peripherals::{ADC1, ADC2, DAC1, PA3, PA4, PA5, PC0, TIM6};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{RoundTo, Timer};

/// Largest count of the 12-bit output converters.
const FULL_OUT: f32 = 4_095.0;
/// Samples per second: several per tick, so that none is old.
const SAMPLE_RATE: Hertz = Hertz(10_000);
/// Timer 6 in the list of converter triggers (RM0433, external triggers for regular channels).
const TRIGGER_TIMER6: u8 = 13;

/// Two converters that sample on timer 6 and always hold their newest result.
pub(super) struct Inputs {
    _converters: (Adc<'static, ADC1>, Adc<'static, ADC2>),
    _timer: Timer<'static, TIM6>,
}

impl Inputs {
    pub(super) fn new(
        adc1: Peri<'static, ADC1>,
        adc2: Peri<'static, ADC2>,
        timer: Peri<'static, TIM6>,
        mut pin1: Peri<'static, PA3>,
        mut pin2: Peri<'static, PC0>,
    ) -> Self {
        let first = prepare(Adc::new(adc1), &mut pin1, pac::ADC1);
        let second = prepare(Adc::new(adc2), &mut pin2, pac::ADC2);
        let timer = Timer::new(timer);
        timer.set_frequency(SAMPLE_RATE, RoundTo::Slower);
        timer.regs_basic().cr2().modify(|w| w.set_mms(Mms::UPDATE));
        timer.start();
        Self { _converters: (first, second), _timer: timer }
    }

    /// Newest counts, 0…65 535 for 0…3.3 V.
    #[allow(clippy::unused_self, reason = "having the converters is the proof that they are set up")]
    pub(super) fn read(&mut self, inputs: &mut Converters) {
        for (input, converter) in inputs.iter_mut().zip([pac::ADC1, pac::ADC2]) {
            *input = Some(f32::from(converter.dr().read().rdata()));
        }
    }
}

/// Selects the pin by one conversion, then leaves the converter to the timer. A result that nobody has read is
/// overwritten by the next.
fn prepare<T: Instance<Regs = adc::Adc>>(
    mut converter: Adc<'static, T>,
    pin: &mut impl AdcChannel<T>,
    registers: adc::Adc,
) -> Adc<'static, T> {
    converter.blocking_read(pin, SampleTime::CYCLES32_5);
    registers.cfgr().modify(|w| {
        w.set_extsel(TRIGGER_TIMER6);
        w.set_exten(Exten::RISING_EDGE);
        w.set_ovrmod(Ovrmod::OVERWRITE);
    });
    registers.cr().modify(|w| w.set_adstart(true));
    converter
}

/// Two voltages.
pub(super) struct Outputs {
    _converter: Dac<'static, Blocking>,
}

impl Outputs {
    pub(super) fn new(dac: Peri<'static, DAC1>, pin1: Peri<'static, PA4>, pin2: Peri<'static, PA5>) -> Self {
        Self { _converter: Dac::new_blocking(dac, pin1, pin2) }
    }

    /// Sets counts, 0…4 095 for 0…3.3 V, limited to that.
    #[allow(clippy::unused_self, reason = "having the converter is the proof that it is set up")]
    pub(super) fn write(&mut self, outputs: &Converters) {
        for (channel, count) in outputs.iter().take(2).enumerate() {
            let Some(count) = count else { continue };
            let code = count.clamp(0.0, FULL_OUT) as u16;
            pac::DAC1.dhr12r(channel).write(|w| w.set_dhr(code));
        }
    }
}

/// Both outputs to 0 V; a write that does nothing before the converter is set up.
pub(super) fn outputs_to_zero() {
    for channel in 0..2 {
        pac::DAC1.dhr12r(channel).write(|w| w.set_dhr(0));
    }
}
