//! Reads everything that is published from a running simulator.

use eclss_core::element::Operating;
use eclss_core::{Element, Method, Simulator, operator};
use eclss_network_file::Loaded;

use super::feed::Value;
use crate::trace::{Figure, Segments};

/// What is published of a network, and how it is read.
#[derive(Debug, Clone)]
pub(crate) struct Reading {
    figures: Vec<Figure>,
}

/// Published values: everything that a run can write down, then φ of what the method slows: `relaxation` lines,
/// `adaptive` nodes.
pub(crate) fn values(loaded: &Loaded, method: Method) -> Vec<Value> {
    let records = loaded.all_records();
    let mut values: Vec<_> = records
        .iter()
        .map(|record| Value { id: record.name.clone(), unit: record.quantity.unit().to_owned() })
        .collect();
    let slowed = match method {
        Method::Relaxation => &loaded.names.lines[..],
        Method::Adaptive => &loaded.names.nodes[..],
        Method::Euler | Method::ImplicitEuler | Method::TrBdf2 => &[],
    };
    values.extend(slowed.iter().map(|id| Value { id: format!("{id}.phi"), unit: "1".to_owned() }));
    values
}

impl Reading {
    pub(crate) fn new(loaded: &Loaded) -> Self {
        let figures = loaded.all_records().iter().map(|record| Figure::Point(record.quantity)).collect();
        Self { figures }
    }

    /// Reads all values, in the order of [`values`].
    pub(crate) fn read(&self, simulator: &Simulator<'_>, segments: &mut Segments, into: &mut [f32]) {
        segments.read(simulator);
        for (figure, value) in self.figures.iter().zip(into.iter_mut()) {
            *value = figure.read(simulator, segments);
        }
        let nodes = simulator.settings().method == Method::Adaptive;
        for (place, value) in into.iter_mut().skip(self.figures.len()).enumerate() {
            *value = if nodes { simulator.node_phi(place) } else { line_phi(simulator, place) };
        }
    }
}

/// φ of a line's flow row in method `relaxation`, at its present flow.
fn line_phi(simulator: &Simulator<'_>, line: usize) -> f32 {
    let network = simulator.network();
    let settings = simulator.settings();
    let Some(description) = network.lines.get(line) else { return f32::NAN };
    let w = simulator.line_flow_kg_s(line);
    let (mut folded, mut linear, mut ratio) = (0.0, 0.0, 1.0);
    for segment in network.segments_of(description).iter().skip(description.flow_segment as usize) {
        let inputs = simulator.inputs().get(segment.first_input as usize..).unwrap_or(&[]);
        let law = segment.element.law(&Operating::plain(inputs, w));
        folded += law.resistance * ratio * ratio;
        linear += law.linear * ratio;
        if w > 0.0 {
            ratio /= 1.0 + segment.element.removal();
        }
    }
    let h = settings.step_us as f32 * 1e-6;
    operator::phi(h * (2.0 * w.abs() * folded + linear))
}
