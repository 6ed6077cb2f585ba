//! Pressure that a line loses over its flow, in `f64`: the sum of its elements' laws.
//!
//! `loss = R·w·max(|w|, w_lin) + L·w − head`, `w_lin = √(y_lin/R)`, w the flow at the line's flow segment. R, L and
//! head are sums over the elements; an element ahead of a drain feels more flow than w, and less behind it.

use eclss_core::{Element, Law};
use eclss_core::{Line, Network};

use super::response::{self, Circumstances};

/// Smallest flow at which a slope is taken [kg/s]: a line without laminar limit has none at rest.
const SMALLEST_FLOW_KG_S: f64 = 1e-12;
/// Smallest share of a pressure's change that a flow feels [1]: without one a node could be left without an equation.
const LEAST_FEELING: f64 = 1e-9;

/// A line's law at its present flow, and what it does to the mass that goes through.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Characteristic {
    /// ΣR [Pa·s²/kg²].
    quadratic: f64,
    /// ΣL [Pa·s/kg].
    linear: f64,
    /// Σ head [Pa].
    pub(super) head: f64,
    /// Flow below which the line is linear [kg/s].
    laminar: f64,
    /// Flow taken from the inlet node per flow w [1].
    pub(super) inlet: f64,
    /// Flow given to the outlet node per flow w [1].
    pub(super) outlet: f64,
    /// How much of a change of the inlet's and of the outlet's pressure drives the flow [1]: 1 where the law does not
    /// look at pressures itself, 0 for the outlet of a choked flow.
    pub(super) feels: [f64; 2],
    /// Flow of a line in which pressures have no say [kg/s]: a source's, or none through a closed seat.
    pub(super) source_kg_s: Option<f64>,
}

impl Characteristic {
    /// States the law of `line` around the flow `w` [kg/s] at its flow segment.
    pub(super) fn at<E: Element>(
        network: &Network<'_, E>,
        inputs: &[f32],
        line: &Line,
        w: f64,
        circumstances: Option<&Circumstances<'_>>,
    ) -> Self {
        let laws = response::laws(network, inputs, line, w, circumstances);
        let mut sums = Self::sum(network, line, w, &laws);
        sums.feels = [1.0; 2];
        if let Some(here) = circumstances {
            for side in 0..2 {
                let shift = response::shift_pa(here.nodes_pa[side]);
                let mut there = *here;
                there.nodes_pa[side] += shift;
                let laws = response::laws(network, inputs, line, w, Some(&there));
                let slope = (Self::sum(network, line, w, &laws).loss(w) - sums.loss(w)) / shift;
                let feels = if side == 0 { 1.0 - slope } else { 1.0 + slope };
                sums.feels[side] = feels.max(LEAST_FEELING);
            }
        }
        sums
    }

    fn sum<E: Element>(network: &Network<'_, E>, line: &Line, w: f64, laws: &[Law]) -> Self {
        let segments = network.segments_of(line);
        let gain = |segment: &eclss_core::Segment<E>| {
            if w > 0.0 { 1.0 + f64::from(segment.element.removal()) } else { 1.0 }
        };
        let ahead = segments.get(..line.flow_segment as usize).unwrap_or(&[]);
        let mut ratio: f64 = ahead.iter().map(gain).product();
        let mut sums = Self { inlet: ratio, ..Self::default() };
        for (segment, law) in segments.iter().zip(laws) {
            sums.quadratic += f64::from(law.resistance) * ratio * ratio;
            sums.linear += f64::from(law.linear) * ratio;
            sums.head += f64::from(law.head);
            if law.is_source() {
                sums.source_kg_s = Some(f64::from(law.head) / f64::from(law.linear));
            } else if law.is_tight() {
                sums.source_kg_s = Some(0.0);
            }
            ratio /= gain(segment);
        }
        sums.outlet = ratio;
        sums.laminar = (f64::from(line.laminar_below_pa) / sums.quadratic.max(f64::MIN_POSITIVE)).sqrt();
        sums
    }

    /// Pressure lost at flow `w` [Pa]; negative where the head is larger.
    pub(super) fn loss(&self, w: f64) -> f64 {
        self.quadratic * w * w.abs().max(self.laminar) + self.linear * w - self.head
    }

    /// Slope of the loss at a flow of this `size` [Pa·s/kg], > 0.
    pub(super) fn slope(&self, size: f64) -> f64 {
        let quadratic = if size > self.laminar { 2.0 * size.max(SMALLEST_FLOW_KG_S) } else { self.laminar };
        (self.quadratic * quadratic + self.linear).max(f64::MIN_POSITIVE)
    }

    /// Flow that the pressure difference `drop_pa` [Pa] drives [kg/s], with the sums of the present direction.
    pub(super) fn driven(&self, drop_pa: f64) -> f64 {
        let y = drop_pa + self.head;
        let laminar = y / (self.quadratic * self.laminar + self.linear);
        if laminar.abs() < self.laminar {
            return laminar;
        }
        let root = (self.linear * self.linear + 4.0 * self.quadratic * y.abs()).sqrt();
        2.0 * y / (self.linear + root).max(f64::MIN_POSITIVE)
    }
}
