//! Tests of the core, in one program: linking is what takes long.

mod cabin;
mod condenser;
#[cfg(feature = "protocol")]
mod hostile;
mod liquid_exchanger;
mod moist_air_oracle;
