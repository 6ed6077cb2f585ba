//! Eigenvalues without and with the operator side by side.

use eclss_core::{Element, Network};

use super::{Sweep, SweepPoint, crossings};

/// One line over a range of one input at one step.
#[derive(Debug, Clone)]
pub struct Spectrum {
    /// Step [µs].
    pub step_us: u32,
    /// Without the operator.
    pub plain: Vec<SweepPoint>,
    /// With the operator.
    pub stabilised: Vec<SweepPoint>,
    /// Values at which the spectral radius without the operator passes 1.
    pub edges: Vec<f64>,
    /// Values at which the spectral radius with the operator passes 1.
    pub stabilised_edges: Vec<f64>,
}

impl Spectrum {
    /// Computes line `line` of `network` while input slot `input` moves over `from…to` in `count` values.
    pub fn compute<E: Element>(
        network: &Network<'_, E>,
        line: usize,
        input: usize,
        step_us: u32,
        (from, to, count): (f64, f64, usize),
    ) -> Option<Self> {
        let step_s = f64::from(step_us) / 1e6;
        let sweep = Sweep { network, line, input, step_s, stabilised: false };
        let plain = sweep.points(from, to, count)?;
        let edges = crossings(&sweep, &plain);
        let sweep = Sweep { stabilised: true, ..sweep };
        let stabilised = sweep.points(from, to, count)?;
        let stabilised_edges = crossings(&sweep, &stabilised);
        Some(Self { step_us, plain, stabilised, edges, stabilised_edges })
    }

    /// Values of the input from first to last.
    pub fn range(&self) -> (f64, f64) {
        let value = |point: Option<&SweepPoint>| point.map_or(0.0, |point| point.value);
        (value(self.plain.first()), value(self.plain.last()))
    }
}

/// Returns the point with the largest spectral radius.
pub fn worst(points: &[SweepPoint]) -> Option<&SweepPoint> {
    points.iter().max_by(|a, b| a.radius.total_cmp(&b.radius))
}
