//! The paper's line in `f64`, from the elements' parameters and independent of every kernel: its steady flow
//! in closed form, and plain explicit Euler on its equations.

use eclss_core::components::{Bed, Fan, HeatExchanger, Pipe, Valve};
use eclss_core::{Element, Network};

/// Flow beyond which a run counts as diverged [kg/s], the limit of the core.
const LIMIT_KG_S: f64 = eclss_core::Fault::FLOW_LIMIT_KG_S as f64;

/// A loss coefficient.
#[derive(Debug, Clone, Copy)]
enum Loss {
    Fixed(f64),
    Valve { open: f64, exponent: f64, leakage: f64 },
}

impl Loss {
    fn at(self, opening: f64) -> f64 {
        match self {
            Self::Fixed(resistance) => resistance,
            Self::Valve { open, exponent, leakage } => open * opening.max(leakage).powf(-exponent),
        }
    }
}

/// One element.
#[derive(Debug, Clone, Copy)]
struct Row {
    head: f64,
    loss: Loss,
    /// Flow here over the flow at the flow segment, squared; for forward flow.
    square_ratio: f64,
}

/// A loop from one node back to it: heads forward, quadratic losses, valves.
#[derive(Debug, Clone)]
pub struct DoubleLoop {
    rows: Vec<Row>,
    flow_row: usize,
    start_kg_s: f64,
}

impl DoubleLoop {
    /// The network's first line with its fans at rated speed; `None` for a line that is not of this kind.
    pub fn of(network: &Network<'_>) -> Option<Self> {
        let line = network.lines.first().filter(|line| line.from == line.to)?;
        let segments = network.segments_of(line);
        let place = line.flow_segment as usize;
        let removal = |segment: &eclss_core::Segment| 1.0 + f64::from(segment.element.removal());
        let mut ratio: f64 = segments.get(..place)?.iter().map(removal).product();
        let mut rows = Vec::new();
        for segment in segments {
            let element = &segment.element;
            let fixed = |resistance: f32| (0.0, Loss::Fixed(f64::from(resistance)));
            let (head, loss) = if let Some(valve) = element.get::<Valve>() {
                let open = f64::from(valve.open_resistance_pa_s2_kg2);
                let (exponent, leakage) = (f64::from(valve.exponent), f64::from(valve.leakage_opening));
                (0.0, Loss::Valve { open, exponent, leakage })
            } else if let Some(fan) = element.get::<Fan>() {
                if fan.linear_pa_s_kg.abs() >= f32::MIN_POSITIVE {
                    return None;
                }
                (f64::from(fan.shutoff_pa), Loss::Fixed(f64::from(fan.quadratic_pa_s2_kg2)))
            } else if let Some(pipe) = element.get::<Pipe>() {
                fixed(pipe.resistance_pa_s2_kg2)
            } else if let Some(part) = element.get::<HeatExchanger>() {
                fixed(part.resistance_pa_s2_kg2)
            } else {
                fixed(element.get::<Bed>()?.resistance_pa_s2_kg2)
            };
            rows.push(Row { head, loss, square_ratio: ratio * ratio });
            ratio /= removal(segment);
        }
        Some(Self { rows, flow_row: place, start_kg_s: f64::from(line.start_flow_kg_s) })
    }

    /// The steady flow at the flow segment [kg/s] with valves at `opening`: `w = √(Σf / ΣR)`.
    pub fn fixed_point_kg_s(&self, opening: f64) -> f64 {
        let head: f64 = self.rows.iter().map(|row| row.head).sum();
        let loss: f64 = self.rows.iter().map(|row| row.loss.at(opening) * row.square_ratio).sum();
        (head / loss).sqrt()
    }

    /// Plain explicit Euler with a step of `step_us` [µs] until `until_us`, valves at `opening(t_us)`: the
    /// time [s] at which the flow leaves its range, if it does.
    pub fn plain_euler_diverges_s(
        &self,
        step_us: u64,
        until_us: u64,
        opening: impl Fn(u64) -> f64,
    ) -> Option<f64> {
        let h = step_us as f64 * 1e-6;
        let (before, folded) = self.rows.split_at_checked(self.flow_row)?;
        let mut gauge = vec![0.0; before.len()];
        let mut w = self.start_kg_s;
        for tick in 0..until_us / step_us {
            let opening = opening(tick * step_us);
            let loss = |row: &Row| {
                let ratio = if w > 0.0 { row.square_ratio } else { 1.0 };
                row.head - row.loss.at(opening) * ratio * w * w.abs()
            };
            let mut upstream = 0.0;
            for (q, row) in gauge.iter_mut().zip(before) {
                let rate = upstream - *q + loss(row);
                upstream = *q;
                *q += h * rate;
            }
            w += h * (upstream + folded.iter().map(loss).sum::<f64>());
            if w.is_nan() || w.abs() > LIMIT_KG_S {
                return Some((tick + 1) as f64 * h);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::LineModel;
    use eclss_core::example;

    #[test]
    fn it_meets_the_printed_flows_to_which_the_parameters_were_fitted() {
        let line = DoubleLoop::of(&example::paper_loop()).unwrap();
        for (opening, printed) in [1.0, 0.02].into_iter().zip(crate::paper::printed::AMESIM_G_S) {
            let flow = line.fixed_point_kg_s(opening) * 1e3;
            assert!((flow - printed).abs() < 5e-5, "{opening}: {flow}");
        }
    }

    #[test]
    fn it_agrees_with_the_bisection_of_the_laws() {
        let network = example::paper_loop();
        let line = DoubleLoop::of(&network).unwrap();
        for opening in [0.9f32, 0.35, 0.07] {
            let inputs = [1.0, opening];
            let found = LineModel::new(&network, 0, &inputs).unwrap().steady_flow_kg_s();
            let exact = line.fixed_point_kg_s(f64::from(opening));
            assert!((found / exact - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn plain_euler_diverges_while_the_valve_closes_and_not_while_it_stands_open() {
        let line = DoubleLoop::of(&example::paper_loop()).unwrap();
        let ramp = |t_us: u64| 1.0 - 0.98 * ((t_us as f64 - 10e6) / 1e6).clamp(0.0, 1.0);
        for step_us in [1_000, 10_000] {
            let time = line.plain_euler_diverges_s(step_us, 26_000_000, ramp).unwrap();
            assert!((10.85..11.0).contains(&time), "{step_us}: {time}");
            assert_eq!(line.plain_euler_diverges_s(step_us, 26_000_000, |_| 1.0), None);
        }
    }
}
