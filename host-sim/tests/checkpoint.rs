//! Checkpoints of every network that ships, with every method that takes it: restored into a simulator that has never
//! been there, a run goes on to the same bits.

use std::path::Path;

use eclss_core::{Health, Method, Settings};
use eclss_host_sim::{HostBuffers, Source};

/// Where the run is saved, and how far both go on: over a valve that moves, where the file moves one.
const SAVED_AT: u64 = 1_050;
const GO_ON: u64 = 300;
const STEP_US: u32 = 10_000;

#[test]
fn every_network_goes_on_with_every_method() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks");
    let mut examined = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let source = Source::file(&path).unwrap();
        let network = source.loaded.network();
        for method in Method::ALL {
            let settings = Settings { method, step_us: STEP_US };
            let (mut first, mut second) = (HostBuffers::default(), HostBuffers::default());
            let (Ok(mut ours), Ok(mut theirs)) =
                (first.simulator(&network, settings), second.simulator(&network, settings))
            else {
                continue;
            };
            ours.step_times(SAVED_AT);
            let mut bytes = vec![0; ours.checkpoint_bytes()];
            ours.save(&mut bytes).unwrap();
            theirs.restore(&bytes).unwrap();
            let what = format!("{} with {}", path.display(), method.name());
            assert_eq!(ours.state_hash(), theirs.state_hash(), "{what}");
            assert_eq!(ours.step_times(GO_ON), theirs.step_times(GO_ON), "{what}");
            assert_eq!(ours.state_hash(), theirs.state_hash(), "{what}");
            for line in 0..network.lines.len() {
                let flows = [&ours, &theirs].map(|simulator| simulator.line_flow_kg_s(line).to_bits());
                assert_eq!(flows[0], flows[1], "{what}");
            }
            examined += u32::from(ours.health() == Health::Trusted);
        }
    }
    assert!(examined >= 15, "only {examined} ran through");
}
