//! The network that is compiled in, see `build.rs`.

use eclss_core::{Compiled as _, CompiledSimulator, Simulator};

/// The network's tables, generated from its file.
#[allow(clippy::unreadable_literal, clippy::excessive_precision, reason = "generated")]
#[allow(missing_docs, dead_code, unreachable_pub, reason = "generated")]
mod table {
    include!(concat!(env!("OUT_DIR"), "/network.rs"));
}

/// A simulator with the step of the network that is compiled in.
pub(super) type Compiled<'a> = CompiledSimulator<'a, table::Configured>;

/// Whether it is this network, with its file's method and step, that `simulator` runs.
pub(super) fn fits(simulator: &Simulator<'_>) -> bool {
    simulator.network_id() == table::NETWORK_ID && simulator.settings() == table::Configured::SETTINGS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HostBuffers;
    use std::path::Path;

    /// The network that is compiled in, whichever it is, over 60 000 steps.
    #[test]
    fn a_compiled_step_has_the_bits_of_a_loaded_one() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let file = option_env!("ECLSS_NETWORK").unwrap_or("networks/paper.toml");
        let loaded = eclss_network_file::load(&root.join(file)).unwrap();
        let network = loaded.network();
        let settings = table::Configured::SETTINGS;
        let (mut ours, mut theirs) = (HostBuffers::default(), HostBuffers::default());
        let simulator = ours.simulator(&network, settings).unwrap();
        assert!(fits(&simulator));
        let mut compiled = Compiled::new(simulator).unwrap();
        let mut loaded = theirs.simulator(&network, settings).unwrap();
        let start = compiled.state_hash();
        for _ in 0..60 {
            for _ in 0..1_000 {
                compiled.step();
            }
            loaded.step_times(1_000);
            assert_eq!(compiled.state_hash(), loaded.state_hash(), "at tick {}", loaded.tick());
        }
        assert_ne!(compiled.state_hash(), start);
        // Another step is another simulation, and is not taken for it.
        let other = eclss_core::Settings { step_us: settings.step_us / 2, ..settings };
        assert!(!fits(&theirs.simulator(&network, other).unwrap()));
    }
}
