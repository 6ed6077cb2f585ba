//! Lines whose laws respond to pressures, direction, memory or density.
//!
//! A *reach* is what lies between two pressures that the method knows: a whole line for `adaptive`, what lies between
//! two volumes for the implicit methods. Pressures at the ends of an element inside follow from those of the reach by
//! what the other elements lose at the reach's last flow: from the inlet for what lies ahead, from the outlet for what
//! lies behind. Laws are stated twice: for forward flow with the density of the line's inlet node, for reversed flow
//! with that of its outlet node, but for heads. With a climate that density is the present one of the node's air: its *virtual
//! temperature*, at which dry air of the same pressure would be as dense, stands for temperature and composition.

use core::cmp::Ordering;
use core::ops::Range;

use crate::component::Element;
use crate::law::{Law, Operating};
use crate::{Line, MethodError, Network, Responsive, Segment, air, math};

/// Smallest density ratio [1]: a line out of a vacuum resists without end, but as a number.
const SMALLEST_RATIO: f32 = 1e-9;
/// κ of a root law in which the density follows the upstream pressure, √(y·p).
const FOLLOWING_CHORD: f32 = 1.25;
/// κ of a root law, the least of any.
const ROOT_CHORD: f32 = 1.207_107;

/// Density ratio and virtual temperature [K] of the gas of a node.
type Gas = (f32, f32);

/// What laws look at beside pressures, flows and memory.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a> {
    /// Inputs of the stage.
    pub(crate) inputs: &'a [f32],
    /// Virtual temperature of every node [K]; empty without a climate, where gas is dry and stays as warm as it is.
    pub(crate) virtual_k: &'a [f32],
}

/// Absolute pressure of a gauge pressure [Pa], ≥ 0.
fn absolute_pa<E>(network: &Network<'_, E>, gauge_pa: f32) -> f32 {
    math::larger(network.reference_pa + gauge_pa, 0.0)
}

/// The entry of a line, if it responds.
#[inline(always)]
#[allow(clippy::inline_always, reason = "nothing where the compiler knows that no line responds")]
pub(crate) fn of_line<'a, E>(network: &Network<'a, E>, line: &Line) -> Option<&'a Responsive> {
    if network.responsive.is_empty() {
        return None;
    }
    let first = |entry: &Responsive| network.lines.get(entry.line as usize).map(|line| line.first_segment);
    let place = network.responsive.binary_search_by_key(&Some(line.first_segment), first).ok()?;
    network.responsive.get(place)
}

/// Whether a segment (counted over all lines) belongs to a line that responds.
#[inline(always)]
#[allow(clippy::inline_always, reason = "nothing where the compiler knows that no line responds")]
pub(crate) fn has_segment<E>(network: &Network<'_, E>, segment: usize) -> bool {
    network.responsive.iter().any(|entry| {
        network.lines.get(entry.line as usize).is_some_and(|line| {
            (line.first_segment as usize..(line.first_segment + line.segments) as usize).contains(&segment)
        })
    })
}

/// Refuses a line of which more than one element in a reach needs the pressures at both its ends. `ends_reach` says
/// whether a pressure is known behind a segment (counted over all lines).
pub(crate) fn check<E: Element>(
    network: &Network<'_, E>,
    ends_reach: impl Fn(usize, &Segment<E>) -> bool,
) -> Result<(), MethodError> {
    for entry in network.responsive {
        let Some(line) = network.lines.get(entry.line as usize) else { continue };
        let mut count = 0;
        for (index, segment) in (line.first_segment as usize..).zip(network.segments_of(line)) {
            count += u32::from(segment.element.needs_both_ends());
            if count > 1 {
                return Err(MethodError::SeveralBetweenNodes(entry.line));
            }
            if ends_reach(index, segment) {
                count = 0;
            }
        }
    }
    Ok(())
}

/// κ of a line's law by the root law's: what its conductance is multiplied with so that one θ fits all.
pub(crate) fn chord_factor<E: Element>(network: &Network<'_, E>, entry: &Responsive) -> f32 {
    let follows = entry.reference_density_kg_m3 > 0.0;
    let least = if follows { FOLLOWING_CHORD } else { ROOT_CHORD };
    let line = network.lines.get(entry.line as usize);
    let segments = line.map_or(&[][..], |line| network.segments_of(line)).iter();
    let most = segments.fold(least, |most, segment| math::larger(segment.element.chord_over_secant(), most));
    most / ROOT_CHORD
}

/// Gas of a node at its gauge pressure [Pa], by the reference density of the line of `entry`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub(crate) fn gas<E>(
    network: &Network<'_, E>,
    entry: &Responsive,
    virtual_k: &[f32],
    node: u32,
    gauge_pa: f32,
) -> Gas {
    let fixed = || network.nodes.get(node as usize).map_or(1.0, |node| node.temperature_k);
    let temperature = virtual_k.get(node as usize).copied().unwrap_or_else(fixed);
    let reference = entry.reference_density_kg_m3;
    if reference > 0.0 {
        let density = air::density_kg_m3(absolute_pa(network, gauge_pa), temperature);
        (math::larger(density / reference, SMALLEST_RATIO), temperature)
    } else {
        (1.0, temperature)
    }
}

/// One reach with everything that its laws look at.
pub(crate) struct Reach<'a, 'n, E> {
    pub(crate) network: &'a Network<'n, E>,
    pub(crate) inputs: &'a [f32],
    /// Its segments, counted over all lines.
    pub(crate) segments: Range<usize>,
    /// Memory slot of its first segment.
    pub(crate) first_memory: usize,
    /// Ratio of the forward flow at its inlet to the flow that it is asked about.
    pub(crate) first_ratio: f32,
    /// Absolute pressures at its ends [Pa].
    pub(crate) ends_pa: [f32; 2],
    /// Gas of the line's nodes.
    pub(crate) gases: [Gas; 2],
}

impl<'a, 'n, E: Element> Reach<'a, 'n, E> {
    /// The reach of these segments of the line of `entry`, asked about the flow at the inlet of its last. Gauge
    /// pressures are those at its ends and those of the line's nodes [Pa].
    pub(crate) fn new(
        network: &'a Network<'n, E>,
        entry: &Responsive,
        given: Given<'a>,
        segments: Range<usize>,
        ends_gauge_pa: [f32; 2],
        nodes_gauge_pa: [f32; 2],
    ) -> Option<Self> {
        let line = network.lines.get(entry.line as usize)?;
        let absolute = |gauges: [f32; 2]| gauges.map(|gauge| absolute_pa(network, gauge));
        let ahead = network.segments.get(line.first_segment as usize..segments.start)?;
        let own = network.segments.get(segments.clone())?;
        let (_, before_last) = own.split_last()?;
        let gain: f32 = before_last.iter().map(|segment| 1.0 + segment.element.removal()).product();
        Some(Self {
            network,
            inputs: given.inputs,
            segments,
            first_memory: entry.first_memory as usize
                + ahead.iter().map(|segment| segment.element.memory()).sum::<usize>(),
            first_ratio: gain,
            ends_pa: absolute(ends_gauge_pa),
            gases: [
                gas(network, entry, given.virtual_k, line.from, nodes_gauge_pa[0]),
                gas(network, entry, given.virtual_k, line.to, nodes_gauge_pa[1]),
            ],
        })
    }

    /// Calls `each` for every segment in order with its index, the ratio of its forward flow, and its memory.
    fn walk<'m>(&self, memory: &'m [f32], mut each: impl FnMut(usize, &'a Segment<E>, f32, &'m [f32])) {
        let (mut slot, mut ratio) = (self.first_memory, self.first_ratio);
        let network: &'a Network<'_, E> = self.network;
        let segments = network.segments.get(self.segments.clone()).unwrap_or(&[]);
        for (index, segment) in self.segments.clone().zip(segments) {
            let slots = segment.element.memory();
            each(index, segment, ratio, memory.get(slot..slot + slots).unwrap_or(&[]));
            slot += slots;
            ratio /= 1.0 + segment.element.removal();
        }
    }

    /// Calls `each` for every segment in order with its index, the ratio of its forward flow, and its laws for forward
    /// and for reversed flow around the flow `w` [kg/s].
    pub(crate) fn laws(&self, w: f32, memory: &[f32], mut each: impl FnMut(usize, f32, &[Law; 2])) {
        self.walk(memory, |index, segment, ratio, own| {
            let ends = if segment.element.responds() { self.ends(index, w, memory) } else { self.ends_pa };
            each(index, ratio, &self.both_laws(segment, ratio, w, ends, own));
        });
    }

    /// Advances the memories by `step_s` [s], at the flow `w` [kg/s].
    pub(crate) fn advance(&self, w: f32, step_s: f32, memory: &mut [f32]) {
        let mut slot = self.first_memory;
        let segments = self.network.segments.get(self.segments.clone()).unwrap_or(&[]);
        for (index, segment) in self.segments.clone().zip(segments) {
            let slots = segment.element.memory();
            if slots > 0 {
                let [inlet_pa, outlet_pa] = self.ends(index, w, memory);
                let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let at = Operating { inlet_pa, outlet_pa, ..Operating::plain(inputs, w) };
                segment.element.advance(&at, step_s, memory.get_mut(slot..slot + slots).unwrap_or(&mut []));
                slot += slots;
            }
        }
    }

    /// The law of one segment in the direction of the flow `w` [kg/s].
    pub(crate) fn law_of(&self, place: usize, w: f32, memory: &[f32]) -> Law {
        let mut found = Law::quadratic(0.0);
        self.laws(w, memory, |index, _, [forward, reverse]| {
            if index == place {
                found = if w < 0.0 { *reverse } else { *forward };
            }
        });
        found
    }

    /// Absolute pressures at both ends of a segment [Pa].
    fn ends(&self, place: usize, w: f32, memory: &[f32]) -> [f32; 2] {
        let [mut inlet, mut outlet] = self.ends_pa;
        if self.segments.len() == 1 {
            return self.ends_pa;
        }
        // Whether what lies ahead and behind loses what is known without the pressures there; what it loses itself.
        let (mut knows_inlet, mut knows_outlet, mut own_loss) = (true, true, 0.0);
        self.walk(memory, |index, segment, ratio, own| {
            if segment.element.needs_both_ends() {
                knows_inlet &= index >= place;
                knows_outlet &= index <= place;
                return;
            }
            let flow = if w > 0.0 { ratio * w } else { w };
            let [forward, reverse] = self.both_laws(segment, ratio, w, self.ends_pa, own);
            let law = if w > 0.0 { forward } else { reverse };
            let loss = law.resistance * flow * flow.abs() + law.linear * flow - law.head;
            match index.cmp(&place) {
                Ordering::Less => inlet -= loss,
                Ordering::Equal => own_loss = loss,
                Ordering::Greater => outlet += loss,
            }
        });
        if !knows_inlet {
            inlet = outlet + own_loss;
        } else if !knows_outlet {
            outlet = inlet - own_loss;
        }
        [math::larger(inlet, 0.0), math::larger(outlet, 0.0)]
    }

    /// Laws of a segment for forward and for reversed flow.
    fn both_laws(
        &self,
        segment: &Segment<E>,
        ratio: f32,
        w: f32,
        [inlet_pa, outlet_pa]: [f32; 2],
        memory: &[f32],
    ) -> [Law; 2] {
        let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let flow = if w > 0.0 { ratio * w } else { w };
        let at = Operating { inlet_pa, outlet_pa, memory, ..Operating::plain(inputs, flow) };
        let of = |(density_ratio, temperature_k): Gas| Operating { density_ratio, temperature_k, ..at };
        let [from, to] = self.gases;
        let forward = segment.element.law(&of(from));
        // A head is the intake's in both directions: another one for reversed flow would be a jump at rest.
        [forward, Law { head: forward.head, ..segment.element.reverse_law(&of(to)) }]
    }
}
