//! What a simulator answers: counters, pressures, flows, ledgers, and the hash of its state.

use super::{Excursion, Health, Settings, Simulator};
use crate::climate::monitor::{Broken, Limit};
use crate::climate::{self, ExchangerReadings, Ledger, Measure, Readings};
use crate::element::Element;
use crate::method::observe::Observer;
use crate::process::Point;
use crate::{Fingerprint, Margin, Method, Network};

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

    /// Mass flow of line `line` at its flow segment [kg/s]; NaN for a line that does not exist.
    pub fn line_flow_kg_s(&self, line: usize) -> f32 {
        self.observer().line_flow_kg_s(line)
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

    /// What exchanger `index` of the climate shows.
    pub fn exchanger(&self, index: usize) -> Option<ExchangerReadings> {
        self.climate().exchanger(index)
    }

    /// What a sensor of the climate would see without its faults; NaN where there is nothing.
    pub fn measured(&self, measure: Measure) -> f32 {
        let air =
            |node: u32, of: &dyn Fn(&Readings) -> f32| self.air(node as usize).as_ref().map_or(f32::NAN, of);
        match measure {
            Measure::Temperature(node) => self.node_temperature_k(node as usize),
            Measure::DewPoint(node) => air(node, &|air| air.dew_point_k),
            Measure::RelativeHumidity(node) => air(node, &|air| air.relative_humidity),
            Measure::Pressure(node) => air(node, &|air| air.pressure_pa),
            Measure::Partial(node, part) => {
                air(node, &|air| air.partial_pa.get(part as usize).copied().unwrap_or(f32::NAN))
            }
            Measure::AirOutlet(index) => self.exchanger(index as usize).map_or(f32::NAN, |e| e.air_outlet_k),
        }
    }

    /// Value of a point of the plant that an output can carry, in its unit; NaN for one that does not exist.
    pub fn point(&self, point: Point) -> f32 {
        let exchanger = |index: u32| self.exchanger(index as usize);
        match point {
            Point::NodeGauge(node) => self.node_gauge_pa(node as usize),
            Point::LineFlow(line) => self.line_flow_kg_s(line as usize),
            Point::SegmentFlow { line, segment } => self.segment_flow_kg_s(line as usize, segment as usize),
            Point::OutletGauge { line, segment } => self.outlet_gauge_pa(line as usize, segment as usize),
            Point::Input(slot) => self.inputs().get(slot as usize).copied().unwrap_or(f32::NAN),
            Point::Measured(measure) => self.measured(measure),
            Point::Mixed(node) => {
                self.air(node as usize).map_or(f32::NAN, |air| f32::from(u8::from(air.mixed)))
            }
            Point::AirHeat(index) => exchanger(index).map_or(f32::NAN, |exchanger| exchanger.heat_w),
            Point::CoolantHeat(index) => exchanger(index).map_or(f32::NAN, |exchanger| exchanger.coolant_w),
            Point::Condensate(index) => {
                exchanger(index).map_or(f32::NAN, |exchanger| exchanger.condensate_kg_s)
            }
            Point::Tank(index) => exchanger(index).map_or(f32::NAN, |exchanger| exchanger.tank_kg),
        }
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
