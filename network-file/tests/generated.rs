//! The generated Rust compiles and is the loaded network to the bit.
//!
//! `tests/generated/*.rs` are what `to_rust` writes for two shipped networks and for `tests/files/zoo.toml`. A test compares the text, so
//! that what is compiled here is what it writes today; the buffer lengths, which change with every method, are
//! compared with the core instead.

use std::path::Path;

use eclss_core::{Method, Network, Storage};
use eclss_network_file::{Loaded, load};

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod paper {
    include!("generated/paper.rs");
}

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod zoo {
    include!("generated/zoo.rs");
}

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod thcs {
    include!("generated/thcs.rs");
}

/// Lengths as a board uses them.
use zoo::RELAXATION as LENGTH;

fn loaded(path: &str) -> Loaded {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("the file loads")
}

/// The text without the constants of buffer lengths and their comments.
fn without_lengths(text: &str) -> Vec<&str> {
    let is_length = |line: &&str| line.contains(": Sizes = ") || line.starts_with("/// Buffers that");
    text.lines().filter(|line| !line.is_empty() && !is_length(line)).collect()
}

fn assert_written(loaded: &Loaded, stored: &str, path: &str) {
    assert!(
        without_lengths(&loaded.to_rust()) == without_lengths(stored),
        "not what `to_rust` writes: cargo run -p eclss-network-file --example to_rust -- {path} has the new text"
    );
}

#[test]
fn the_stored_text_is_what_is_written_today() {
    assert_written(
        &loaded("../networks/paper.toml"),
        include_str!("generated/paper.rs"),
        "networks/paper.toml",
    );
    assert_written(&loaded("../networks/thcs.toml"), include_str!("generated/thcs.rs"), "networks/thcs.toml");
    let path = "network-file/tests/files/zoo.toml";
    assert_written(&loaded("tests/files/zoo.toml"), include_str!("generated/zoo.rs"), path);
}

fn assert_equal(loaded: &Loaded, generated: &Network<'_>, id: u64) {
    let network = loaded.network();
    assert_eq!(network.reference_pa.to_bits(), generated.reference_pa.to_bits());
    assert_eq!(network.nodes, generated.nodes);
    assert_eq!(network.lines, generated.lines);
    assert_eq!(network.segments, generated.segments);
    assert_eq!(network.active, generated.active);
    assert_eq!(network.inputs, generated.inputs);
    assert_eq!(network.schedules, generated.schedules);
    assert_eq!(network.points, generated.points);
    assert_eq!(network.plan, generated.plan);
    assert_eq!(network.id(), generated.id());
    assert_eq!(network.id(), id);
    assert_eq!(generated.check(), Ok(()));
}

#[test]
fn the_tables_are_the_loaded_ones() {
    assert_equal(&loaded("../networks/paper.toml"), &paper::NETWORK, paper::NETWORK_ID);
    assert_equal(&loaded("tests/files/zoo.toml"), &zoo::NETWORK, zoo::NETWORK_ID);
    let names = loaded("tests/files/zoo.toml").names;
    assert_eq!(names.nodes, zoo::NODE_NAMES);
    assert_eq!(names.lines, zoo::LINE_NAMES);
    assert_eq!(names.segments, zoo::SEGMENT_NAMES);
    assert_eq!(names.inputs, zoo::INPUT_NAMES);
}

#[test]
fn the_buffer_lengths_are_the_ones_that_a_simulator_asks_for() {
    let loaded = loaded("tests/files/zoo.toml");
    let text = loaded.to_rust();
    for method in Method::ALL {
        let sizes = method.sizes(&loaded.network());
        let name = method.name().to_uppercase().replace('-', "_");
        assert!(text.contains(&format!("pub const {name}: Sizes = {sizes:?};")), "{name}");
    }
    let _ = Storage::<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>::new();
}

#[test]
fn a_climate_is_written_to_the_bit() {
    let loaded = loaded("../networks/thcs.toml");
    // The id is a hash over every figure.
    assert_eq!(thcs::NETWORK.id(), loaded.network().id());
    assert_eq!(thcs::NETWORK.climate.exchangers, loaded.network().climate.exchangers);
    assert_eq!(thcs::NETWORK.climate.loops, loaded.network().climate.loops);
}
