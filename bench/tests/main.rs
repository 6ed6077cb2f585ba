//! Bars of cost, in one program: linking is what takes long.

mod bars;
mod instructions;
mod loaded;
mod scale;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lets a test run while no other does: their figures are times.
fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}
