//! Ranges that the keys of several components share.

/// Fractions and efficiencies [1].
pub(crate) const FRACTION: (f64, f64) = (0.0, 1.0);
/// Pressures that may not vanish [Pa].
pub(crate) const SOME_PRESSURE: (f64, f64) = (1e-3, 1e7);
/// Mass flows of a measurement [kg/s].
pub(crate) const REFERENCE_FLOW: (f64, f64) = (1e-9, 1e3);
/// Conductances of which there must be some [W/K].
pub(crate) const CONDUCTANCE: (f64, f64) = (1e-6, 1e9);
/// Heat capacities [J/K].
pub(crate) const HEAT_CAPACITY: (f64, f64) = (1e-3, 1e15);
/// Masses of which there must be some [kg].
pub(crate) const MASS: (f64, f64) = (1e-9, 1e6);
/// Times of which there must be some [s].
pub(crate) const SOME_TIME: (f64, f64) = (1e-6, 1e9);
/// Temperatures for which moist air is known [K].
pub(crate) const MOIST_TEMPERATURE: (f64, f64) = (273.15, 333.15);
/// Temperatures [K].
pub(crate) const TEMPERATURE: (f64, f64) = (50.0, 2e3);
