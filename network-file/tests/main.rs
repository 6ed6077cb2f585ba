//! Tests of network files, in one program: linking is what takes long.

mod channels;
mod checkpoint_layout;
mod climate;
mod density;
mod documented;
mod extremes;
mod first_steps;
mod laminar;
mod large;
mod liquid_loops;
mod machine_power;
mod malfunctions;
mod mutations;
mod openings;
mod paper;
mod refused;
mod refused_air;
mod round_trip;
mod shown_flows;
mod signals;
mod slowed_air;
mod standing_heat;
mod steady_air;
mod supplied_air;
mod support;
mod volumes;
