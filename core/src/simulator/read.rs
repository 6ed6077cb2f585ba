//! What a simulator answers: counters, pressures, flows, ledgers, and the hash of its state.

use super::{Excursion, Health, Settings, Simulator};
use crate::climate::monitor::{Broken, Limit};
use crate::climate::{self, Ledger, Readings};
use crate::component::Element;
use crate::law::Operating;
use crate::method::observe::Observer;
use crate::signal::{self, Owner, Signal};
use crate::{Fingerprint, Margin, Method, Network, operator};

impl<'a, E: Element> Simulator<'a, E> {
    fn observer(&self) -> Observer<'_, 'a, E> {
        let implicit = matches!(self.settings.method, Method::ImplicitEuler | Method::TrBdf2);
        let slots = self.network.inputs.len();
        let last_stage = if implicit { 2 * slots } else { 0 };
        Observer {
            network: self.network,
            method: self.settings.method,
            state: self.state,
            work: self.work,
            step_s: self.settings.step_us as f32 * 1e-6,
            inputs: self.inputs.get(last_stage..).unwrap_or(&[]),
            virtual_k: climate::virtual_k(self.network, self.work),
        }
    }

    /// The description.
    pub fn network(&self) -> &'a Network<'a, E> {
        self.network
    }

    /// Method and step.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The description's id.
    pub fn network_id(&self) -> u64 {
        self.network_id
    }

    /// Steps taken.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Plant time [µs]: tick times step.
    pub fn time_us(&self) -> u64 {
        self.time_us
    }

    /// Whether the run may be trusted.
    pub fn health(&self) -> Health {
        self.health
    }

    /// Margin of the last step.
    pub fn margin(&self) -> Margin {
        self.margin
    }

    /// Worst margin of all steps so far, figure by figure.
    pub fn worst_margin(&self) -> Margin {
        self.worst_margin
    }

    /// Steps in which neither the proof nor the guard held.
    pub fn unproven_ticks(&self) -> u64 {
        self.unproven_ticks
    }

    /// Value of every input slot in the last step.
    pub fn inputs(&self) -> &[f32] {
        self.observer().inputs
    }

    /// The integrated states and their carries.
    pub fn state(&self) -> &[f32] {
        self.state
    }

    /// Gauge pressure of node `node` [Pa]; NaN for a node that does not exist.
    pub fn node_gauge_pa(&self, node: usize) -> f32 {
        self.observer().node_gauge_pa(node)
    }

    /// φ of node `node` in the last step [1]: below 1 it stores as if its volume were V/φ. NaN for a node that does
    /// not exist.
    pub fn node_phi(&self, node: usize) -> f32 {
        self.observer().node_phi(node)
    }

    /// Mass flow of line `line` at its flow segment as mean of the last step [kg/s], the flow that moved the masses; NaN for
    /// a line that does not exist.
    pub fn line_flow_kg_s(&self, line: usize) -> f32 {
        self.observer().line_flow_kg_s(line)
    }

    /// Mass flow at the inlet of segment `segment` (counted over all lines) of line `line` at the end of the last step
    /// [kg/s]: a state of the implicit methods, for a comparison with what is known of an instant.
    pub fn segment_flow_at_end_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.observer().segment_flow_at_end_kg_s(line, segment)
    }

    /// Reads line `line` in one pass, last segment first: calls `each` with the segment (counted over all lines),
    /// the mass flow at its inlet [kg/s] and the gauge pressure at its outlet [Pa].
    pub fn read_line(&self, line: usize, each: impl FnMut(usize, f32, f32)) {
        self.observer().read_line(line, each);
    }

    /// Mass flow at the inlet of segment `segment` (counted over all lines) of line `line` [kg/s]. Walks the line;
    /// [`Self::read_line`] gives all of it at once.
    pub fn segment_flow_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.observer().segment_flow_kg_s(line, segment)
    }

    /// Gauge pressure at the outlet of segment `segment` (counted over all lines) of line `line` [Pa].
    pub fn outlet_gauge_pa(&self, line: usize, segment: usize) -> f32 {
        self.observer().outlet_gauge_pa(line, segment)
    }

    /// Mass of node `node` as deviation from the start [kg].
    pub fn node_mass_kg(&self, node: usize) -> f64 {
        self.climate().mass_kg(node).unwrap_or_else(|| self.observer().node_mass_kg(node))
    }

    /// Mass that the operator kept node `node` from storing [kg]; 0 wherever φ was 1 throughout.
    pub fn fictitious_kg(&self, node: usize) -> f64 {
        self.observer().fictitious_kg(node)
    }

    /// What line `line` took from its inlet node, gave to its outlet node and drained since the start [kg].
    pub fn line_sums_kg(&self, line: usize) -> [f64; 3] {
        self.observer().line_sums_kg(line)
    }

    /// Mass that the volumes inside line `line` hold beyond the start [kg].
    pub fn held_kg(&self, line: usize) -> f64 {
        self.observer().held_kg(line)
    }

    fn climate(&self) -> climate::Observed<'_, 'a> {
        let (state, work) = climate::sizes(self.network);
        let tail = |buffer: &'_ [f32], length: usize| buffer.len().saturating_sub(length);
        climate::Observed::of(
            &self.network.climate,
            self.state.get(tail(self.state, state)..).unwrap_or(&[]),
            self.work.get(tail(self.work, work)..).unwrap_or(&[]),
            self.settings.step_us as f32 * 1e-6,
        )
    }

    /// What node `node` shows as a volume of air; `None` without a climate, and for coolant.
    pub fn air(&self, node: usize) -> Option<Readings> {
        self.climate().air(node)
    }

    /// Temperature of node `node` [K]: its present one with a climate, else the fixed one of the description.
    pub fn node_temperature_k(&self, node: usize) -> f32 {
        let fixed = || self.network.nodes.get(node).map(|node| node.temperature_k);
        self.climate().temperature_k(node).or_else(fixed).unwrap_or(f32::NAN)
    }

    /// What of the climate's node `node` left its range, if something did.
    pub(super) fn climate_excursion(&self, node: usize) -> Option<Excursion> {
        self.climate().excursion(node)
    }

    /// What makes the figures of node `node` doubtful: [`Limit::Held`], [`Limit::Fog`], [`Limit::Vacuum`],
    /// [`Limit::Ice`]. None without a climate.
    ///
    /// [`Limit::Held`]: crate::climate::monitor::Limit::Held
    /// [`Limit::Fog`]: crate::climate::monitor::Limit::Fog
    /// [`Limit::Vacuum`]: crate::climate::monitor::Limit::Vacuum
    /// [`Limit::Ice`]: crate::climate::monitor::Limit::Ice
    pub fn warnings(&self, node: usize) -> Broken {
        self.climate().warnings(node)
    }

    /// The first node of which something is doubtful, and what.
    pub fn first_warning(&self) -> Option<(usize, Limit)> {
        let climate = self.climate();
        let of = |node| Limit::ALL.into_iter().find(|limit| climate.warnings(node).has(*limit));
        (0..self.network.climate.volumes.len()).find_map(|node| of(node).map(|limit| (node, limit)))
    }

    /// Value of a signal, in its unit; NaN for one that does not exist.
    pub fn signal(&self, signal: Signal) -> f32 {
        let mut value = f32::NAN;
        self.read_signals(&[signal], core::slice::from_mut(&mut value));
        value
    }

    /// Values of signals, each in its unit, as [`Self::signal`] gives them one by one. Signals of a line's elements that
    /// follow each other in the order of [`Network::signals`] take one walk along the line together.
    pub fn read_signals(&self, signals: &[Signal], into: &mut [f32]) {
        let climate = self.climate();
        let (mut rest, mut into) = (signals, into);
        while let [first, ..] = rest {
            let owner = first.owner as usize;
            let mut read = 1;
            let value = match first.output.owner() {
                Owner::Segment => {
                    read = self.read_segments(rest, into);
                    None
                }
                Owner::Volume | Owner::Air | Owner::Component => Some(climate.read(*first)),
                Owner::Control => {
                    let found = climate.control(owner);
                    let read =
                        |[reading, position]: [f32; 2]| signal::control(first.output, reading, position);
                    Some(found.map_or(f32::NAN, read))
                }
                Owner::Node | Owner::Line | Owner::GasLine | Owner::Input | Owner::Books | Owner::Run => {
                    Some(signal::plant(first.output, self, owner, first.item.into()))
                }
            };
            if let (Some(place), Some(value)) = (into.first_mut(), value) {
                *place = value;
            }
            rest = rest.get(read..).unwrap_or(&[]);
            into = into.get_mut(read..).unwrap_or_default();
        }
    }

    /// Reads the elements of one line that `signals` begins with, as far as they stand in order; returns how many.
    fn read_segments(&self, signals: &[Signal], into: &mut [f32]) -> usize {
        let line = |signal: &Signal| {
            let segment = signal.output.owner() == Owner::Segment;
            segment.then(|| self.network.line_of(signal.owner as usize)).flatten()
        };
        let first = signals.first().and_then(line);
        let ordered = signals.windows(2).take_while(
            |pair| matches!(pair, [a, b] if a.owner <= b.owner && first.is_some() && line(b) == first),
        );
        let count = 1 + ordered.count();
        let Some(line) = first else {
            into.iter_mut().take(1).for_each(|value| *value = f32::NAN);
            return 1;
        };
        let mut open = count;
        self.read_line(line, |segment, flow_kg_s, outlet_gauge_pa| {
            while let Some(last) = open.checked_sub(1)
                && let Some(signal) = signals.get(last).filter(|signal| signal.owner as usize == segment)
            {
                if let Some(value) = into.get_mut(last) {
                    *value = signal::segment(signal.output, flow_kg_s, outlet_gauge_pa);
                }
                open = last;
            }
        });
        count
    }

    /// Volume flow of line `line` [m³/s], at the pressure, temperature and composition of the node that it comes from; for
    /// lines of gas.
    pub fn line_volume_flow_m3_s(&self, line: usize) -> f32 {
        let Some(description) = self.network.lines.get(line) else { return f32::NAN };
        let flow_kg_s = self.line_flow_kg_s(line);
        let node = if flow_kg_s < 0.0 { description.to } else { description.from } as usize;
        let pressure_pa = self.network.reference_pa + self.node_gauge_pa(node);
        let dry = || crate::air::density_kg_m3(pressure_pa, self.node_temperature_k(node));
        flow_kg_s / self.climate().density_kg_m3(node).unwrap_or_else(dry)
    }

    /// φ of line `line` at its present flow [1]: below 1 method `relaxation` follows a change of the line more slowly than
    /// it happens. 1 with any other method; NaN for a line that does not exist.
    pub fn line_phi(&self, line: usize) -> f32 {
        let Some(description) = self.network.lines.get(line) else { return f32::NAN };
        if self.settings.method != Method::Relaxation {
            return 1.0;
        }
        let w = self.line_flow_kg_s(line);
        let (mut folded, mut linear, mut ratio) = (0.0, 0.0, 1.0);
        for segment in self.network.segments_of(description).iter().skip(description.flow_segment as usize) {
            let inputs = self.inputs().get(segment.first_input as usize..).unwrap_or(&[]);
            let law = segment.element.law(&Operating::plain(inputs, w));
            folded += law.resistance * ratio * ratio;
            linear += law.linear * ratio;
            if w > 0.0 {
                ratio /= 1.0 + segment.element.removal();
            }
        }
        let step_s = self.settings.step_us as f32 * 1e-6;
        operator::phi(step_s * (2.0 * w.abs() * folded + linear))
    }

    /// Share of what arrived at node `node` that its volume stored in the last step [1]; below 1 where more passes than
    /// it holds.
    pub fn storage_phi(&self, node: usize) -> Option<f32> {
        self.climate().phi(node)
    }

    /// Ledgers of gases, water, coolant and energy; all zero without a climate.
    pub fn ledgers(&self) -> [Ledger; 7] {
        self.climate().ledgers()
    }

    /// Returns the hash over network id, method, step, tick and every state and carry, the same on every
    /// machine that took the same steps.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.long(self.network_id);
        hash.word(self.settings.method as u32);
        hash.word(self.settings.step_us);
        hash.long(self.tick);
        hash.values(self.state);
        hash.finish()
    }
}
