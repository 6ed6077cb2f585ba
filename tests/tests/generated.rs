//! The generated Rust compiles and is the loaded network to the bit.
//!
//! The build script of this package writes what is compiled here.

use std::path::Path;

use eclss_core::{Method, Network, Storage};
use eclss_network_file::{Loaded, load};

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod paper {
    include!(concat!(env!("OUT_DIR"), "/paper.rs"));
}

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod zoo {
    include!(concat!(env!("OUT_DIR"), "/zoo.rs"));
}

#[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
mod thcs {
    include!(concat!(env!("OUT_DIR"), "/thcs.rs"));
}

/// Every kind of element and of channel.
const ZOO: &str = "../network-file/tests/files/zoo.toml";

/// Lengths as a board uses them.
use zoo::RELAXATION as LENGTH;

fn loaded(path: &str) -> Loaded {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("the file loads")
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
    assert_equal(&loaded(ZOO), &zoo::NETWORK, zoo::NETWORK_ID);
    let names = loaded(ZOO).names;
    assert_eq!(names.nodes, zoo::NODE_NAMES);
    assert_eq!(names.lines, zoo::LINE_NAMES);
    assert_eq!(names.segments, zoo::SEGMENT_NAMES);
    assert_eq!(names.inputs, zoo::INPUT_NAMES);
}

#[test]
fn the_buffer_lengths_are_the_ones_that_a_simulator_asks_for() {
    let loaded = loaded(ZOO);
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
    assert_eq!(thcs::NETWORK.climate.components, loaded.network().climate.components);
    assert_eq!(thcs::NETWORK.climate.loops, loaded.network().climate.loops);
}

/// Host and board have the same image, to the bit and by its id.
#[test]
fn the_generated_image_is_the_loaded_one() {
    let loaded = loaded(ZOO);
    loaded.process.with_image(|image| {
        assert_eq!(image.inputs, zoo::PROCESS.inputs);
        assert_eq!(image.outputs, zoo::PROCESS.outputs);
        assert_eq!(
            (image.order, image.safe_after_ticks),
            (zoo::PROCESS.order, zoo::PROCESS.safe_after_ticks)
        );
        assert_eq!((image.id(), zoo::PROCESS.id()), (zoo::PROCESS_ID, zoo::PROCESS_ID));
    });
    assert_eq!(zoo::INPUT_CHANNEL_NAMES, ["regulator.opening", "booster.speed"]);
}
