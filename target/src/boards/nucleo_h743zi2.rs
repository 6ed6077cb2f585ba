//! ST's NUCLEO-H743ZI2: an STM32H743 (Cortex-M7) at 480 MHz from the 8 MHz that its debug probe feeds it.
//!
//! Converters 0 and 1 of the process image are PA3 (A0 on the connector) and PC0 (A1) as inputs, 0…65 535 for
//! 0…3.3 V, and PA4 and PA5 as outputs, 0…4 095 for 0…3.3 V. Two converters sample at 10 kHz, started by timer 6, so the loop finds a sample that
//! is at most 0.1 ms old and never waits for one. The link is USART3, the probe's serial port. The green LED (PB0) is lit while outputs are live.
//!
//! Source: ST UM2407 (board), RM0433 (device).

mod clocks;
mod converters;
mod memory;
mod uart;

use crate::board::{Board, Converters, ResetReason};
use crate::control::Settings;
use crate::coupling::Coupling;
use crate::firmware::{self, Heard, Teller};
use crate::journal::{self, Journal};
use crate::machine;
use crate::network::{self, NetworkPlant};
use converters::{Inputs, Outputs};
use core::num::NonZeroU32;
use cortex_m::peripheral::DWT;
use defmt_rtt as _;
use eclss_core::protocol::Role;
use embassy_executor::InterruptExecutor;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::peripherals::IWDG1;
use embassy_stm32::wdg::IndependentWatchdog;
use uart::Uart;

/// The watchdog resets the processor when the loop has been silent for this long \[µs\].
const WATCHDOG_US: u32 = 50_000;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// The board.
pub struct Nucleo {
    inputs: Inputs,
    outputs: Outputs,
    uart: Option<Uart>,
    watchdog: IndependentWatchdog<'static, IWDG1>,
    live: Output<'static>,
}

impl Board for Nucleo {
    const COUNTER_HZ: u32 = 480_000_000;

    fn name(&self) -> &'static str {
        "nucleo-h743zi2"
    }
    fn counter(&self) -> u32 {
        DWT::cycle_count()
    }
    fn read_inputs(&mut self, converters: &mut Converters) {
        self.inputs.read(converters);
    }
    fn write_outputs(&mut self, converters: &Converters, armed: bool) {
        self.outputs.write(converters);
        self.live.set_level(if armed { Level::High } else { Level::Low });
    }
    fn read_link(&mut self, bytes: &mut [u8]) -> usize {
        self.uart.as_mut().map_or(0, |uart| uart.read(bytes))
    }
    fn write_link(&mut self, bytes: &[u8]) -> usize {
        self.uart.as_mut().map_or(bytes.len(), |uart| uart.write(bytes))
    }
    fn safe_outputs(&mut self) {
        make_safe();
    }
    fn feed_watchdog(&mut self) {
        self.watchdog.pet();
    }
}

/// Outputs to 0 V and the LED dark, from any context.
pub(crate) fn make_safe() {
    converters::outputs_to_zero();
    embassy_stm32::pac::GPIOB.bsrr().write(|w| w.set_br(0, true));
}

/// Runs the firmware.
///
/// # Panics
/// When called twice.
pub fn start() -> ! {
    memory::load_hot_code();
    machine::prepare_stack();
    let reason = memory::reset_reason();
    let p = embassy_stm32::init(clocks::config());
    start_counter();
    let plant = network::compiled_in().expect("the build checked the network");
    let period_us = NonZeroU32::new(plant.settings().step_us).unwrap_or(NonZeroU32::MIN);
    let settings = Settings {
        period_us,
        ticks: None,
        startup_ticks: 1_000,
        overruns_to_safe: 5,
        lag_to_safe_us: 1_000_000,
        start_safe: reason != ResetReason::PowerOn,
        settled: false,
        status_every: NonZeroU32::new(1_000_000 / period_us).unwrap_or(NonZeroU32::MIN),
    };
    let inputs = Inputs::new(p.ADC1, p.ADC2, p.TIM6, p.PA3, p.PC0);
    let outputs = Outputs::new(p.DAC1, p.PA4, p.PA5);
    let live = Output::new(p.PB0, Level::Low, Speed::Low);
    let mut watchdog = IndependentWatchdog::new(p.IWDG1, WATCHDOG_US);
    watchdog.unleash();
    let uart = Uart::new(p.USART3, p.PD8, p.PD9, period_us);
    let board = Nucleo { inputs, outputs, uart, watchdog, live };
    let journal = Journal::start(&board, &plant, &settings, reason);
    let nonce = DWT::cycle_count();
    let coupling = network::compiled_in_coupling(|| network::compiled_in_link(&plant, Role::Plant, nonce));
    if coupling.is_bound() {
        journal::process(coupling.process().image().id());
    }
    let (teller, mut listener) = firmware::events(journal);
    interrupt::SWPMI1.set_priority(Priority::P6);
    let spawner = EXECUTOR.start(interrupt::SWPMI1);
    // The task's storage is static and this is its only start.
    spawner.spawn(looping(board, plant, coupling, settings, teller).expect("the loop starts once"));
    let mut deepest = 0;
    loop {
        cortex_m::asm::wfi();
        // The loop never ends here, so an end is nothing to wait for. Looking at the stack takes longer than a
        // tick: once a status is enough.
        if listener.log() == Heard::Status {
            let stack = machine::stack_use();
            if stack.deepest > deepest {
                deepest = stack.deepest;
                journal::stack(stack);
            }
        }
    }
}

#[embassy_executor::task]
async fn looping(
    mut board: Nucleo,
    mut plant: NetworkPlant,
    coupling: &'static mut Coupling<'static>,
    settings: Settings,
    teller: Teller,
) {
    firmware::run(&mut board, &mut plant, coupling, &settings, teller).await;
}

/// The single-wire protocol's interrupt, whose device is not used, runs the executor.
#[interrupt]
#[allow(unsafe_code, reason = "an interrupt handler")]
unsafe fn SWPMI1() {
    // SAFETY: called from the interrupt that the executor was started with, and from nowhere else.
    unsafe { EXECUTOR.on_interrupt() }
}

/// Starts the cycle counter.
fn start_counter() {
    // SAFETY: start-up code runs alone, and embassy-stm32 uses none of these.
    #[allow(unsafe_code, reason = "embassy-stm32 took the processor's peripherals")]
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.DCB.enable_trace();
    DWT::unlock();
    core.DWT.enable_cycle_counter();
    core.SCB.enable_icache();
}
