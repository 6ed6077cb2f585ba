//! Reads flows and pressures out of a method's buffers, for reports and for the process image.
//!
//! Every method keeps the nodes' gauge pressures at the beginning of its work buffer and the shared part at
//! the beginning of its state.

use super::adaptive;
use super::common::{self, Common};
use super::implicit::layout::{self, continues};
use super::responsive::{self, Given, Reach};
use crate::component::Element;
use crate::law::{Law, Operating};
use crate::{Line, Method, Network, Segment, math};

/// A method's buffers, read only.
pub(crate) struct Observer<'v, 'n, E> {
    pub(crate) network: &'v Network<'n, E>,
    pub(crate) method: Method,
    pub(crate) state: &'v [f32],
    pub(crate) work: &'v [f32],
    /// Length of a step [s].
    pub(crate) step_s: f32,
    /// Inputs of the last step.
    pub(crate) inputs: &'v [f32],
    /// Virtual temperatures of the nodes, see [`Given`].
    pub(crate) virtual_k: &'v [f32],
}

impl<'v, E: Element> Observer<'v, '_, E> {
    fn given(&self) -> Given<'v> {
        Given { inputs: self.inputs, virtual_k: self.virtual_k }
    }

    fn state_at(&self, index: usize) -> f32 {
        self.state.get(index).copied().unwrap_or(f32::NAN)
    }

    /// Gauge pressure of a node [Pa].
    pub(crate) fn node_gauge_pa(&self, node: usize) -> f32 {
        let stride = self.method.node_stride();
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

    /// Flow of a reach of an implicit method at its last segment's inlet [kg/s]: at the step's end, from which the next one
    /// goes on.
    fn own_flow(&self, segment: usize) -> f32 {
        self.state_at(layout::first_flow(self.network) + segment)
    }

    /// The same as mean of the step, which moved the masses. A method of second order swings around it where a step changes
    /// a pressure by itself, heat for one.
    fn mean_flow(&self, segment: usize) -> f32 {
        let passed = self.work.get(layout::first_passed(self.network) + segment);
        passed.copied().unwrap_or(f32::NAN) / self.step_s
    }

    fn is_implicit(&self) -> bool {
        matches!(self.method, Method::ImplicitEuler | Method::TrBdf2)
    }

    /// Flow of a line at its flow segment [kg/s]: the mean of the last step, which the ledger moves.
    pub(crate) fn line_flow_kg_s(&self, line: usize) -> f32 {
        let Some(description) = self.network.lines.get(line) else { return f32::NAN };
        if self.is_implicit() {
            let segment = (description.first_segment + description.flow_segment) as usize;
            if continues(&self.network.plan, segment) {
                self.segment_flow_kg_s(line, segment)
            } else {
                self.mean_flow(segment)
            }
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

    /// Flow at a segment's inlet [kg/s], as [`Self::line_flow_kg_s`]; NaN for a segment that is not the line's.
    pub(crate) fn segment_flow_kg_s(&self, line: usize, segment: usize) -> f32 {
        self.one_of(line, segment, |flow, _| flow)
    }

    /// Flow at a segment's inlet at the end of the last step [kg/s]: with an implicit method the state from which the next
    /// one goes on, for a comparison with what is known of an instant.
    pub(crate) fn segment_flow_at_end_kg_s(&self, line: usize, segment: usize) -> f32 {
        let Some(description) = self.network.lines.get(line).filter(|_| self.belongs(line, segment)) else {
            return f32::NAN;
        };
        if !self.is_implicit() {
            return self.segment_flow_kg_s(line, segment);
        }
        let past = (description.first_segment + description.segments) as usize;
        let last = (segment..past).find(|&index| !continues(&self.network.plan, index)).unwrap_or(segment);
        let w = self.own_flow(last);
        let removals = self.network.segments.get(segment..last).unwrap_or(&[]);
        let ratio: f32 = removals.iter().map(|segment| 1.0 + segment.element.removal()).product();
        if w > 0.0 { ratio * w } else { w }
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
            self.read_reaches(description, each);
            return;
        }
        let w = self.line_flow_kg_s(line);
        let relaxes = matches!(self.method, Method::Euler | Method::Relaxation);
        let own = if relaxes { description.flow_segment as usize } else { 0 };
        let from = self.node_gauge_pa(description.from as usize);
        let mut resistance = 0.0;
        let felt = |ratio: f32| if w > 0.0 { ratio } else { 1.0 };
        let gauge = |node| self.node_gauge_pa(node);
        let entry = responsive::of_line(self.network, description);
        let reach = entry.and_then(|entry| adaptive::whole_line(self.network, entry, self.given(), gauge));
        let reach = reach.as_ref().map(|(reach, _)| reach);
        let mut ratio = common::flow_ratios(self.network, description, |place, segment, ratio| {
            let ratio_felt = felt(ratio);
            resistance +=
                ratio_felt * ratio_felt * self.law(first + place, segment, w, ratio, reach).resistance;
        });
        let laminar = math::sqrt(description.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE));
        for (offset, segment) in segments.iter().enumerate().rev() {
            let index = first + offset;
            ratio *= 1.0 + segment.element.removal();
            let flow = felt(ratio) * w;
            if offset < own {
                each(index, flow, from + self.state_at(Common::length(self.network) + index));
                continue;
            }
            each(index, flow, pressure);
            let law = self.law(index, segment, w, ratio, reach);
            let least = felt(ratio) * laminar;
            let loss = law.resistance * flow * math::larger(flow.abs(), least) + law.linear * flow;
            pressure += loss - law.head;
        }
    }

    /// Reads a line of an implicit method as [`Self::read_line`] does. Between segments without volume the pressure
    /// follows from their laws, and where the flow changes, from their share of the inertance.
    fn read_reaches(&self, line: &Line, mut each: impl FnMut(usize, f32, f32)) {
        let (first, last) = (line.first_segment as usize, (line.first_segment + line.segments) as usize - 1);
        let mut index = last + 1;
        let mut behind = self.node_gauge_pa(line.to as usize);
        while index > first {
            index -= 1;
            each(index, self.mean_flow(index), behind);
            let joined =
                (first..index).rev().take_while(|&joint| continues(&self.network.plan, joint)).count();
            let start = index - joined;
            let before = if start == first {
                self.node_gauge_pa(line.from as usize)
            } else {
                self.work.get(self.network.nodes.len() + start - 1).copied().unwrap_or(f32::NAN)
            };
            if joined > 0 {
                let flows = [self.own_flow(index), self.mean_flow(index)];
                self.read_joined(line, start..=index, flows, [before, behind], |segment, flow, above| {
                    each(segment, flow, behind + above);
                });
            }
            (index, behind) = (start, before);
        }
    }

    /// Reads the segments of a reach ahead of its last: calls `each` with segment, its flow [kg/s] and the pressure at
    /// its outlet over that behind the reach [Pa]. `w` is the reach's flow at the step's end, to which the pressures belong, and
    /// `mean` that of the step [kg/s]; `before` and `behind` are the gauge pressures at its ends [Pa].
    fn read_joined(
        &self,
        line: &Line,
        reach: core::ops::RangeInclusive<usize>,
        [w, mean]: [f32; 2],
        [before, behind]: [f32; 2],
        mut each: impl FnMut(usize, f32, f32),
    ) {
        let last = *reach.end();
        let nodes = [line.from, line.to].map(|node| self.node_gauge_pa(node as usize));
        let segments = *reach.start()..last + 1;
        let responsive = responsive::of_line(self.network, line).and_then(|entry| {
            Reach::new(self.network, entry, self.given(), segments, [before, behind], nodes)
        });
        let responsive = responsive.as_ref();
        let (mut resistance, mut own_ratio) = (0.0, 1.0);
        let felt = |ratio: f32| if w > 0.0 { ratio } else { 1.0 };
        let first = line.first_segment as usize;
        common::flow_ratios(self.network, line, |place, segment, ratio| {
            let ratio = felt(ratio);
            resistance += ratio * ratio * self.law(first + place, segment, w, 1.0, responsive).resistance;
            if first + place == last {
                own_ratio = ratio;
            }
        });
        let limit = line.laminar_below_pa / math::larger(resistance, f32::MIN_POSITIVE);
        let laminar = own_ratio * math::sqrt(limit);
        // Calls with every segment from the last on: its flow, loss over head [Pa] and inertance [1/m] as felt.
        let shown = |ratio: f32| if mean > 0.0 { ratio * mean } else { mean };
        let walk = |part: &mut dyn FnMut(usize, f32, f32, f32)| {
            let mut ratio = 1.0;
            for index in reach.clone().rev() {
                let Some(segment) = self.network.segments.get(index) else { continue };
                if index < last {
                    ratio *= 1.0 + segment.element.removal();
                }
                let law = self.law(index, segment, w, ratio, responsive);
                let (flow, least) = (felt(ratio) * w, felt(ratio) * laminar);
                let loss = law.resistance * flow * math::larger(flow.abs(), least) + law.linear * flow;
                part(index, shown(ratio), loss - law.head, ratio * segment.inertance_per_m);
            }
        };
        let (mut losses, mut inertance) = (0.0, 0.0);
        walk(&mut |_, _, loss, own| (losses, inertance) = (losses + loss, inertance + own));
        let rate = if inertance > 0.0 { (before - behind - losses) / inertance } else { 0.0 };
        let mut above = 0.0;
        walk(&mut |index, flow, loss, own| {
            if index < last {
                each(index, flow, above);
            }
            above += loss + own * rate;
        });
    }

    /// Law of a segment at its part of the line's flow `w` [kg/s]; in a reach of a responsive line that reach's.
    fn law(
        &self,
        index: usize,
        segment: &Segment<E>,
        w: f32,
        ratio: f32,
        reach: Option<&Reach<'_, '_, E>>,
    ) -> Law {
        if let Some(reach) = reach.filter(|reach| reach.segments.contains(&index)) {
            // Behind the memories stands the climate.
            let behind = crate::climate::sizes(self.network).0;
            let first = self.state.len().saturating_sub(behind + self.network.memory_slots());
            return reach.law_of(index, w, self.state.get(first..).unwrap_or(&[]));
        }
        let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let mass_flow_kg_s = if w > 0.0 { ratio * w } else { w };
        segment.element.law(&Operating::plain(inputs, mass_flow_kg_s))
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
        let (first, segments) = (description.first_segment as usize, self.network.segments.len());
        let last = first + description.segments as usize - 1;
        let masses = layout::first_flow(self.network) + 2 * segments;
        let held = |segment: usize| {
            f64::from(self.state_at(masses + segment)) - f64::from(self.state_at(masses + segments + segment))
        };
        (first..last).map(held).sum()
    }
}
