//! Linear analysis of the relaxation system of one line, in `f64`: steady state, Jacobian, eigenvalues.
//!
//! ```text
//! q_i' = q_{i−1} − q_i + f_i − R_i·a(w)        w' = φ·(q_v + p_A − p_B + f − R·w|w|)
//! ```
//!
//! The line's ends are held. The laws are the elements' own; the sums, the steady state and the matrix are
//! formed here independently of the kernel that steps them.

mod eigen;
mod line;
mod pictures;
mod spectrum;
mod sweep;

pub use eigen::{Complex, Disc, eigenvalues, gershgorin, spectral_radius};
pub use line::LineModel;
pub use pictures::{Moving, disc_figure, eigenvalue_figure, radius_figure, radius_panel};
pub use spectrum::{Spectrum, worst};
pub use sweep::{Sweep, SweepPoint, crossings};
