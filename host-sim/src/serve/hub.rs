//! Hands each frame to every open page: one text for all, a short queue for each, and a count of what did not fit.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::feed::{Feed, Frame};

/// Pages that can be open at once.
pub(super) const PAGES: usize = 16;
/// Frames that wait for a slow page; it misses the following ones.
const QUEUE: usize = 8;
/// How often the plant's slot is looked at.
const LOOK: Duration = Duration::from_millis(10);

/// The open pages.
#[derive(Debug, Default)]
pub(super) struct Hub {
    pages: Mutex<Vec<SyncSender<Arc<str>>>>,
    dropped: AtomicU64,
    latest: Mutex<Option<Arc<str>>>,
}

impl Hub {
    /// The latest frame as JSON.
    pub(super) fn latest(&self) -> Option<Arc<str>> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds a page; `None` where there are too many.
    pub(super) fn join(&self) -> Option<Receiver<Arc<str>>> {
        let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
        if pages.len() >= PAGES {
            return None;
        }
        let (sender, receiver) = sync_channel(QUEUE);
        pages.push(sender);
        Some(receiver)
    }

    /// Sends every page away, to come back and find another plant.
    pub(super) fn turn_over(&self) {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner).clear();
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Passes frames of the feed that `feed` gives on, to pages and `also`, until `stop`.
    pub(super) fn run(&self, feed: impl Fn() -> Feed, also: impl Fn(&Frame), stop: &AtomicBool) {
        let mut frame = Frame::default();
        let mut number = 0;
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK);
            let feed = feed();
            if !feed.fetch(&mut frame) {
                continue;
            }
            also(&frame);
            number += 1;
            let missed = feed.dropped() + self.dropped.load(Ordering::Relaxed);
            let text: Arc<str> = event(&frame, number, missed).into();
            *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&text));
            let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
            pages.retain(|page| match page.try_send(Arc::clone(&text)) {
                Ok(()) => true,
                Err(TrySendError::Full(_)) => {
                    self.dropped.fetch_add(1, Ordering::Relaxed);
                    true
                }
                Err(TrySendError::Disconnected(_)) => false,
            });
        }
        // Closes every queue, which ends every page's thread.
        self.pages.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

/// A frame as a server-sent event.
fn event(frame: &Frame, number: u64, missed: u64) -> String {
    let mut text = String::with_capacity(32 + 12 * frame.values.len());
    let figures = serde_json::to_string(&frame.figures).unwrap_or_else(|_| "{}".into());
    let inputs = serde_json::to_string(&frame.inputs).unwrap_or_else(|_| "[]".into());
    let hardware = serde_json::to_string(&frame.hardware).unwrap_or_else(|_| "null".into());
    let _ = write!(
        text,
        "data: {{\"frame\":{number},\"missed\":{missed},\"figures\":{figures},\"inputs\":{inputs},\
         \"hardware\":{hardware},\"values\":["
    );
    for (index, value) in frame.values.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = if value.is_finite() { write!(text, "{comma}{value}") } else { write!(text, "{comma}null") };
    }
    text.push_str("]}\n\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_one_event_of_valid_json() {
        let frame = Frame { values: vec![1.5, f32::NAN, -3e-9], ..Frame::default() };
        let text = event(&frame, 7, 2);
        let json = text.strip_prefix("data: ").and_then(|text| text.strip_suffix("\n\n")).unwrap();
        let value: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!((value["frame"].as_u64(), value["missed"].as_u64()), (Some(7), Some(2)));
        assert!(value["values"][1].is_null() && value["values"][2].as_f64() == Some(-3e-9), "{json}");
        assert_eq!(value["figures"]["tick"], 0);
    }

    #[test]
    fn pages_are_bounded() {
        let hub = Hub::default();
        let open: Vec<_> = (0..2 * PAGES).filter_map(|_| hub.join()).collect();
        assert_eq!(open.len(), PAGES);
    }
}
