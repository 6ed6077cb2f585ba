//! Eigenvalues of one line while one input moves through its range.

use eclss_core::{Element, Margin, Network};

use super::{Complex, Disc, LineModel, eigenvalues, gershgorin, spectral_radius};

/// What is swept.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'n, E> {
    /// The description.
    pub network: &'n Network<'n, E>,
    /// The line.
    pub line: usize,
    /// Slot of the input that moves.
    pub input: usize,
    /// Step [s].
    pub step_s: f64,
    /// Whether the operator acts.
    pub stabilised: bool,
}

/// The line at one value of the input, in its steady state.
#[derive(Debug, Clone)]
pub struct SweepPoint {
    /// Value of the input.
    pub value: f64,
    /// Steady flow [kg/s].
    pub flow_kg_s: f64,
    /// φ of the flow row; 1 without the operator.
    pub phi: f64,
    /// Eigenvalues of I + h·J.
    pub eigenvalues: Vec<Complex>,
    /// Their spectral radius.
    pub radius: f64,
    /// Gershgorin discs of the balanced matrix.
    pub discs: Vec<Disc>,
    /// Bound and proof as the kernel reports them.
    pub margin: Margin,
}

impl<E: Element> Sweep<'_, E> {
    /// The line at `value` of the input; `None` where the line or the input does not exist or eigenvalues
    /// cannot be computed.
    pub fn at(&self, value: f64) -> Option<SweepPoint> {
        let mut inputs = self.network.inputs.to_vec();
        if self.input < inputs.len() {
            inputs[self.input] = value as f32;
        }
        let model = LineModel::new(self.network, self.line, &inputs)?;
        let flow_kg_s = model.steady_flow_kg_s();
        let phi = if self.stabilised { model.phi(flow_kg_s, self.step_s) } else { 1.0 };
        let matrix = model.step_matrix(flow_kg_s, self.step_s, phi);
        let eigenvalues = eigenvalues(&matrix)?;
        Some(SweepPoint {
            value,
            flow_kg_s,
            phi,
            radius: spectral_radius(&eigenvalues),
            eigenvalues,
            discs: gershgorin(&matrix),
            margin: model.margin(flow_kg_s, self.step_s, phi),
        })
    }

    /// The line at `count` values from `from` to `to`, evenly spaced.
    pub fn points(&self, from: f64, to: f64, count: usize) -> Option<Vec<SweepPoint>> {
        let last = count.max(2) - 1;
        (0..=last).map(|k| self.at(from + (to - from) * k as f64 / last as f64)).collect()
    }
}

/// Returns the values between points of a sweep at which the spectral radius passes 1, refined by bisection.
pub fn crossings<E: Element>(sweep: &Sweep<'_, E>, points: &[SweepPoint]) -> Vec<f64> {
    let outside = |radius: f64| radius > 1.0;
    let pairs = points.windows(2).filter_map(|pair| if let [a, b] = pair { Some((a, b)) } else { None });
    let changes = pairs.filter(|(a, b)| outside(a.radius) != outside(b.radius));
    changes
        .map(|(a, b)| {
            let (mut same, mut other) = (a.value, b.value);
            for _ in 0..40 {
                let middle = f64::midpoint(same, other);
                match sweep.at(middle) {
                    Some(point) if outside(point.radius) == outside(a.radius) => same = middle,
                    Some(_) => other = middle,
                    None => break,
                }
            }
            f64::midpoint(same, other)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::example;

    #[test]
    fn the_papers_statement_on_eigenvalues_holds() {
        let network = example::paper_loop();
        for (step_s, edge) in [(1e-3, 0.198), (1e-2, 0.43)] {
            let plain = Sweep { network: &network, line: 0, input: 1, step_s, stabilised: false };
            let points = plain.points(0.02, 1.0, 99).unwrap();
            let edges = crossings(&plain, &points);
            assert!(edges.len() == 1 && (edges[0] - edge).abs() < 0.003, "{step_s}: {edges:?}");
            let with_phi = Sweep { stabilised: true, ..plain }.points(0.02, 1.0, 99).unwrap();
            let worst = with_phi.iter().map(|point| point.radius).fold(0.0, f64::max);
            assert!(worst < 1.0, "{step_s}: {worst}");
        }
    }

    #[test]
    fn the_kernels_bound_is_a_bound_where_it_is_called_a_proof() {
        let network = example::paper_loop();
        for step_s in [1e-4, 1e-3, 1e-2] {
            let sweep = Sweep { network: &network, line: 0, input: 1, step_s, stabilised: true };
            for point in sweep.points(0.02, 1.0, 99).unwrap() {
                if point.margin.proof == eclss_core::Proof::Dominant {
                    let bound = f64::from(point.margin.spectral_bound) + 1e-6;
                    assert!(point.radius <= bound, "{}: {} {bound}", point.value, point.radius);
                }
            }
        }
    }
}
