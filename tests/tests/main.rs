//! Tests that cross crates, in one program: linking is what takes long.

mod elements_in_lines;
mod generated;
mod holds;
mod holds_stated;
mod ledger;
mod networks_random;
mod networks_rest;
mod paper_figures;
mod physical;
mod relaxation_networks;
mod single_precision;
mod stability;
mod station;
mod traps_of_phi;
mod traps_of_the_rows;
