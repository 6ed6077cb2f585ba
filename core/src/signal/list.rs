//! All signals of a network, in one order.

use super::{Output, OutputSpec, Owner, Signal};
use crate::climate::Contents;
use crate::component::Element;
use crate::{Climate, Network, NodeKind};

impl Climate<'_> {
    /// Everything that node `node` publishes as a volume; nothing where there is none.
    pub fn volume_signals(&self, node: usize) -> impl Iterator<Item = Signal> + use<> {
        let volume = self.volumes.get(node);
        let air = volume.is_some_and(|volume| volume.contents == Contents::Air);
        of(node, [volume.map(|_| Owner::Volume), air.then_some(Owner::Air)])
    }

    /// Figures of placed component `index`; nothing where there is none.
    pub fn component_signals(&self, index: usize) -> impl Iterator<Item = Signal> + use<> {
        let specs = self.component(index as u32).map_or(&[][..], |(table, _)| table.kind().output_specs());
        (0..specs.len()).map(move |item| Output::Figure.item(index, item))
    }

    /// Name, label, unit and form of a component's figure.
    pub fn figure_spec(&self, signal: Signal) -> Option<OutputSpec> {
        let (table, _) = self.component(signal.owner).filter(|_| signal.output == Output::Figure)?;
        table.kind().output_specs().get(usize::from(signal.item)).copied()
    }

    /// Name, label, unit and form of a signal of a volume or a component.
    pub fn spec_of_signal(&self, signal: Signal) -> OutputSpec {
        self.figure_spec(signal).unwrap_or_else(|| signal.spec())
    }

    /// Whether a sensor can look at the signal.
    pub fn can_measure(&self, signal: Signal) -> bool {
        let owner = signal.owner as usize;
        self.volume_signals(owner).chain(self.component_signals(owner)).any(|other| other == signal)
    }
}

/// Everything that an owner of one or two kinds publishes.
fn of(owner: usize, kinds: [Option<Owner>; 2]) -> impl Iterator<Item = Signal> {
    let outputs = Output::ALL.iter().filter(move |output| kinds.contains(&Some(output.owner())));
    outputs.flat_map(move |output| (0..output.items()).map(move |item| output.item(owner, item)))
}

impl<E: Element> Network<'_, E> {
    /// All signals: nodes; lines, each with its elements; what nodes hold; exchangers; controls; inputs; ledgers;
    /// the run.
    pub fn signals(&self) -> impl Iterator<Item = Signal> + '_ {
        let every = |count: usize, kind| (0..count).flat_map(move |owner| of(owner, [Some(kind), None]));
        let line = |(index, line): (usize, &crate::Line)| {
            let gas = self.carries_gas(index).then_some(Owner::GasLine);
            let first = line.first_segment as usize;
            let segments = first..first + line.segments as usize;
            of(index, [Some(Owner::Line), gas])
                .chain(segments.flat_map(|segment| of(segment, [Some(Owner::Segment), None])))
        };
        let climate = &self.climate;
        every(self.nodes.len(), Owner::Node)
            .chain(self.lines.iter().enumerate().flat_map(line))
            .chain((0..climate.volumes.len()).flat_map(|node| climate.volume_signals(node)))
            .chain((0..climate.components.len()).flat_map(|index| climate.component_signals(index)))
            .chain(every(climate.loops.len(), Owner::Control))
            .chain(every(self.inputs.len(), Owner::Input))
            .chain(every(usize::from(!climate.is_none()), Owner::Books))
            .chain(every(1, Owner::Run))
    }

    /// Whether the network publishes this signal.
    pub fn publishes(&self, signal: Signal) -> bool {
        let owner = signal.owner as usize;
        let exists = match signal.output.owner() {
            Owner::Node => owner < self.nodes.len(),
            Owner::Line => owner < self.lines.len(),
            Owner::GasLine => self.carries_gas(owner),
            Owner::Segment => owner < self.segments.len(),
            Owner::Volume | Owner::Air | Owner::Component => self.climate.can_measure(signal),
            Owner::Control => owner < self.climate.loops.len(),
            Owner::Input => owner < self.inputs.len(),
            Owner::Books => owner == 0 && !self.climate.is_none(),
            Owner::Run => owner == 0,
        };
        exists && (signal.output == Output::Figure || usize::from(signal.item) < signal.output.items())
    }

    /// Name, label, unit and form of a signal that is no input: a control's reading has those of what it measures.
    pub fn spec_of(&self, signal: Signal) -> OutputSpec {
        let spec = self.climate.spec_of_signal(signal);
        match self.climate.loops.get(signal.owner as usize) {
            Some(control) if signal.output == Output::Reading => {
                OutputSpec { display: self.climate.spec_of_signal(control.measures).display, ..spec }
            }
            _ => spec,
        }
    }

    /// Whether the densities at both ends of a line are those of a gas.
    fn carries_gas(&self, line: usize) -> bool {
        let Some(line) = self.lines.get(line) else { return false };
        let ends = [line.from, line.to];
        if !self.climate.is_none() {
            return ends.iter().all(|end| self.climate.holds(*end, Contents::Air));
        }
        // Without contents a boundary may hold anything; what a junction passes on is known to its neighbours only.
        let is = |test: fn(&NodeKind) -> bool| {
            ends.iter()
                .filter(|end| self.nodes.get(**end as usize).is_some_and(|node| test(&node.kind)))
                .count()
        };
        let cabins = is(|kind| matches!(kind, NodeKind::Cabin { .. }));
        cabins > 0 && cabins + is(|kind| matches!(kind, NodeKind::Boundary)) == 2
    }

    /// Line of a segment that is counted over all lines.
    pub(crate) fn line_of(&self, segment: usize) -> Option<usize> {
        let behind = self.lines.partition_point(|line| line.first_segment as usize <= segment);
        (segment < self.segments.len()).then(|| behind.checked_sub(1)).flatten()
    }
}
