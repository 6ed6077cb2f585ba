//! Figures of a network that a page shows.

use eclss_core::signal::Owner;
use eclss_core::{Method, Output, Signal};
use eclss_network_file::{Loaded, NamedSignal};

/// Everything that is written down when nobody chose, but the figures of the run, which stand in every frame; then φ of
/// what the method slows: `relaxation` lines, `adaptive` nodes.
pub(crate) fn published(loaded: &Loaded, method: Method) -> Vec<NamedSignal> {
    let slowed = match method {
        Method::Relaxation => Some(Output::LinePhi),
        Method::Adaptive => Some(Output::NodePhi),
        Method::Euler | Method::ImplicitEuler | Method::TrBdf2 => None,
    };
    let (mut list, rest): (Vec<_>, Vec<_>) = loaded.signals().into_iter().partition(NamedSignal::is_standard);
    list.retain(|named| named.signal.output.owner() != Owner::Run);
    list.extend(rest.into_iter().filter(|named| Some(named.signal.output) == slowed));
    list
}

/// The same without names, for [`eclss_core::Simulator::read_signals`].
pub(crate) fn signals(loaded: &Loaded, method: Method) -> Vec<Signal> {
    published(loaded, method).into_iter().map(|named| named.signal).collect()
}
