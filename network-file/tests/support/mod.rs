//! A network file on its way into a simulator.

use eclss_core::{Buffers, Settings, Simulator};
use eclss_network_file::{Loaded, parse};

/// Runs `body` on the network of `text`.
pub(crate) fn with_network<T>(text: &str, body: impl FnOnce(&Loaded, &mut Simulator<'_>) -> T) -> T {
    let loaded = parse(text, "test.toml").unwrap_or_else(|error| panic!("{error}"));
    let network = loaded.network();
    let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let mut simulator = Simulator::new(&network, settings, buffers).expect("the network is accepted");
    body(&loaded, &mut simulator)
}

/// Largest gap of a ledger over what passed: mass by the start's 71 kg, energy by what they held and carried, 20 MJ.
pub(crate) fn assert_closed(simulator: &Simulator<'_>) {
    for ledger in simulator.ledgers() {
        let scale = if ledger.unit == "J" { 2e7 } else { 71.0 };
        assert!(ledger.gap().abs() < 1e-6 * scale, "{ledger:?}");
    }
}

/// Value of the signal with this name, as in `condenser.heat`.
pub(crate) fn signal(loaded: &Loaded, simulator: &Simulator<'_>, name: &str) -> f32 {
    let found = loaded.signals().into_iter().find(|signal| signal.name == name);
    simulator.signal(found.unwrap_or_else(|| panic!("there is no signal {name}")).signal)
}
