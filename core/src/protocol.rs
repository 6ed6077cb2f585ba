//! What goes over the wire between a plant and what hangs on it, without any input or output of its own.
//!
//! Bytes are handed to [`Link::feed`], bytes to send are taken from [`Link::outgoing`]; a clock and a tick come from
//! whoever has them. Work is bounded: linear in the bytes fed, and one frame a tick beside what the peer asks for.
//! Buffers are fixed. `docs/protocol.md` specifies the bytes for other languages.
//!
//! ```
//! use eclss_core::mode::Mode;
//! use eclss_core::protocol::{Config, Link, Outgoing, Role};
//!
//! let config = |role| Config { role, network_id: 7, process_id: 9, step_us: 1_000, ..Config::default() };
//! let mut plant = Link::new(config(Role::Plant), 0x1234);
//! let mut controller = Link::new(config(Role::Controller), 0x9876);
//! let mut received = None;
//! for tick in 0..10 {
//!     let (from, to) = if tick % 2 == 0 { (&mut plant, &mut controller) } else { (&mut controller, &mut plant) };
//!     from.send_tick(tick, tick * 1_000, &Outgoing { mode: Mode::Ready, values: &[0.086], ..Outgoing::default() });
//!     to.feed(from.outgoing(), tick * 1_000);
//!     from.sent(from.outgoing().len());
//!     received = to.take_data().map(|data| data.values[0]).or(received);
//! }
//! assert!(plant.is_connected() && controller.is_connected());
//! assert_eq!(received, Some(0.086));
//! ```

mod clock;
mod counters;
mod frame;
#[cfg(feature = "keyed")]
mod key;
mod link;
mod message;
mod window;

pub use clock::{Clock, Drift, Estimate};
pub use counters::Counters;
pub use frame::{BadFrame, FRAME_BYTES, Framer, PAYLOAD_BYTES, encode};
#[cfg(feature = "keyed")]
pub use key::{KEY_BYTES, Key};
pub use link::{Config, Link, OUTGOING_BYTES, Outgoing, Received};
pub use message::{
    Ack, Body, Command, CommandFrame, Data, Echo, Hello, KeyedCommand, Outcome, Packet, Refused,
    RefusedReason, Role, VERSION,
};
pub use window::{Arrival, Window};
