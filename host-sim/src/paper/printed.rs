//! Figures printed in the paper, and nothing else.
//!
//! Z. Qiu, L. Pang, G. Li, H. Zhang, "Numerical simulation of a cabin ventilation subsystem in a space station
//! oriented real-time system", Chinese Journal of Aeronautics, 2017.

/// Where the figures come from, for reports.
pub const SOURCE: &str = "Z. Qiu, L. Pang, G. Li, H. Zhang, Chinese Journal of Aeronautics, 2017";

/// Steady mass flow at 100 % and at 2 % opening by `AMESim` [g/s].
pub const AMESIM_G_S: [f64; 2] = [86.4776, 4.0594];
/// Steady mass flow at 100 % and at 2 % opening by the paper's improved model [g/s].
pub const IMPROVED_G_S: [f64; 2] = [86.4783, 4.0456];
/// Its errors as printed [%]; of the flows, which are printed rounded, they would be +0.0008 and −0.3400.
pub const IMPROVED_ERROR_PERCENT: [f64; 2] = [0.0009, -0.3412];
/// Opening above which the eigenvalues of plain explicit Euler stay in the unit disc [%].
pub const EDGE_PERCENT: f64 = 20.0;
