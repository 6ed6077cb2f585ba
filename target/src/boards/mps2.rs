//! ARM's MPS2 boards with the AN386 (Cortex-M4F) and AN500 (Cortex-M7) images, as QEMU emulates them.
//!
//! Their peripherals are alike, so that one file serves both. Under `-icount shift=5` an instruction takes
//! 32 ns of guest time and the 25 MHz timers count 40 ns: 5 instructions are 4 counts.
//!
//! Source: ARM DAI 0386 and DAI 0400 (memory and interrupt maps), ARM DDI 0479 (CMSDK peripherals).

mod registers;
pub(crate) mod semihosting;
pub(crate) mod timer;
mod uart;
mod vectors;

use crate::board::{Board, Converters, ResetReason};
use crate::control::Settings;
use crate::coupling::Coupling;
use crate::firmware::{self, Heard, Teller};
use crate::journal::{self, Journal};
use crate::machine;
use crate::network::{self, NetworkPlant};
use core::num::NonZeroU32;
use eclss_core::protocol::{Link, Role};
use embassy_executor::InterruptExecutor;
use registers::{LED, write};
use static_cell::StaticCell;
use uart::Uart;

/// Length of one idle round.
const IDLE_CYCLES: u32 = 200;
/// LED 0 is lit while outputs are live: the emulated boards' only outputs.
const LIVE: u32 = 1;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// One of the two boards.
pub struct Mps2 {
    name: &'static str,
    overload: Option<semihosting::Overload>,
    tick: u32,
    uart: Uart,
}

impl Board for Mps2 {
    const COUNTER_HZ: u32 = timer::HZ;

    fn name(&self) -> &'static str {
        self.name
    }
    fn counter(&self) -> u32 {
        timer::counter()
    }
    fn read_inputs(&mut self, _converters: &mut Converters) {
        // A test asks for slow ticks by name; where else would an emulator's load come from?
        if let Some(overload) = self.overload.filter(|overload| overload.hits(self.tick)) {
            let begun = timer::counter();
            while timer::counter().wrapping_sub(begun) < overload.duration_us * (timer::HZ / 1_000_000) {}
        }
        self.tick += 1;
    }
    fn write_outputs(&mut self, _converters: &Converters, armed: bool) {
        write(LED, if armed { LIVE } else { 0 });
    }
    fn read_link(&mut self, bytes: &mut [u8]) -> usize {
        self.uart.read(bytes)
    }
    fn write_link(&mut self, bytes: &[u8]) -> usize {
        self.uart.write(bytes)
    }
    fn safe_outputs(&mut self) {
        make_safe();
    }
    fn feed_watchdog(&mut self) {}
}

/// Outputs off, from any context.
pub(crate) fn make_safe() {
    write(LED, 0);
}

/// Runs the firmware under this board name; returns to the emulator when the run has ended.
///
/// # Panics
/// When called twice.
pub fn start(name: &'static str) -> ! {
    machine::prepare_stack();
    timer::init();
    let reason = machine::take_fault().map_or(ResetReason::PowerOn, ResetReason::Fault);
    let request = semihosting::Request::read();
    let plant = network::compiled_in().unwrap_or_else(|error| {
        defmt::error!("the network is refused: {}", error);
        semihosting::exit(false)
    });
    let period_us = NonZeroU32::new(plant.settings().step_us).unwrap_or(NonZeroU32::MIN);
    let per_second = NonZeroU32::new(1_000_000 / period_us).unwrap_or(NonZeroU32::MIN);
    let settings = Settings {
        period_us,
        ticks: Some(u64::from(request.seconds) * u64::from(per_second.get())),
        startup_ticks: 100,
        overruns_to_safe: 5,
        lag_to_safe_us: 1_000_000,
        start_safe: reason != ResetReason::PowerOn,
        settled: false,
        status_every: per_second,
    };
    let board = Mps2 { name, overload: request.overload, tick: 0, uart: Uart::start() };
    let journal = Journal::start(&board, &plant, &settings, reason);
    if reason != ResetReason::PowerOn {
        // Nobody is there to acknowledge the fault: tell and leave.
        semihosting::exit(false);
    }
    if let Some(trap) = request.trap {
        trap.spring();
    }
    let (teller, mut listener) = firmware::events(journal);
    let spawner = EXECUTOR.start(vectors::Irq::SPARE);
    // The task's storage is static and this is its only start.
    let nonce = timer::counter();
    if request.controls {
        static LINK: StaticCell<Option<Link>> = StaticCell::new();
        let link = LINK.init_with(|| network::compiled_in_link(&plant, Role::Controller, nonce));
        let link = link.as_mut().unwrap_or_else(|| {
            defmt::error!("the network has no channels to control");
            semihosting::exit(false)
        });
        spawner.spawn(controlling(board, link, settings, teller).expect("the loop starts once"));
    } else {
        let coupling =
            network::compiled_in_coupling(|| network::compiled_in_link(&plant, Role::Plant, nonce));
        if coupling.is_bound() {
            journal::process(coupling.process().image().id());
        }
        spawner.spawn(looping(board, plant, coupling, settings, teller).expect("the loop starts once"));
    }
    // Counting instead of sleeping: when the processor sleeps, QEMU winds its clock on from another thread, which
    // now and then comes out two microseconds different. Time that passes by instructions alone never does.
    // Against real hardware it has to keep step with the wall, and no log is compared.
    loop {
        if request.sleeps {
            cortex_m::asm::wfi();
        } else {
            cortex_m::asm::delay(IDLE_CYCLES);
        }
        if let Heard::Ended { well } = listener.log() {
            journal::stack(machine::stack_use());
            semihosting::exit(well);
        }
    }
}

#[embassy_executor::task]
async fn looping(
    mut board: Mps2,
    mut plant: NetworkPlant,
    coupling: &'static mut Coupling<'static>,
    settings: Settings,
    teller: Teller,
) {
    firmware::run(&mut board, &mut plant, coupling, &settings, teller).await;
}

#[embassy_executor::task]
async fn controlling(mut board: Mps2, link: &'static mut Link, settings: Settings, teller: Teller) {
    firmware::control(&mut board, link, &settings, teller).await;
}
