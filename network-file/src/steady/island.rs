//! Islands: what hangs together through lines, and which of them no boundary holds.

use eclss_core::element::Element;
use eclss_core::{Network, NodeKind};

use super::{SteadyError, capacity};

/// An island without boundary.
#[derive(Debug, Clone)]
pub(super) struct Closed {
    /// Its nodes.
    pub(super) nodes: Vec<u32>,
    /// Its lines that take mass out.
    pub(super) drains: Vec<u32>,
    /// The node whose pressure stands for the level, a volume.
    pub(super) pinned: u32,
}

/// All islands without boundary.
#[derive(Debug, Clone)]
pub(super) struct Islands {
    pub(super) closed: Vec<Closed>,
}

impl Islands {
    /// Finds them; refuses one that has no volume either.
    pub(super) fn find<E: Element>(network: &Network<'_, E>) -> Result<Self, SteadyError> {
        let mut root: Vec<u32> = (0..network.nodes.len() as u32).collect();
        for line in network.lines {
            let (from, to) = (find(&mut root, line.from), find(&mut root, line.to));
            root[from.max(to) as usize] = from.min(to);
        }
        let mut held = vec![false; network.nodes.len()];
        for (index, node) in (0u32..).zip(network.nodes) {
            held[find(&mut root, index) as usize] |= node.kind == NodeKind::Boundary;
        }
        // Index in `closed` of the island with this root.
        let mut place = vec![usize::MAX; network.nodes.len()];
        let mut closed: Vec<Closed> = Vec::new();
        for index in 0..network.nodes.len() as u32 {
            let root = find(&mut root, index) as usize;
            if held[root] {
                continue;
            }
            if place[root] == usize::MAX {
                place[root] = closed.len();
                closed.push(Closed { nodes: Vec::new(), drains: Vec::new(), pinned: index });
            }
            closed[place[root]].nodes.push(index);
        }
        for (index, line) in (0u32..).zip(network.lines) {
            let drains = network.segments_of(line).iter().any(|segment| segment.element.removal() > 0.0);
            let root = find(&mut root, line.from) as usize;
            if drains && !held[root] {
                closed[place[root]].drains.push(index);
            }
        }
        for island in &mut closed {
            // The largest volume: the least of its pressure is lost to rounding.
            let size = |node: &u32| capacity(&network.nodes[*node as usize]);
            let largest = island.nodes.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)));
            match largest.filter(|node| size(node) > 0.0) {
                Some(node) => island.pinned = node,
                None => return Err(SteadyError::Floating { nodes: island.nodes.clone() }),
            }
        }
        Ok(Self { closed })
    }
}

/// The root of a node's island; shortens the way for the next time.
fn find(root: &mut [u32], mut node: u32) -> u32 {
    while root[node as usize] != node {
        root[node as usize] = root[root[node as usize] as usize];
        node = root[node as usize];
    }
    node
}
