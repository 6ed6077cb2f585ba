//! What the tests of eclss-rt measure against: the equations in `f64`, written down a second time and solved
//! by other people's solvers.
//!
//! [`paper`] holds the paper's loop, [`physical`] the same loop with inertance and storage, [`laws`] the
//! components, [`model`] the relaxation system of any network, [`tight`] integrates a right-hand side with
//! diffsol, [`spectrum`] takes eigenvalues, [`reference`] is the stored solution that the product ships. None
//! of these uses the product's numerics; [`product`] runs them, [`ledger`] closes their books, and [`random`] draws
//! networks for both.

pub mod dice;
pub mod laws;
pub mod ledger;
pub mod model;
pub mod networks;
pub mod paper;
pub mod physical;
pub mod product;
pub mod random;
pub mod reference;
pub mod spectrum;
pub mod tight;
