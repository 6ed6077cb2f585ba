//! What a step costs.
//!
//! - [`chain_costs`] repeats the cost figure of Qiu et al. 2017 (Fig. 2): chains of 100…1100 equations, plain Euler,
//!   `relaxation`, the physical methods, a dense implicit Newton step as the paper's baseline, and (feature
//!   `peers`) a modern variable-step BDF with a sparse factorisation.
//! - [`scale_costs`] and [`exponent`] show how `adaptive` and `tr-bdf2` grow with the number of nodes.
//! - [`mesh_cost`] takes a mesh of 100 × 100 nodes.
//! - The program `eclss-frames` runs the paper's valve scenario frame by frame for an instruction counter;
//!   `tests/instructions.rs` compares the worst frame with the mean.
//!
//! Everything is measured against the **floor** ([`floor::pass`]): one scalar square root and one scalar
//! division per equation over arrays of the same length. What is compared is measured in turns within one run
//! ([`turns`]), and ratios are medians of what was measured in the same turn, so that a slow second of the
//! machine falls on both sides.

mod chains;
mod description;
pub mod floor;
mod newton;
#[cfg(feature = "peers")]
mod peer;
mod runner;
mod scale;
pub mod turns;

use std::fmt;

use eclss_core::BuildError;

pub use chains::{PAPER_SIZES, Row, chain_costs};
pub use description::Description;
pub use runner::Runner;
pub use scale::{SCALE_SIZES, ScaleRow, exponent, mesh_cost, scale_costs};

/// Why a cost could not be measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// The core refused the network that was to be measured.
    Build(BuildError),
    /// A run left its range: a faulted step costs nothing and must not be counted.
    Faulted(&'static str),
    /// The other solver gave up; its own words.
    Peer(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(error) => write!(f, "the network was refused: {error}"),
            Self::Faulted(method) => write!(f, "the run with {method} left its range"),
            Self::Peer(words) => write!(f, "the other solver gave up: {words}"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

/// Where a measurement stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Parts done.
    pub done: usize,
    /// Parts in all.
    pub total: usize,
    /// Equations of the part that begins; 0 at the end.
    pub equations: usize,
}
