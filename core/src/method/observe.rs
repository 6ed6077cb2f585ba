//! Reads flows and pressures out of a method's buffers, for reports and for the process image.
//!
//! Every method keeps the nodes' gauge pressures at the beginning of its work buffer and the shared part at
//! the beginning of its state.

use super::common::{self, Common};
use super::{adaptive, implicit};
use crate::element::{Element, Law, Operating};
use crate::{Method, Network, Segment, math};

/// A method's buffers, read only.
pub(crate) struct Observer<'v, 'n, E> {
    pub(crate) network: &'v Network<'n, E>,
    pub(crate) method: Method,
    pub(crate) state: &'v [f32],
    pub(crate) work: &'v [f32],
    /// Inputs of the last step.
    pub(crate) inputs: &'v [f32],
}

impl<E: Element> Observer<'_, '_, E> {
    fn state_at(&self, index: usize) -> f32 {
        self.state.get(index).copied().unwrap_or(f32::NAN)
    }

    /// Gauge pressure of a node [Pa].
    pub(crate) fn node_gauge_pa(&self, node: usize) -> f32 {
        let stride = match self.method {
            Method::Euler | Method::Relaxation => 1,
            Method::Adaptive => adaptive::NODE_FIGURES,
            Method::ImplicitEuler | Method::TrBdf2 => implicit::NODE_FIGURES,
        };
        if node < self.network.nodes.len() {
            self.work.get(stride * node).copied().unwrap_or(f32::NAN)
        } else {
            f32::NAN
        }
    }

    /// φ of a node in the last step; 1 with a method that slows no node.
    pub(crate) fn node_phi(&self, node: usize) -> f32 {
        if node >= self.network.nodes.len() {
            return f32::NAN;
        }
        match self.method {
            Method::Adaptive => {
                self.work.get(adaptive::NODE_FIGURES * (node + 1) - 1).copied().unwrap_or(f32::NAN)
            }
            _ => 1.0,
        }
    }

    /// Where an implicit method keeps its segments.
    fn own_states(&self) -> usize {
        Common::length(self.network) + 2 * self.network.nodes.len()
    }

    /// Flow and pressure of a segment of an implicit method.
    fn own_state(&self, segment: usize) -> (f32, f32) {
        let first = self.own_states() + 4 * segment;
        (self.state_at(first), self.state_at(first + 2))
    }

    fn is_implicit(&self) -> bool {
        matches!(self.method, Method::ImplicitEuler | Method::TrBdf2)
    }

    /// Flow of a line at its flow segment [kg/s].
    pub(crate) fn line_flow_kg_s(&self, line: usize) -> f32 {
        let Some(description) = self.network.lines.get(line) else { return f32::NAN };
        if self.is_implicit() {
            self.own_state((description.first_segment + description.flow_segment) as usize).0
        } else if self.method == Method::Adaptive {
            self.state_at(adaptive::State::line_at(self.network.nodes.len(), line))
        } else {
            self.state_at(4 * self.network.nodes.len() + 6 * line)
        }
    }

    /// Whether a segment belongs to a line.
    fn belongs(&self, line: usize, segment: usize) -> bool {
        self.network.lines.get(line).is_some_and(|line| {
            let first = line.first_segment as usize;
            (first..first + line.segments as usize).contains(&segment)
        })
    }

    /// Flow at a segment's inlet [kg/s]; NaN for a segment that is not the line's.
    pub(crate) fn segment_flow_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.one_of(line, segment, |flow, _| flow)
    }

    /// Gauge pressure at a segment's outlet [Pa]; NaN for a segment that is not the line's.
    pub(crate) fn outlet_gauge_pa(&self, line: usize, segment: usize) -> f32 {
        self.one_of(line, segment, |_, outlet| outlet)
    }

    fn one_of(&self, line: usize, segment: usize, pick: impl Fn(f32, f32) -> f32) -> f32 {
        let mut found = f32::NAN;
        if self.belongs(line, segment) {
            self.read_line(line, |index, flow, outlet| {
                if index == segment {
                    found = pick(flow, outlet);
                }
            });
        }
        found
    }

    /// Reads a whole line in one pass, last segment first: calls `each` with segment, flow at its inlet [kg/s] and
    /// gauge pressure at its outlet [Pa]. A pressure is a state of its own where the method has one, otherwise it
    /// follows from the line's end by the laws of what lies behind.
    pub(crate) fn read_line(&self, line: usize, mut each: impl FnMut(usize, f32, f32)) {
        let Some(description) = self.network.lines.get(line) else { return };
        let first = description.first_segment as usize;
        let segments = self.network.segments_of(description);
        let mut pressure = self.node_gauge_pa(description.to as usize);
        if self.is_implicit() {
            for index in (first..first + segments.len()).rev() {
                let (flow, gauge) = self.own_state(index);
                let last = index + 1 == first + segments.len();
                each(index, flow, if last { pressure } else { gauge });
            }
            return;
        }
        let w = self.line_flow_kg_s(line);
        let relaxes = matches!(self.method, Method::Euler | Method::Relaxation);
        let own = if relaxes { description.flow_segment as usize } else { 0 };
        let from = self.node_gauge_pa(description.from as usize);
        let mut resistance = 0.0;
        let mut ratio = common::flow_ratios(self.network, description, |_, segment, ratio| {
            resistance += self.law(segment, w, ratio).resistance;
        });
        let laminar = math::sqrt(description.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
        for (offset, segment) in segments.iter().enumerate().rev() {
            let index = first + offset;
            ratio *= 1.0 + segment.element.removal();
            let flow = if w > 0.0 { ratio * w } else { w };
            if offset < own {
                each(index, flow, from + self.state_at(Common::length(self.network) + index));
                continue;
            }
            each(index, flow, pressure);
            let law = self.law(segment, w, ratio);
            let loss = law.resistance * flow * math::larger(flow.abs(), laminar) + law.linear * flow;
            pressure += loss - law.head;
        }
    }

    /// Law of a segment at its part of the line's flow `w` [kg/s].
    fn law(&self, segment: &Segment<E>, w: f32, ratio: f32) -> Law {
        let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let mass_flow_kg_s = if w > 0.0 { ratio * w } else { w };
        segment.element.law(&Operating { inputs, mass_flow_kg_s, density_ratio: 1.0 })
    }

    /// A pair of sum and carry as one number.
    fn sum_at(&self, index: usize) -> f64 {
        f64::from(self.state_at(index)) - f64::from(self.state_at(index + 1))
    }

    /// Mass of a node as deviation from the start [kg].
    pub(crate) fn node_mass_kg(&self, node: usize) -> f64 {
        self.sum_at(4 * node)
    }

    /// Mass that a slowed node owes to its flows [kg].
    pub(crate) fn fictitious_kg(&self, node: usize) -> f64 {
        self.sum_at(4 * node + 2)
    }

    /// Taken, given and drained by a line since the start [kg].
    pub(crate) fn line_sums_kg(&self, line: usize) -> [f64; 3] {
        let (nodes, lines) = (self.network.nodes.len(), self.network.lines.len());
        if self.method == Method::Adaptive {
            let given = self.sum_at(adaptive::State::line_at(nodes, line) + 1);
            let drained = adaptive::special_index(self.network, line, self.work)
                .map_or(0.0, |special| self.sum_at(adaptive::State::drained_at(nodes, lines, special)));
            return [given + drained, given, drained];
        }
        let first = 4 * nodes + 6 * line + 2;
        let (given, drained) = (self.sum_at(first), self.sum_at(first + 2));
        [given + drained + self.held_kg(line), given, drained]
    }

    /// Mass stored in the volumes inside a line as deviation from the start [kg].
    pub(crate) fn held_kg(&self, line: usize) -> f64 {
        let Some(description) = self.network.lines.get(line).filter(|_| self.is_implicit()) else {
            return 0.0;
        };
        let from = self.network.nodes.get(description.from as usize);
        let (temperature, start) = from.map_or((0.0, 0.0), |node| (node.temperature_k, node.start_gauge_pa));
        let first = description.first_segment as usize;
        let last = first + description.segments as usize - 1;
        let held = |segment: usize| {
            let volume = self.network.segments.get(segment).map_or(0.0, |segment| segment.outlet_volume_m3);
            let rise = self.sum_at(self.own_states() + 4 * segment + 2) - f64::from(start);
            if volume > 0.0 {
                rise * f64::from(volume)
                    / (f64::from(crate::air::GAS_CONSTANT_J_KG_K) * f64::from(temperature))
            } else {
                0.0
            }
        };
        (first..last).map(held).sum()
    }
}
