//! Random networks of any topology: drawn, run by every method and held against what the theory promises.
//!
//! [`draw`] makes them, [`run`] steps them and watches, [`slowest`] says how long they take to settle, [`examine`]
//! does all of it for one seed, [`rule`] is the explicit step in `f64` with either rule for the operator.

pub mod draw;
pub mod examine;
pub mod rule;
pub mod run;
pub mod slowest;
