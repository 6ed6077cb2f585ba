//! Description of a network: nodes store, lines carry.
//!
//! A line is a series of elements between two nodes (which may be the same one, a loop through a cabin). All
//! of it is constant data in slices: on a board static tables in flash, on a host vectors. Names live outside,
//! with whoever made the description.

use crate::component::{AnyComponent, Element};
use crate::law::Operating;
use crate::parameter::{ParameterError, Reason};
use crate::{Climate, Fingerprint, Node, Plan, PlanError, Schedule, SchedulePoint};

/// One element at its place in a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment<E = AnyComponent> {
    /// The element.
    pub element: E,
    /// Inertance I = L/A of the fluid column in the element [1/m]; finite and ≥ 0.
    pub inertance_per_m: f32,
    /// Volume at the element's outlet [m³]; finite and ≥ 0.
    pub outlet_volume_m3: f32,
    /// Slot of the element's first input in the network's inputs.
    pub first_input: u32,
}

/// A series of elements between two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Node at the inlet.
    pub from: u32,
    /// Node at the outlet.
    pub to: u32,
    /// First of the line's segments.
    pub first_segment: u32,
    /// Number of segments, ≥ 1.
    pub segments: u32,
    /// Which of them, counted from the line's first, carries the line's flow state in `relaxation`: the
    /// stiffest, normally the valve.
    pub flow_segment: u32,
    /// Driving pressure below which the line's law is linear, `y_lin` [Pa]; finite and ≥ 0.
    pub laminar_below_pa: f32,
    /// Mass flow at the start [kg/s], finite.
    pub start_flow_kg_s: f32,
}

impl Line {
    /// Last of the line's segments.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "one addition")]
    pub fn last_segment(&self) -> u32 {
        (self.first_segment + self.segments).saturating_sub(1)
    }
}

/// A segment whose law changes during a run and the line that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Active {
    /// The segment.
    pub segment: u32,
    /// Its line.
    pub line: u32,
}

/// A line whose laws respond to the pressures at their ends, to the direction of flow, to a memory or to the
/// density of the gas that comes: all of them are stated anew in every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Responsive {
    /// The line.
    pub line: u32,
    /// First of the memory slots of its elements, which follow each other in segment order.
    pub first_memory: u32,
    /// Density for which the line's parameters hold [kg/m³], where the density of the upstream node counts; 0
    /// where density is fixed.
    pub reference_density_kg_m3: f32,
}

/// The whole description, borrowed. Generic over the element set, with ours as the default.
#[derive(Debug, Clone, Copy)]
pub struct Network<'a, E = AnyComponent> {
    /// Pressure from which all gauge pressures count [Pa]; finite and ≥ 0.
    pub reference_pa: f32,
    /// Nodes.
    pub nodes: &'a [Node],
    /// Lines.
    pub lines: &'a [Line],
    /// Segments of all lines, in line order.
    pub segments: &'a [Segment<E>],
    /// All segments with an active element in lines that are not responsive, in segment order.
    pub active: &'a [Active],
    /// All lines with an element that [`Element::responds`], and those whose density follows; in line order.
    pub responsive: &'a [Responsive],
    /// Start value of every input slot.
    pub inputs: &'a [f32],
    /// Schedules, each for another input slot.
    pub schedules: &'a [Schedule],
    /// Points of all schedules, in schedule order.
    pub points: &'a [SchedulePoint],
    /// Tables that follow from the connections; [`Plan::EMPTY`] is enough for `euler` and `relaxation`.
    pub plan: Plan<'a>,
    /// Heat, moisture, composition and control; [`Climate::NONE`] for flows only.
    pub climate: Climate<'a>,
}

/// Why a description was refused, with the index of the thing at fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NetworkError {
    /// There is no node or no line.
    Empty,
    /// The reference pressure is not finite or negative.
    Reference(ParameterError),
    /// A parameter of a node.
    Node(u32, ParameterError),
    /// No line reaches a node.
    UnconnectedNode(u32),
    /// A line names a node that does not exist.
    NoSuchNode(u32),
    /// A line has no segment, or its segments do not follow those of the line before.
    SegmentRange(u32),
    /// A line's flow segment lies outside it.
    FlowSegment(u32),
    /// A parameter of a line.
    Line(u32, ParameterError),
    /// A line loses no pressure at any flow, so its flow has no value.
    LineWithoutLoss(u32),
    /// A parameter of a segment or of its element.
    Segment(u32, ParameterError),
    /// A segment's inputs lie outside the network's inputs.
    InputRange(u32),
    /// The start value of a segment's input is out of the input's range.
    InputValue(u32),
    /// The list of active segments is not the one that follows from the segments.
    ActiveList,
    /// The list of responsive lines is not the one that follows from the segments, or a density in it is not
    /// finite or negative; the line at which it goes wrong.
    ResponsiveList(u32),
    /// A schedule's input, points or times do not fit, or a value is out of the input's range; its index.
    Schedule(u32),
    /// The lists of line ends are not those that follow from the lines.
    Plan(PlanError),
}

impl<E> Network<'_, E> {
    /// Returns the bytes of all tables of the description: what it takes in a board's flash.
    pub const fn flash_bytes(&self) -> usize {
        let Self { reference_pa: _, nodes, lines, segments, active, responsive, .. } = self;
        let Self { inputs, schedules, points, plan, climate, .. } = self;
        let Climate { reference_k: _, air: _, coolant: _, volumes, components, tables, passages, loops } =
            climate;
        let Plan { end_start, ends, order, row_start, columns, diagonal, .. } = plan;
        let Plan { stamps, row_of, leaves, terms, series, composite, between, .. } = plan;
        let flows = size_of_val(*nodes)
            + size_of_val(*lines)
            + size_of_val(*segments)
            + size_of_val(*active)
            + size_of_val(*responsive)
            + size_of_val(*inputs)
            + size_of_val(*schedules)
            + size_of_val(*points);
        let contents = size_of_val(*volumes)
            + size_of_val(*components)
            + size_of_val(*tables)
            + size_of_val(*passages)
            + size_of_val(*loops);
        let plan = size_of_val(*end_start)
            + size_of_val(*ends)
            + size_of_val(*order)
            + size_of_val(*row_start)
            + size_of_val(*columns)
            + size_of_val(*diagonal)
            + size_of_val(*stamps)
            + size_of_val(*row_of)
            + size_of_val(*leaves)
            + size_of_val(*terms)
            + size_of_val(*series)
            + size_of_val(*composite)
            + size_of_val(*between);
        flows + contents + plan
    }

    /// Reference pressure over which a flow method judges pressures [Pa]; `None` where it judges none: a climate replaces
    /// the pressures of all volumes by its own after the step and judges those. What flows alone have moved since the start
    /// is no pressure there.
    pub(crate) fn judged_reference_pa(&self) -> Option<f32> {
        self.climate.is_none().then_some(self.reference_pa)
    }
}

impl<E: Element> Network<'_, E> {
    /// Finds the first thing wrong with the description.
    pub fn check(&self) -> Result<(), NetworkError> {
        if self.nodes.is_empty() || self.lines.is_empty() {
            return Err(NetworkError::Empty);
        }
        ParameterError::unless_not_negative("reference_pa", self.reference_pa)
            .map_err(NetworkError::Reference)?;
        for (index, node) in (0u32..).zip(self.nodes) {
            node.check().map_err(|error| NetworkError::Node(index, error))?;
            // With tables at hand this is one look; without them it is a search, for small networks only.
            let ends = self.plan.end_start.get(index as usize..index as usize + 2);
            let connected = match ends {
                Some([first, past]) => first < past,
                _ => self.lines.iter().any(|line| line.from == index || line.to == index),
            };
            if !connected {
                return Err(NetworkError::UnconnectedNode(index));
            }
        }
        let mut active = self.active.iter();
        let mut responsive = self.responsive.iter().peekable();
        let (mut next, mut next_memory) = (0u32, 0usize);
        for (index, line) in (0u32..).zip(self.lines) {
            let segments = self.check_line(index, line, next)?;
            let entry = responsive.next_if(|entry| entry.line == index);
            let fits = entry.is_none_or(|entry| {
                let density = entry.reference_density_kg_m3;
                entry.first_memory as usize == next_memory && density.is_finite() && density >= 0.0
            });
            let responds = segments.iter().any(|segment| segment.element.responds());
            if !fits || (responds && entry.is_none()) {
                return Err(NetworkError::ResponsiveList(index));
            }
            for (place, segment) in (next..).zip(segments) {
                self.check_segment(place, segment)?;
                let expected = Active { segment: place, line: index };
                let listed = segment.element.is_active() && entry.is_none();
                if listed && active.next() != Some(&expected) {
                    return Err(NetworkError::ActiveList);
                }
                next_memory += segment.element.memory();
            }
            self.check_laws(index, next, segments)?;
            next += line.segments;
        }
        if active.next().is_some() {
            return Err(NetworkError::ActiveList);
        }
        if let Some(left) = responsive.next() {
            return Err(NetworkError::ResponsiveList(left.line));
        }
        if next as usize != self.segments.len() {
            return Err(NetworkError::SegmentRange(self.lines.len() as u32));
        }
        if !self.plan.end_start.is_empty() {
            self.plan.check_ends(self.nodes, self.lines).map_err(NetworkError::Plan)?;
        }
        self.check_schedules()
    }

    fn check_line(&self, index: u32, line: &Line, next: u32) -> Result<&[Segment<E>], NetworkError> {
        let nodes = self.nodes.len();
        if line.from as usize >= nodes || line.to as usize >= nodes {
            return Err(NetworkError::NoSuchNode(index));
        }
        let first = line.first_segment as usize;
        let range = first..first.saturating_add(line.segments as usize);
        let segments = self.segments.get(range).filter(|list| line.first_segment == next && !list.is_empty());
        let segments = segments.ok_or(NetworkError::SegmentRange(index))?;
        if line.flow_segment >= line.segments {
            return Err(NetworkError::FlowSegment(index));
        }
        ParameterError::unless_not_negative("laminar_below_pa", line.laminar_below_pa)
            .and(ParameterError::unless_finite("start_flow_kg_s", line.start_flow_kg_s))
            .map_err(|error| NetworkError::Line(index, error))?;
        Ok(segments)
    }

    /// Laws at start values: their sum must resist, and one that is never asked again must be quadratic.
    fn check_laws(&self, line: u32, first: u32, segments: &[Segment<E>]) -> Result<(), NetworkError> {
        let mut loss = 0.0;
        for (place, segment) in (first..).zip(segments) {
            let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            let law = segment.element.law(&Operating::plain(inputs, 0.0));
            if !segment.element.is_active() && law.linear > 0.0 {
                let error = ParameterError { parameter: "linear", reason: Reason::OutsideValidity };
                return Err(NetworkError::Segment(place, error));
            }
            loss += law.resistance + law.linear;
        }
        if loss > 0.0 { Ok(()) } else { Err(NetworkError::LineWithoutLoss(line)) }
    }

    fn check_segment(&self, place: u32, segment: &Segment<E>) -> Result<(), NetworkError> {
        segment
            .element
            .check()
            .and(ParameterError::unless_not_negative("inertance_per_m", segment.inertance_per_m))
            .and(ParameterError::unless_not_negative("outlet_volume_m3", segment.outlet_volume_m3))
            .map_err(|error| NetworkError::Segment(place, error))?;
        let mut slot = segment.first_input as usize;
        let mut index = 0;
        while let Some(spec) = segment.element.input_spec(index) {
            let value = self.inputs.get(slot).ok_or(NetworkError::InputRange(place))?;
            if !(spec.min..=spec.max).contains(value) {
                return Err(NetworkError::InputValue(place));
            }
            index += 1;
            slot += 1;
        }
        Ok(())
    }

    fn check_schedules(&self) -> Result<(), NetworkError> {
        let mut next = 0usize;
        for (index, schedule) in (0u32..).zip(self.schedules) {
            let points = self.points.get(next..next.saturating_add(schedule.points as usize));
            let earlier = self.schedules.get(..index as usize).unwrap_or(&[]);
            let (min, max) = self.range_of(schedule.input as usize).unwrap_or((f32::MIN, f32::MAX));
            let fits = schedule.first_point as usize == next
                && (schedule.input as usize) < self.inputs.len()
                && !earlier.iter().any(|other| other.input == schedule.input)
                && points.is_some_and(|points| {
                    !points.is_empty()
                        && points.iter().all(|point| (min..=max).contains(&point.value))
                        && points.windows(2).all(|pair| matches!(pair, [a, b] if a.time_us <= b.time_us))
                });
            if !fits {
                return Err(NetworkError::Schedule(index));
            }
            next += schedule.points as usize;
        }
        if next == self.points.len() {
            Ok(())
        } else {
            Err(NetworkError::Schedule(self.schedules.len() as u32))
        }
    }

    /// Returns the network id: a hash over every parameter, connection and schedule, the same for the same
    /// description on every machine.
    pub fn id(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.value(self.reference_pa);
        for node in self.nodes {
            node.feed(&mut hash);
        }
        for line in self.lines {
            for word in [line.from, line.to, line.first_segment, line.segments, line.flow_segment] {
                hash.word(word);
            }
            hash.values(&[line.laminar_below_pa, line.start_flow_kg_s]);
        }
        for segment in self.segments {
            segment.element.hash_into(&mut hash);
            hash.values(&[segment.inertance_per_m, segment.outlet_volume_m3]);
            hash.word(segment.first_input);
        }
        hash.values(self.inputs);
        for schedule in self.schedules {
            schedule.feed(&mut hash);
        }
        for point in self.points {
            point.feed(&mut hash);
        }
        self.climate.feed(&mut hash);
        // That a line responds follows from its elements; only its density is something new.
        for entry in self.responsive.iter().filter(|entry| entry.reference_density_kg_m3 > 0.0) {
            hash.word(entry.line);
            hash.value(entry.reference_density_kg_m3);
        }
        hash.finish()
    }

    /// Returns the number of memory slots of all elements.
    #[inline]
    pub fn memory_slots(&self) -> usize {
        let Some(last) = self.responsive.last() else { return 0 };
        let line = self.lines.get(last.line as usize);
        let own = line.map_or(0, |line| self.segments_of(line).iter().map(|s| s.element.memory()).sum());
        last.first_memory as usize + own
    }

    /// Returns the segments of a line; empty for a line that failed [`Self::check`].
    pub fn segments_of(&self, line: &Line) -> &[Segment<E>] {
        let first = line.first_segment as usize;
        self.segments.get(first..first.saturating_add(line.segments as usize)).unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::Pipe;
    use crate::{NodeKind, example};

    #[test]
    fn the_example_is_accepted() {
        assert_eq!(example::paper_loop().check(), Ok(()));
    }

    #[test]
    fn every_parameter_bit_counts_for_the_id() {
        let network = example::paper_loop();
        let id = network.id();
        for index in 0..network.nodes.len() {
            let mut nodes = [network.nodes[0]];
            nodes[index].temperature_k = f32::from_bits(nodes[index].temperature_k.to_bits() ^ 1);
            assert_ne!(Network { nodes: &nodes, ..network }.id(), id);
        }
        let mut lines = [network.lines[0]];
        lines[0].start_flow_kg_s = f32::from_bits(lines[0].start_flow_kg_s.to_bits() ^ 1);
        assert_ne!(Network { lines: &lines, ..network }.id(), id);
    }

    #[test]
    fn faults_are_found_and_named() {
        let network = example::paper_loop();
        let line = network.lines[0];
        let with_line = |line: Line| {
            let lines = [line];
            Network { lines: &lines, ..network }.check()
        };
        assert_eq!(with_line(Line { to: 7, ..line }), Err(NetworkError::NoSuchNode(0)));
        assert_eq!(with_line(Line { segments: 9, ..line }), Err(NetworkError::SegmentRange(0)));
        assert_eq!(with_line(Line { segments: 0, ..line }), Err(NetworkError::SegmentRange(0)));
        assert_eq!(with_line(Line { flow_segment: 6, ..line }), Err(NetworkError::FlowSegment(0)));
        let error = with_line(Line { laminar_below_pa: f32::NAN, ..line }).unwrap_err();
        assert!(matches!(error, NetworkError::Line(0, ParameterError { reason: Reason::NotFinite, .. })));

        let mut segments: std::vec::Vec<_> = network.segments.to_vec();
        segments[2].element = Pipe::new(-1.0).into_any();
        let error = Network { segments: &segments, ..network }.check().unwrap_err();
        assert!(matches!(error, NetworkError::Segment(2, ParameterError { reason: Reason::Negative, .. })));

        let point = |value| crate::SchedulePoint { time_us: 0, value };
        let interpolation = crate::Interpolation::Hold;
        let schedules = [crate::Schedule { input: 1, first_point: 0, points: 1, interpolation }];
        let scheduled = |value| Network { schedules: &schedules, points: &[point(value)], ..network }.check();
        assert_eq!(scheduled(0.5), Ok(()));
        for value in [1.5, -0.1, f32::NAN, f32::INFINITY] {
            assert_eq!(scheduled(value), Err(NetworkError::Schedule(0)), "{value}");
        }

        let nodes = [network.nodes[0], Node { kind: NodeKind::Boundary, ..network.nodes[0] }];
        assert_eq!(Network { nodes: &nodes, ..network }.check(), Err(NetworkError::UnconnectedNode(1)));
        assert_eq!(Network { active: &[], ..network }.check(), Err(NetworkError::ActiveList));
        assert_eq!(Network { inputs: &[], ..network }.check(), Err(NetworkError::InputRange(1)));
    }
}
