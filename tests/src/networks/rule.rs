//! The explicit step of `adaptive` in `f64`, written from the equations, with a choice of the rule that slows
//! a node: secant conductance w/y, as the theorem asks, or tangent dw/dy, as linearisation suggests.

use eclss_core::NodeKind;

use super::draw::Drawn;
use eclss_core::Element;

/// Which conductance the operator looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// G = w/y.
    Secant,
    /// G = dw/dy.
    Tangent,
}

/// Lines with a quadratic law between nodes.
#[derive(Debug, Clone)]
pub struct Explicit {
    /// From, to, R [Pa·s²/kg²], head [Pa], `y_lin` [Pa].
    lines: Vec<(usize, usize, f64, f64, f64)>,
    /// h·Rg·T/V [Pa·s/kg]; 0 where the pressure is held.
    rate: Vec<f64>,
    /// Pressures [Pa gauge].
    pub gauge: Vec<f64>,
}

impl Explicit {
    /// Takes a drawn network without drains, with its inputs.
    pub fn new(drawn: &Drawn, inputs: &[f32]) -> Self {
        let network = drawn.network(inputs);
        let line = |line: &eclss_core::Line| {
            let (mut resistance, mut head) = (0.0, 0.0);
            for segment in network.segments_of(line) {
                let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
                let at = eclss_core::Operating::plain(inputs, 0.0);
                let law = segment.element.law(&at);
                resistance += f64::from(law.resistance);
                head += f64::from(law.head);
            }
            (line.from as usize, line.to as usize, resistance, head, f64::from(line.laminar_below_pa))
        };
        let step_s = f64::from(drawn.step_us) * 1e-6;
        let rate = |node: &eclss_core::Node| match node.kind {
            NodeKind::Cabin { volume_m3 } => {
                step_s * 287.05 * f64::from(node.temperature_k) / f64::from(volume_m3)
            }
            NodeKind::Liquid { capacity_kg_pa } => step_s / f64::from(capacity_kg_pa),
            NodeKind::Boundary | NodeKind::Junction => 0.0,
        };
        Self {
            lines: drawn.lines.iter().map(line).collect(),
            rate: drawn.nodes.iter().map(rate).collect(),
            gauge: drawn.nodes.iter().map(|node| f64::from(node.start_gauge_pa)).collect(),
        }
    }

    /// One step with φ = min(1, θ/(h·c·ΣG)).
    pub fn step(&mut self, rule: Rule, theta: f64) {
        let (mut net, mut sum) = (vec![0.0; self.gauge.len()], vec![0.0; self.gauge.len()]);
        for &(from, to, resistance, head, laminar) in &self.lines {
            let y = self.gauge[from] - self.gauge[to] + head;
            let secant = 1.0 / (resistance * y.abs().max(laminar)).sqrt();
            let halved = rule == Rule::Tangent && y.abs() > laminar;
            let conductance = if halved { 0.5 * secant } else { secant };
            net[from] -= secant * y;
            net[to] += secant * y;
            sum[from] += conductance;
            sum[to] += conductance;
        }
        for (((gauge, net), sum), rate) in self.gauge.iter_mut().zip(net).zip(sum).zip(&self.rate) {
            *gauge += rate * net * (theta / (rate * sum)).min(1.0);
        }
    }

    /// Largest deviation of a pressure that is not held from `target` [Pa].
    pub fn distance_pa(&self, target: &[f64]) -> f64 {
        let nodes = self.gauge.iter().zip(target).zip(&self.rate).filter(|(_, rate)| **rate > 0.0);
        nodes.fold(0.0, |most, ((gauge, target), _)| (gauge - target).abs().max(most))
    }
}
