//! Reads flows and pressures out of a method's buffers, for reports and for the process image.
//!
//! Every method keeps the nodes' gauge pressures at the beginning of its work buffer and the shared part at
//! the beginning of its state.

use super::common::{self, Common};
use super::{adaptive, implicit};
use crate::element::{Element, Operating};
use crate::{Line, Method, Network, math};

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
        if !self.belongs(line, segment) {
            return f32::NAN;
        }
        if self.is_implicit() {
            return self.own_state(segment).0;
        }
        let Some(description) = self.network.lines.get(line) else { return f32::NAN };
        let w = self.line_flow_kg_s(line);
        let mut found = 1.0;
        common::flow_ratios(self.network, description, |index, _, ratio| {
            if description.first_segment as usize + index == segment {
                found = ratio;
            }
        });
        if w > 0.0 { w * found } else { w }
    }

    /// Gauge pressure at a segment's outlet [Pa]: a state of its own where the method has one, otherwise from
    /// the line's end back by the laws of what lies behind.
    pub(crate) fn outlet_gauge_pa(&self, line: usize, segment: usize) -> f32 {
        let Some(description) = self.network.lines.get(line).filter(|_| self.belongs(line, segment)) else {
            return f32::NAN;
        };
        let first = description.first_segment as usize;
        let last = first + description.segments as usize - 1;
        if self.is_implicit() && segment < last {
            return self.own_state(segment).1;
        }
        let relaxes = matches!(self.method, Method::Euler | Method::Relaxation);
        if relaxes && segment < first + description.flow_segment as usize {
            let gauges = Common::length(self.network);
            return self.node_gauge_pa(description.from as usize) + self.state_at(gauges + segment);
        }
        let laminar = self.laminar_flow_kg_s(line, description);
        let mut pressure = self.node_gauge_pa(description.to as usize);
        for index in (segment + 1..=last).rev() {
            pressure += self.drop_pa(line, index, laminar);
        }
        pressure
    }

    /// Flow below which a line is linear [kg/s].
    fn laminar_flow_kg_s(&self, line: usize, description: &Line) -> f32 {
        let first = description.first_segment as usize;
        let segments = first..first + description.segments as usize;
        let resistance: f32 = segments.map(|segment| self.law(line, segment).0).sum();
        math::sqrt(description.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE))
    }

    /// Resistance, linear resistance and head of a segment, and the flow through it.
    fn law(&self, line: usize, segment: usize) -> (f32, f32, f32, f32) {
        let w = self.segment_flow_kg_s(line, segment);
        let Some(description) = self.network.segments.get(segment) else { return (f32::NAN, 0.0, 0.0, w) };
        let inputs = self.inputs.get(description.first_input as usize..).unwrap_or(&[]);
        let law = description.element.law(&Operating { inputs, mass_flow_kg_s: w, density_ratio: 1.0 });
        (law.resistance, law.linear, law.head, w)
    }

    fn drop_pa(&self, line: usize, segment: usize, laminar: f32) -> f32 {
        let (resistance, linear, head, w) = self.law(line, segment);
        resistance * w * math::larger(w.abs(), laminar) + linear * w - head
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
        let first = 4 * self.network.nodes.len() + 6 * line + 2;
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
