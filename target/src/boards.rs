//! One file per board; a build holds exactly one of them.

#[cfg(all(target_os = "none", feature = "mps2"))]
pub mod mps2;
#[cfg(all(target_os = "none", feature = "nucleo-h743zi2"))]
pub mod nucleo_h743zi2;

/// The board of this build, for the fault paths, which can be handed nothing.
#[cfg(all(target_os = "none", feature = "mps2"))]
pub(crate) use mps2 as current;
#[cfg(all(target_os = "none", feature = "nucleo-h743zi2"))]
pub(crate) use nucleo_h743zi2 as current;
