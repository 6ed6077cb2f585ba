//! Tests of the one loop on the host, in one program: linking is what takes long.

mod bench;
mod compiled_in;
mod coupled;
mod orders;
