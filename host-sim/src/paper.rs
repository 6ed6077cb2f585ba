//! The experiment of Qiu et al. 2017, end to end: what a plain `eclss-rt` runs, prints and draws.
//!
//! Two kinds of number stand beside each other and are told apart everywhere: those printed in the paper
//! ([`printed`]) and those derived by this project. The paper's parameters were not printed; the shipped
//! network's were chosen and fitted so that the printed steady flows come out.

mod exact;
mod experiment;
mod pictures;
pub mod printed;
mod reference;
mod report;

pub use exact::DoubleLoop;
pub use experiment::{Experiment, Results, Run, Settled};
pub use pictures::{Picture, pictures, readme_picture};
pub use reference::Reference;
pub use report::write_report;
