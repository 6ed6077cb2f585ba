//! The host harness of eclss-rt: everything that the program `eclss-rt` does, as a library that tests can
//! call. [`main`] is the program.

mod args;
mod buffers;
mod command;
mod duration;
mod failure;
pub mod linear;
mod output;
pub mod paper;
pub mod plot;
mod progress;
mod source;
pub mod trace;

pub use buffers::HostBuffers;
pub use command::main;
pub use duration::Duration;
pub use failure::Failure;
pub use progress::Progress;
pub use source::Source;
