//! The link: CMSDK UART 0, which QEMU connects to its first serial port.
//!
//! The device holds one byte, so that an interrupt takes each as it comes and the loop finds them in a queue. When
//! the queue is full the byte stays in the device, and QEMU keeps the next ones.
//!
//! Source: ARM DDI 0479, chapter 4.3.

use super::registers::{UART_BAUD, UART_CTRL, UART_DATA, UART_INTERRUPT, UART_STATE, read, write};
use super::vectors::Irq;
use core::cell::RefCell;
use critical_section::Mutex;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

/// Bytes that wait for the loop.
const WAITING: usize = 1_024;
/// Transmitter and receiver on, interrupt for each byte that comes.
const ON: u32 = 0b1011;
const TRANSMITTER_FULL: u32 = 0b01;
const RECEIVER_FULL: u32 = 0b10;
/// Divider of the 25 MHz clock: 1.5625 Mbaud, the smallest that the device takes.
const DIVIDER: u32 = 16;

static RECEIVED: Mutex<RefCell<Option<Producer<'static, u8>>>> = Mutex::new(RefCell::new(None));

/// The loop's end of the device.
pub(super) struct Uart {
    received: Consumer<'static, u8>,
}

impl Uart {
    /// Starts the device; to be called once.
    pub(super) fn start() -> Self {
        static QUEUE: StaticCell<Queue<u8, WAITING>> = StaticCell::new();
        let (producer, received) = QUEUE.init(Queue::new()).split();
        critical_section::with(|cs| RECEIVED.borrow(cs).replace(Some(producer)));
        write(UART_BAUD, DIVIDER);
        write(UART_CTRL, ON);
        Irq::UART0_RECEIVED.unmask();
        Self { received }
    }

    /// Takes what has come, as much as `bytes` holds.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> usize {
        let mut length = 0;
        for byte in bytes {
            let Some(received) = self.received.dequeue() else { break };
            *byte = received;
            length += 1;
        }
        // A byte that found the queue full has been waiting in the device.
        on_received();
        length
    }

    /// Sends as much of `bytes` as the device takes now.
    #[allow(clippy::unused_self, reason = "having the device is the proof that it was started")]
    pub(super) fn write(&mut self, bytes: &[u8]) -> usize {
        let mut length = 0;
        for byte in bytes {
            if read(UART_STATE) & TRANSMITTER_FULL != 0 {
                break;
            }
            write(UART_DATA, u32::from(*byte));
            length += 1;
        }
        length
    }
}

pub(super) extern "C" fn on_received() {
    critical_section::with(|cs| {
        write(UART_INTERRUPT, RECEIVER_FULL);
        let mut queue = RECEIVED.borrow(cs).borrow_mut();
        let Some(queue) = queue.as_mut() else { return };
        while read(UART_STATE) & RECEIVER_FULL != 0 && queue.ready() {
            // There is room, as just seen.
            let _ = queue.enqueue(read(UART_DATA) as u8);
        }
    });
}
