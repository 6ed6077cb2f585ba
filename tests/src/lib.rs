//! What the tests of eclss-rt measure against: the equations in `f64`, written down a second time and solved
//! by other people's solvers.
//!
//! Nothing here uses the product's numerics. [`paper`] holds the paper's loop, [`tight`] integrates a
//! right-hand side with diffsol, [`reference`] is the stored solution that the product ships.

pub mod paper;
pub mod reference;
pub mod tight;
