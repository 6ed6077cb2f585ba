//! The version of checkpoints rises whenever their layout changes.
//!
//! A layout shows in how many words there are, in what they are at the start, and in which of them are large after a
//! while. The last does not look at values nor at carries, so that arithmetic may change its last bits, and physics its
//! figures a little, without a new version.

use crate::support::with_network;

/// Version and fingerprint of every layout so far. A new layout gets a new version and a new row; rows stay as they are.
const LAYOUTS: [(u16, u64); 5] = [
    (2, 0xa647_cda0_96ae_33b3),
    (3, 0xf26e_cdec_cc55_dd27),
    (4, 0xf3a5_be2a_9f91_a6f7),
    (5, 0x7b5f_a467_05c5_5add),
    (6, 0xbc79_cd40_85ff_7c55),
];

const FLOWS: &str = r#"
schema = 1
name = "flows"
reference_pressure_pa = 101325.0
[run]
method = "METHOD"
step = "1ms"
[[node]]
id = "room"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 101325.0
temperature_k = 295.15
[[node]]
id = "next"
kind = "cabin"
volume_m3 = 30.0
pressure_pa = 101425.0
temperature_k = 291.15
[[line]]
id = "door"
from = "next"
to = "room"
initial_flow_kg_s = 0.002
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 5000.0
diameter_m = 0.1
length_m = 2.0
[[line.element]]
id = "valve"
kind = "valve"
open_resistance_pa_s2_kg2 = 80.0
exponent = 3.0
"#;

/// FNV-1a over bytes.
fn add(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// What the layout of the checkpoints of `text` is, added to `hash`, and the version that they carry.
fn layout(hash: u64, text: &str) -> (u16, u64) {
    /// Where the header says how many words there are.
    const COUNTS: usize = 48;
    /// Where they begin.
    const WORDS: usize = 88;
    /// Above every carry, and between what the words of these networks are otherwise.
    const LARGE: f32 = 1e-3;
    with_network(text, |_, simulator| {
        let mut bytes = vec![0; simulator.checkpoint_bytes()];
        let saved = simulator.save(&mut bytes).expect("it fits");
        let version = u16::from_le_bytes([saved[4], saved[5]]);
        let words = &saved[WORDS..saved.len() - 4];
        let mut hash = add(add(hash, &saved[COUNTS..COUNTS + 16]), words);
        simulator.step_times(100);
        let saved = simulator.save(&mut bytes).expect("it fits");
        for word in saved[WORDS..saved.len() - 4].as_chunks::<4>().0 {
            hash = add(hash, &[u8::from(f32::from_le_bytes(*word).abs() > LARGE)]);
        }
        (version, hash)
    })
}

#[test]
fn a_new_layout_has_a_new_version() {
    let (mut version, mut hash) = (0, 0xcbf2_9ce4_8422_2325);
    for method in ["euler", "relaxation", "adaptive", "implicit-euler", "tr-bdf2"] {
        (version, hash) = layout(hash, &FLOWS.replace("METHOD", method));
    }
    let air = include_str!("files/layout.toml");
    for method in ["adaptive", "implicit-euler", "tr-bdf2"] {
        (version, hash) = layout(hash, &air.replace("implicit-euler", method));
    }
    let (known, fingerprint) = LAYOUTS[LAYOUTS.len() - 1];
    assert!(
        (version, hash) == (known, fingerprint),
        "version {version} has the layout {hash:#018x}, version {known} had {fingerprint:#018x}: raise `VERSION` in \
         core/src/simulator/checkpoint.rs and add a row here"
    );
    assert!(LAYOUTS.is_sorted_by(|a, b| a.0 < b.0 && a.1 != b.1), "each layout has a version of its own");
}
