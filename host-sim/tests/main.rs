//! Tests of the host harness, in one program: linking is what takes long.

#[cfg(feature = "hil")]
mod bench;
mod checkpoint;
mod commands;
mod common;
mod coupling;
mod first_cabin;
mod generate;
#[cfg(feature = "hil")]
mod hil;
#[cfg(feature = "hil")]
mod hil_allocations;
#[cfg(feature = "hil")]
mod hil_operator;
mod hostile;
mod json;
mod pictures;
mod report;
mod schematic;
mod serve;
mod unrest;
#[cfg(feature = "hil")]
mod watch;
