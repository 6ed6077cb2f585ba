//! The host harness of eclss-rt: everything that the program `eclss-rt` does, as a library that tests can
//! call. [`program`] is the program, also that of a laboratory with kinds of component of its own.

mod args;
mod buffers;
mod command;
pub mod coupling;
mod duration;
mod failure;
#[cfg(feature = "hil")]
pub mod hil;
mod ledger;
pub mod linear;
mod output;
pub mod paper;
pub mod plot;
mod progress;
mod refusal;
pub mod report;
pub mod run;
#[allow(clippy::cast_possible_wrap, reason = "counts and coordinates of drawings stay far below 2³¹")]
pub mod schematic;
pub mod serve;
mod source;
pub mod stability;
pub mod trace;

pub use buffers::HostBuffers;
pub use command::{main, program};
pub use duration::Duration;
pub use failure::Failure;
pub use ledger::Closure;
pub use progress::Progress;
pub use source::Source;

/// Whether the transients of a method are pseudo-time, so that only its states of rest are physical.
pub fn is_pseudo_time(method: eclss_core::Method) -> bool {
    matches!(method, eclss_core::Method::Euler | eclss_core::Method::Relaxation)
}
