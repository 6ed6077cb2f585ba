//! What all boards have in common: the loop runs above everything else (in an interrupt, in a real-time thread),
//! and what it tells is logged by whoever has time left, so that logging never lengthens a tick.

use crate::board::Board;
use crate::control::{self, Event, Settings};
use crate::journal;
use crate::plant::Plant;
use core::sync::atomic::{AtomicU32, Ordering};
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
}

/// Creates the queue; once per run.
pub fn events() -> (Teller, Listener) {
    static QUEUE: StaticCell<Queue<Event, EVENTS>> = StaticCell::new();
    let (teller, events) = QUEUE.init(Queue::new()).split();
    (teller, Listener { events })
}

/// The loop, telling through the queue. Each board wraps this in its Embassy task.
pub async fn run<B: Board, P: Plant>(board: &mut B, plant: &mut P, settings: &Settings, mut teller: Teller) {
    control::run(board, plant, settings, |event| {
        if teller.enqueue(event).is_err() {
            LOST.fetch_add(1, Ordering::Relaxed);
        }
    })
    .await;
}

impl Listener {
    /// Logs what has been told since the last call. Returns whether the loop ended well, once it has ended.
    pub fn log(&mut self) -> Option<bool> {
        while let Some(event) = self.events.dequeue() {
            journal::event(&event);
            if let Event::Ended { safe, .. } = event {
                let lost = LOST.load(Ordering::Relaxed);
                if lost > 0 {
                    journal::lost(lost);
                }
                return Some(!safe && lost == 0);
            }
        }
        None
    }
}
