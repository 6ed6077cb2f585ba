//! Heat, moisture, gas composition and control on top of a network's flows.

pub mod condenser;
pub mod medium;
pub mod stream;
