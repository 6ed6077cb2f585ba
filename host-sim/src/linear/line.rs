//! One line at given inputs: its steady flow and its linearisation there.

use eclss_core::{Element, Line, Network, Operating, Segment, operator};
use nalgebra::DMatrix;

/// Smallest flow at which the kernel turns a linear loss into a quadratic one [kg/s].
const SMALLEST_FLOW: f64 = 1e-6;
/// Flows are looked for within this [kg/s].
const LARGEST_FLOW: f64 = 1e3;

/// One line with held ends and held inputs.
#[derive(Debug, Clone, Copy)]
pub struct LineModel<'n, E> {
    line: &'n Line,
    segments: &'n [Segment<E>],
    inputs: &'n [f32],
    /// `p_from − p_to` [Pa].
    driving_pa: f64,
}

/// A line's losses at one flow, each as `chord·w·size + linear·w` with its slope by w.
struct Losses {
    /// Chord resistance of each row before the flow row [Pa·s²/kg²], with the mass taken out on the way.
    rows: Vec<f64>,
    /// Quadratic resistance of the flow row [Pa·s²/kg²].
    own: f64,
    /// Linear resistance of the flow row [Pa·s/kg].
    own_linear: f64,
    /// Sum of all heads [Pa].
    head: f64,
    /// |w|, or the laminar limit flow where that is larger [kg/s].
    size: f64,
    /// Slope of `w·size` [kg/s].
    size_slope: f64,
    /// Slope of each row's loss, then of the flow row's [Pa·s/kg].
    slopes: Vec<f64>,
}

impl<'n, E: Element> LineModel<'n, E> {
    /// The line `index` of `network` with its inputs at `inputs` and its ends at their start pressures; `None`
    /// if it does not exist.
    pub fn new(network: &'n Network<'_, E>, index: usize, inputs: &'n [f32]) -> Option<Self> {
        let line = network.lines.get(index)?;
        let gauge = |node: u32| network.nodes.get(node as usize).map(|node| f64::from(node.start_gauge_pa));
        let driving_pa = gauge(line.from)? - gauge(line.to)?;
        Some(Self { line, segments: network.segments_of(line), inputs, driving_pa })
    }

    fn losses(&self, w: f64) -> Losses {
        let place = self.line.flow_segment as usize;
        let before = self.segments.get(..place).unwrap_or(&[]);
        let removal = |segment: &Segment<E>| 1.0 + f64::from(segment.element.removal());
        let mut ratio: f64 = before.iter().map(removal).product();
        let (mut rows, mut slopes) = (Vec::new(), Vec::new());
        let (mut own, mut own_linear, mut head) = (0.0, 0.0, 0.0);
        for (index, segment) in self.segments.iter().enumerate() {
            let inputs = self.inputs.get(segment.first_input as usize..).unwrap_or(&[]);
            // Nothing is drained from reversed flow.
            let factor = if w > 0.0 { ratio } else { 1.0 };
            let flow = factor * w;
            let at = Operating::plain(inputs, flow as f32);
            let law = segment.element.law(&at);
            let (resistance, linear) = (f64::from(law.resistance), f64::from(law.linear));
            head += f64::from(law.head);
            if index < place {
                rows.push((resistance + linear / flow.abs().max(SMALLEST_FLOW)) * factor * factor);
                slopes.push(2.0 * resistance * factor * factor * w.abs() + linear * factor);
            } else {
                own += resistance * factor * factor;
                own_linear += linear * factor;
            }
            ratio /= removal(segment);
        }
        let laminar = (f64::from(self.line.laminar_below_pa) / (rows.iter().sum::<f64>() + own)).sqrt();
        let size = w.abs().max(laminar);
        let size_slope = if w.abs() < laminar { laminar } else { 2.0 * size };
        if w.abs() < laminar {
            slopes = rows.iter().map(|chord| chord * laminar).collect();
        }
        slopes.push(own * size_slope + own_linear);
        Losses { rows, own, own_linear, head, size, size_slope, slopes }
    }

    /// Driving pressure left over at flow `w` [Pa]; it falls as the flow rises.
    fn residual_pa(&self, w: f64) -> f64 {
        let losses = self.losses(w);
        let total = losses.rows.iter().sum::<f64>() + losses.own;
        self.driving_pa + losses.head - total * w * losses.size - losses.own_linear * w
    }

    /// The flow at which losses and heads balance [kg/s], by bisection to the last bit.
    pub fn steady_flow_kg_s(&self) -> f64 {
        let (mut low, mut high) = (-LARGEST_FLOW, LARGEST_FLOW);
        for _ in 0..200 {
            let middle = f64::midpoint(low, high);
            if self.residual_pa(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        f64::midpoint(low, high)
    }

    /// φ at flow `w` for a step of `step_s`.
    pub fn phi(&self, w: f64, step_s: f64) -> f64 {
        let own_slope = self.losses(w).slopes.last().copied().unwrap_or(0.0);
        1.0 / (step_s * own_slope).max(1.0)
    }

    /// The matrix I + h·J of one explicit step, linearised at flow `w`: one row for each element before the
    /// flow row, then the flow row, whose rate is multiplied by `phi`.
    pub fn step_matrix(&self, w: f64, step_s: f64, phi: f64) -> DMatrix<f64> {
        let losses = self.losses(w);
        let rows = losses.rows.len();
        let mut matrix = DMatrix::identity(rows + 1, rows + 1);
        for (row, slope) in losses.slopes.iter().enumerate() {
            let rate = if row == rows { step_s * phi } else { step_s };
            if row > 0 {
                matrix[(row, row - 1)] += rate;
            }
            if row < rows {
                matrix[(row, row)] -= rate;
            }
            matrix[(row, rows)] -= rate * slope;
        }
        matrix
    }

    /// What the kernel itself reports for this line at flow `w`: φ, its bound and its proof.
    pub fn margin(&self, w: f64, step_s: f64, phi: f64) -> eclss_core::Margin {
        let losses = self.losses(w);
        let row = operator::FlowRow {
            step: step_s as f32,
            slope: losses.size_slope as f32,
            own: losses.own as f32,
            own_linear: losses.own_linear as f32,
            others: losses.rows.iter().sum::<f64>() as f32,
            rows: losses.rows.len() as f32,
        };
        row.margin(phi as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::example;

    #[test]
    fn the_steady_flow_of_the_paper_is_found_in_closed_form() {
        let network = example::paper_loop();
        let square = |factor: f64| factor * factor;
        let others = (805.874 + 12_984.201 + 5_337.527 + 16_007.337) * square(1.0045) + 4_577.822;
        for opening in [1.0f32, 0.2, 0.02] {
            let inputs = [1.0, opening];
            let model = LineModel::new(&network, 0, &inputs).unwrap();
            let valve = 85.978_462 * f64::from(opening).powf(-3.134_165);
            let exact = (300.0 / (others + valve)).sqrt();
            let found = model.steady_flow_kg_s();
            assert!((found / exact - 1.0).abs() < 1e-6, "{opening}: {found} {exact}");
        }
    }

    /// Central differences of the losses themselves against the matrix.
    fn the_matrix_is_their_derivative(network: &Network<'_>, inputs: &[f32]) {
        let model = LineModel::new(network, 0, inputs).unwrap();
        let w = model.steady_flow_kg_s();
        let (h, d) = (1e-3, w.abs() * 1e-3);
        let matrix = model.step_matrix(w, h, 1.0);
        let loss = |w: f64| {
            let losses = model.losses(w);
            let chord = |resistance: &f64| resistance * w * losses.size;
            let mut list: Vec<_> = losses.rows.iter().map(chord).collect();
            list.push(losses.own * w * losses.size + losses.own_linear * w);
            list
        };
        let last = matrix.nrows() - 1;
        for (row, (high, low)) in loss(w + d).into_iter().zip(loss(w - d)).enumerate() {
            let slope = (high - low) / (2.0 * d);
            let entry = if row == last { 1.0 - matrix[(row, last)] } else { -matrix[(row, last)] };
            assert!((entry / (h * slope) - 1.0).abs() < 1e-4, "row {row}: {entry} {}", h * slope);
        }
    }

    #[test]
    fn the_matrix_is_the_derivative_of_the_step() {
        the_matrix_is_their_derivative(&example::paper_loop(), &[1.0, 0.3]);
    }

    #[test]
    fn also_with_linear_losses_and_where_the_flow_is_laminar() {
        let network = example::paper_loop();
        let mut segments = network.segments.to_vec();
        segments[4].element = eclss_core::components::ReferencePipe {
            pressure_drop_pa: 34.0,
            mass_flow_kg_s: 0.086,
            exponent: 1.6,
        }
        .into_any();
        let active = [(1, 0), (4, 0), (5, 0)].map(|(segment, line)| eclss_core::Active { segment, line });
        let mixed = Network { segments: &segments, active: &active, ..network };
        the_matrix_is_their_derivative(&mixed, &[1.0, 0.3]);
        let mut lines = network.lines.to_vec();
        lines[0].laminar_below_pa = 1e3;
        the_matrix_is_their_derivative(&Network { lines: &lines, ..network }, &[1.0, 0.3]);
    }
}
