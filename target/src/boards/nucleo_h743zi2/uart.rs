//! The link: USART3, which the board's debug probe offers to the computer as a serial port. Never run.
//!
//! Interrupts move bytes between the device and two buffers; the loop only copies. Writing would wait where the
//! buffer is full, so no tick writes more than the line sends in one.
//!
//! Source: ST UM2407 (virtual serial port on PD8 and PD9), RM0433.

use core::num::NonZeroU32;
use embassy_stm32::peripherals::{PD8, PD9, USART3};
use embassy_stm32::usart::{BufferedInterruptHandler, BufferedUart, Config};
use embassy_stm32::{Peri, bind_interrupts};
use embedded_io::{Read as _, ReadReady as _, Write as _};
use static_cell::ConstStaticCell;

/// Bits a second; the probe's port takes more.
const BAUD: u32 = 2_000_000;
/// Bits of a byte on the line: one to start, eight, one to stop.
const BITS: u64 = 10;
const BUFFER: usize = 1_024;

bind_interrupts!(struct Interrupts {
    USART3 => BufferedInterruptHandler<USART3>;
});

/// The device and how much a tick may send.
pub(super) struct Uart {
    device: BufferedUart<'static>,
    per_tick: usize,
}

impl Uart {
    /// Starts the device; `None` where it refuses its settings.
    pub(super) fn new(
        device: Peri<'static, USART3>,
        sends: Peri<'static, PD8>,
        receives: Peri<'static, PD9>,
        period_us: NonZeroU32,
    ) -> Option<Self> {
        static OUT: ConstStaticCell<[u8; BUFFER]> = ConstStaticCell::new([0; BUFFER]);
        static IN: ConstStaticCell<[u8; BUFFER]> = ConstStaticCell::new([0; BUFFER]);
        let mut config = Config::default();
        config.baudrate = BAUD;
        let device =
            BufferedUart::new(device, receives, sends, OUT.take(), IN.take(), Interrupts, config).ok()?;
        // Nine tenths of what the line sends, so that the buffer empties faster than it fills.
        let line = u64::from(BAUD) * u64::from(period_us.get()) / (BITS * 1_000_000);
        let per_tick = usize::try_from(line * 9 / 10).unwrap_or(BUFFER).clamp(1, BUFFER / 2);
        Some(Self { device, per_tick })
    }

    /// Takes what has come, as much as `bytes` holds.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> usize {
        if !self.device.read_ready().unwrap_or(false) {
            return 0;
        }
        self.device.read(bytes).unwrap_or(0)
    }

    /// Hands over as much as the line sends in a tick.
    pub(super) fn write(&mut self, bytes: &[u8]) -> usize {
        let most = bytes.len().min(self.per_tick);
        match bytes.get(..most) {
            Some(bytes) if !bytes.is_empty() => self.device.write(bytes).unwrap_or(0),
            _ => 0,
        }
    }
}
