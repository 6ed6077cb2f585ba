//! What all boards have in common: the loop runs above everything else (in an interrupt, in a real-time thread),
//! and what it tells is logged by whoever has time left, so that logging never lengthens a tick.

use crate::board::Board;
use crate::control::{self, Event, Settings};
use crate::controller::{self, Controller};
use crate::coupling::Coupling;
use crate::journal::{self, Journal};
use crate::plant::Plant;
use core::sync::atomic::{AtomicU32, Ordering};
use eclss_core::mode::Mode;
use eclss_core::protocol::Link;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

/// Events between two turns of the logging loop.
const EVENTS: usize = 32;

static LOST: AtomicU32 = AtomicU32::new(0);

/// The loop's end of the queue.
pub type Teller = Producer<'static, Event>;

/// The logging end of the queue.
pub struct Listener {
    events: Consumer<'static, Event>,
    journal: Journal,
}

/// What a listener has heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// Nothing that the caller must know.
    Nothing,
    /// The account of another interval: the time to look at what costs time, such as the stack.
    Status,
    /// The loop has ended, well or not.
    Ended {
        /// Whether it did not end in SAFE and no event was lost.
        well: bool,
    },
}

/// Creates the queue, whose events go into this journal; once per run.
pub fn events(journal: Journal) -> (Teller, Listener) {
    static QUEUE: StaticCell<Queue<Event, EVENTS>> = StaticCell::new();
    let (teller, events) = QUEUE.init(Queue::new()).split();
    (teller, Listener { events, journal })
}

/// The loop, telling through the queue. Each board wraps this in its Embassy task.
pub async fn run<B: Board, P: Plant>(
    board: &mut B,
    plant: &mut P,
    coupling: &mut Coupling<'_>,
    settings: &Settings,
    mut teller: Teller,
) {
    control::run(board, plant, coupling, settings, |event| {
        if teller.enqueue(event).is_err() {
            LOST.fetch_add(1, Ordering::Relaxed);
        }
    })
    .await;
}

/// The controller at the other end of a link, telling through the queue: the flow of `networks/hil.toml` by its valve.
pub async fn control<B: Board>(board: &mut B, link: &mut Link, settings: &Settings, mut teller: Teller) {
    let step_s = settings.period_us.get() as f32 * 1e-6;
    let mut controller = Controller::new(controller::FLOW, 0.2, [0.02, 1.0], step_s);
    controller::run(board, link, &mut controller, settings, |event| {
        if teller.enqueue(event).is_err() {
            LOST.fetch_add(1, Ordering::Relaxed);
        }
    })
    .await;
}

impl Listener {
    /// Logs what has been told since the last call.
    pub fn log(&mut self) -> Heard {
        let mut heard = Heard::Nothing;
        while let Some(event) = self.events.dequeue() {
            self.journal.event(&event);
            match event {
                Event::Status { .. } => heard = Heard::Status,
                Event::Ended { mode, .. } => {
                    let lost = LOST.load(Ordering::Relaxed);
                    if lost > 0 {
                        journal::lost(lost);
                    }
                    return Heard::Ended { well: mode != Mode::Safe && lost == 0 };
                }
                Event::Overrun { .. } | Event::Mode { .. } | Event::Safe { .. } => {}
            }
        }
        heard
    }
}
