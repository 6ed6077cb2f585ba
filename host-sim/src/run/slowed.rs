//! Tells which node the operator of `adaptive` slowed most, where that bends what a run shows.

use eclss_core::{Method, Simulator};

use crate::Source;

/// φ below which a node is named [1, chosen]: it stores as if its volume were more than twice as large.
pub const TOLD_BELOW: f32 = 0.5;
/// A node is looked for again when φ has fallen to this part of the last one told [1]: a φ that falls slowly would
/// have all nodes looked at in every step.
const AGAIN: f32 = 0.9;

/// The node that was slowed most.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Slowed {
    /// Its id.
    pub node: String,
    /// Its φ, within a tenth of the smallest of the run [1].
    pub phi: f32,
    /// When it had that φ [s].
    pub t_s: f64,
    /// Steps in which any node was below [`TOLD_BELOW`].
    pub ticks: u64,
}

/// What is known of it during a run.
#[derive(Debug, Default)]
pub(super) struct Watch {
    ticks: u64,
    /// Node, φ and plant time [µs].
    worst: Option<(usize, f32, u64)>,
}

impl Watch {
    /// Looks at the last step.
    pub(super) fn look(&mut self, simulator: &Simulator<'_>, method: Method) {
        let phi = simulator.margin().phi;
        // The φ of other methods belongs to lines and to pseudo-time.
        if method != Method::Adaptive || phi >= TOLD_BELOW {
            return;
        }
        self.ticks += 1;
        if self.worst.is_some_and(|(_, worst, _)| phi > AGAIN * worst) {
            return;
        }
        let nodes = 0..simulator.network().nodes.len();
        let smallest = nodes.map(|node| (node, simulator.node_phi(node))).min_by(|a, b| a.1.total_cmp(&b.1));
        self.worst = smallest.map(|(node, phi)| (node, phi, simulator.time_us()));
    }

    /// What was found.
    pub(super) fn found(self, source: &Source) -> Option<Slowed> {
        let (node, phi, time_us) = self.worst?;
        let node = source.loaded.names.nodes.get(node).cloned().unwrap_or_default();
        Some(Slowed { node, phi, t_s: crate::Duration::from_us(time_us).seconds(), ticks: self.ticks })
    }
}
