//! Signals by the names of a file: `<id>.<output>`, for everything that a network publishes.

use eclss_core::signal::{Listing, OutputSpec, Owner, Signal};
use eclss_core::{Network, Output};

use crate::loaded::{Loaded, Names};

/// A signal with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedSignal {
    /// Name in files and pages, as in `valve.mass_flow`.
    pub name: String,
    /// Data that a simulator reads.
    pub signal: Signal,
    /// Name behind the id, label, unit and form.
    pub spec: OutputSpec,
}

impl NamedSignal {
    /// Id of the owner; the whole name for a figure of the run.
    pub fn owner(&self) -> &str {
        self.name.rsplit_once('.').map_or(&self.name, |(owner, _)| owner)
    }

    /// Name of its column: with the unit, except for an input.
    pub fn column(&self) -> String {
        let input = self.signal.output == Output::Input;
        format!("{}{}", self.name, if input { "" } else { self.spec.display.suffix() })
    }

    /// Whether it is written down when nobody chose.
    pub fn is_standard(&self) -> bool {
        self.signal.output.listing() == Listing::Standard
    }
}

impl Loaded {
    /// Everything that the network publishes, in the core's order.
    pub fn signals(&self) -> Vec<NamedSignal> {
        all(&self.network(), &self.names, &self.input_specs)
    }

    /// The signals of that list that are written down when nobody chose.
    pub fn standard_signals(&self) -> Vec<NamedSignal> {
        self.signals().into_iter().filter(NamedSignal::is_standard).collect()
    }
}

/// All signals of a network by name.
pub(crate) fn all(network: &Network<'_>, names: &Names, inputs: &[OutputSpec]) -> Vec<NamedSignal> {
    let named = |signal: Signal| {
        let owner = signal.owner as usize;
        let ids = match signal.output.owner() {
            Owner::Node | Owner::Volume | Owner::Air => &names.nodes,
            Owner::Line | Owner::GasLine => &names.lines,
            Owner::Segment => &names.segments,
            Owner::Component => &names.components,
            Owner::Control => &names.controls,
            Owner::Input => {
                let (name, spec) = (names.inputs.get(owner)?.clone(), *inputs.get(owner)?);
                return Some(NamedSignal { name, signal, spec });
            }
            Owner::Books | Owner::Run => {
                let spec = signal.spec();
                return Some(NamedSignal { name: spec.name.to_owned(), signal, spec });
            }
        };
        let spec = network.spec_of(signal);
        Some(NamedSignal { name: format!("{}.{}", ids.get(owner)?, spec.name), signal, spec })
    };
    network.signals().filter_map(named).collect()
}
