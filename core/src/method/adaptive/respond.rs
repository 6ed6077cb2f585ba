//! Lines whose laws respond to pressures, direction, memory or density: their sums at the pressures of the step's
//! start, found with the line's own flow in a fixed number of rounds.

use super::INNER_ITERATIONS;
use super::layout::{NodeFigures, State, Sums, Work};
use super::line::{set_sums, special_flow};
use crate::component::Element;
use crate::method::common;
use crate::method::responsive::{Given, Reach};
use crate::{Network, Responsive};

/// Advances the memories of all responsive lines by `h` [s], and states their laws.
#[inline(never)]
pub(super) fn respond<E: Element>(
    network: &Network<'_, E>,
    h: f32,
    given: Given<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    for entry in network.responsive {
        let index = entry.line as usize;
        let nodes: &[NodeFigures] = work.nodes;
        let gauge = |node: usize| nodes.get(node).map_or(0.0, |[pressure, ..]| *pressure);
        let (Some((reach, difference)), Some([w, ..]), Some(&[place, _, smallest])) =
            (whole_line(network, entry, given, gauge), state.lines.get_mut(index), work.laws.get(index))
        else {
            continue;
        };
        reach.advance(*w, h, state.memory);
        let mut sums = [0.0; 5];
        for _ in 0..INNER_ITERATIONS {
            sums = sums_at(&reach, *w, state.memory);
            (*w, _) = special_flow(difference, &sums, smallest);
        }
        if let Some(special) = work.specials.get_mut(place.to_bits() as usize) {
            set_sums(special, sums);
        }
    }
}

/// A responsive line as one reach between nodes at the gauge pressures that `gauge_pa` gives, and the pressure
/// difference between them [Pa].
pub(crate) fn whole_line<'a, 'n, E: Element>(
    network: &'a Network<'n, E>,
    entry: &Responsive,
    given: Given<'a>,
    gauge_pa: impl Fn(usize) -> f32,
) -> Option<(Reach<'a, 'n, E>, f32)> {
    let line = network.lines.get(entry.line as usize)?;
    let gauges = [gauge_pa(line.from as usize), gauge_pa(line.to as usize)];
    let segments = line.first_segment as usize..(line.first_segment + line.segments) as usize;
    let mut reach = Reach::new(network, entry, given, segments, gauges, gauges)?;
    // The flow is that of the line's flow segment.
    common::flow_ratios(network, line, |place, _, ratio| {
        if place == 0 {
            reach.first_ratio = ratio;
        }
    });
    Some((reach, gauges[0] - gauges[1]))
}

/// Sums of a responsive line around its flow `w` [kg/s].
fn sums_at<E: Element>(reach: &Reach<'_, '_, E>, w: f32, memory: &[f32]) -> Sums {
    let mut sums = [0.0; 5];
    reach.laws(w, memory, |_, ratio, [forward, reverse]| {
        let [quadratic, linear, quadratic_back, linear_back, head] = &mut sums;
        *quadratic += forward.resistance * (ratio * ratio);
        *linear += forward.linear * ratio;
        *quadratic_back += reverse.resistance;
        *linear_back += reverse.linear;
        *head += if w < 0.0 { reverse.head } else { forward.head };
    });
    sums
}
