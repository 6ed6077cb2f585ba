//! Laws of a line's elements, in a responsive line at the pressures inside it.
//!
//! Those pressures are the ones at which a flow through the whole line would rest: it is solved for, laws are stated
//! at what every element then loses, and so on until nothing changes.

use eclss_core::{Element, Law, Operating};
use eclss_core::{Line, Network, Responsive, air};

/// Most rounds of the search for the pressures inside a line.
const ROUNDS: u32 = 60;
/// Smallest density ratio [1].
const SMALLEST_RATIO: f64 = 1e-9;

/// What a responsive line looks at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circumstances<'a> {
    pub(super) entry: &'a Responsive,
    /// Absolute pressures of the line's nodes [Pa].
    pub(super) nodes_pa: [f64; 2],
    /// Temperatures of the line's nodes, virtual ones where they hold air of a climate [K].
    pub(super) temperatures_k: [f32; 2],
    /// Memory of the whole network.
    pub(super) memory: &'a [f32],
}

/// By how much a pressure is moved to see what its law makes of it [Pa]: well above the grid of single precision.
pub(super) fn shift_pa(pressure_pa: f64) -> f64 {
    f64::max(2e-5 * pressure_pa, 0.1)
}

/// Laws of all elements of `line` around the flow `w` [kg/s] at its flow segment.
pub(super) fn laws<E: Element>(
    network: &Network<'_, E>,
    inputs: &[f32],
    line: &Line,
    w: f64,
    circumstances: Option<&Circumstances<'_>>,
) -> Vec<Law> {
    let Some(here) = circumstances else {
        let ratios = ratios(network, line, w);
        let segments = network.segments_of(line).iter().zip(ratios);
        let law = |(segment, ratio): (&eclss_core::Segment<E>, f64)| {
            let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            segment.element.law(&Operating::plain(inputs, (ratio * w) as f32))
        };
        return segments.map(law).collect();
    };
    ends(network, inputs, line, w, here).1
}

/// Ratio of the flow at every element's inlet to that at the flow segment.
fn ratios<E: Element>(network: &Network<'_, E>, line: &Line, w: f64) -> Vec<f64> {
    let segments = network.segments_of(line);
    let gain = |segment: &eclss_core::Segment<E>| {
        if w > 0.0 { 1.0 + f64::from(segment.element.removal()) } else { 1.0 }
    };
    let ahead = segments.get(..line.flow_segment as usize).unwrap_or(&[]);
    let mut ratio: f64 = ahead.iter().map(gain).product();
    let mut list = Vec::with_capacity(segments.len());
    for segment in segments {
        list.push(ratio);
        ratio /= gain(segment);
    }
    list
}

/// Absolute pressures at both ends of every element [Pa], and the laws there.
pub(super) fn ends<E: Element>(
    network: &Network<'_, E>,
    inputs: &[f32],
    line: &Line,
    w: f64,
    here: &Circumstances<'_>,
) -> (Vec<[f64; 2]>, Vec<Law>) {
    let segments = network.segments_of(line);
    let drop_pa = here.nodes_pa[0] - here.nodes_pa[1];
    // At first every element has the same share.
    let mut drops = vec![drop_pa / segments.len() as f64; segments.len()];
    let lone = segments.len() == 1;
    let mut answer = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let mut pressure = here.nodes_pa[0];
        let ends = |drop: &f64| {
            let before = pressure;
            pressure -= drop;
            [before.max(0.0), pressure.max(0.0)]
        };
        let ends: Vec<[f64; 2]> = drops.iter().map(ends).collect();
        let laws = laws_between(network, inputs, line, w, here, &ends);
        answer = (ends, laws);
        if lone {
            break;
        }
        let next = shared(network, line, w, drop_pa, &answer.1);
        let moved = next.iter().zip(&drops).map(|(next, last)| (next - last).abs()).fold(0.0, f64::max);
        drops = next;
        if moved <= 1e-9 * here.nodes_pa[0].max(here.nodes_pa[1]) {
            break;
        }
    }
    answer
}

/// What every element loses of `drop_pa` [Pa] when one flow rests with these laws.
fn shared<E: Element>(network: &Network<'_, E>, line: &Line, w: f64, drop_pa: f64, laws: &[Law]) -> Vec<f64> {
    let ratios = ratios(network, line, w);
    let (mut quadratic, mut linear, mut head) = (f64::MIN_POSITIVE, 0.0, 0.0);
    for (law, ratio) in laws.iter().zip(&ratios) {
        quadratic += f64::from(law.resistance) * ratio * ratio;
        linear += f64::from(law.linear) * ratio;
        head += f64::from(law.head);
    }
    let drive = drop_pa + head;
    let root = (linear * linear + 4.0 * quadratic * drive.abs()).sqrt();
    let flow = if linear + root > 0.0 { 2.0 * drive / (linear + root) } else { 0.0 };
    let loss = |(law, ratio): (&Law, &f64)| {
        let flow = ratio * flow;
        f64::from(law.resistance) * flow * flow.abs() + f64::from(law.linear) * flow - f64::from(law.head)
    };
    laws.iter().zip(&ratios).map(loss).collect()
}

fn laws_between<E: Element>(
    network: &Network<'_, E>,
    inputs: &[f32],
    line: &Line,
    w: f64,
    here: &Circumstances<'_>,
    ends: &[[f64; 2]],
) -> Vec<Law> {
    // A line at rest is about to flow where its pressures drive it.
    let forward = if w == 0.0 { here.nodes_pa[0] >= here.nodes_pa[1] } else { w > 0.0 };
    let reference = f64::from(here.entry.reference_density_kg_m3);
    let gas = |side: usize| {
        let temperature_k = here.temperatures_k[side];
        let density = here.nodes_pa[side] / (f64::from(air::GAS_CONSTANT_J_KG_K) * f64::from(temperature_k));
        let ratio = if reference > 0.0 { f64::max(density / reference, SMALLEST_RATIO) } else { 1.0 };
        (ratio as f32, temperature_k)
    };
    let mut slot = here.entry.first_memory as usize;
    let segments = network.segments_of(line).iter().zip(ratios(network, line, w)).zip(ends);
    let law = |((segment, ratio), ends): ((&eclss_core::Segment<E>, f64), &[f64; 2])| {
        let slots = segment.element.memory();
        let memory = here.memory.get(slot..slot + slots).unwrap_or(&[]);
        slot += slots;
        let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let at = |(density_ratio, temperature_k)| Operating {
            density_ratio,
            inlet_pa: ends[0] as f32,
            outlet_pa: ends[1] as f32,
            temperature_k,
            memory,
            ..Operating::plain(inputs, (ratio * w) as f32)
        };
        let ahead = segment.element.law(&at(gas(0)));
        // A head is the intake's in both directions, as in the methods.
        if forward { ahead } else { Law { head: ahead.head, ..segment.element.reverse_law(&at(gas(1))) } }
    };
    segments.map(law).collect()
}
