//! The application of eclss-rt on a microcontroller: one loop, and one file per board.
//! `eclss-rt hil` runs the same loop on a computer.
//!
//! [`control::run`] is the loop. It knows a board only through [`board::Board`] and the simulated plant only
//! through [`plant::Plant`], so that all of its behaviour (grid, overruns, going safe) is tested on the host.
#![cfg_attr(target_os = "none", no_std)]

pub mod account;
pub mod board;
pub mod boards;
pub mod control;
pub mod controller;
pub mod coupling;
pub mod display;
pub mod fault;
pub mod firmware;
#[cfg(not(target_os = "none"))]
pub mod fit;
pub mod journal;
pub mod loopback;
#[cfg(all(target_os = "none", any(feature = "mps2", feature = "nucleo-h743zi2")))]
pub mod machine;
#[cfg(all(target_os = "none", feature = "measure"))]
pub mod measure;
pub mod network;
pub mod plant;
pub mod schedule;
#[cfg(all(not(target_os = "none"), feature = "wire"))]
pub mod wire;
