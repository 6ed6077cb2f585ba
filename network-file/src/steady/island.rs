//! Islands: what hangs together through lines, and which of them no boundary holds.

use eclss_core::{Element, Line, Network, NodeKind, Operating};

use super::{SPACE_PA, SteadyError, capacity};

/// An island without boundary, or with none but space.
#[derive(Debug, Clone)]
pub(super) struct Closed {
    /// Its nodes.
    pub(super) nodes: Vec<u32>,
    /// Its lines that take mass out.
    pub(super) drains: Vec<u32>,
    /// Its lines to space.
    pub(super) leaks: Vec<u32>,
    /// Its lines whose flow no pressure moves, to elsewhere.
    pub(super) sources: Vec<u32>,
    /// The node whose pressure stands for the level, a volume.
    pub(super) pinned: u32,
}

/// All islands without boundary.
#[derive(Debug, Clone)]
pub(super) struct Islands {
    pub(super) closed: Vec<Closed>,
    /// Of every node whether it is a boundary that holds nothing: space, into which closed air leaks.
    pub(super) apart: Vec<bool>,
}

/// Whether the node is space.
fn is_space<E: Element>(network: &Network<'_, E>, node: u32) -> bool {
    network.nodes.get(node as usize).is_some_and(|node| {
        let pressure_pa = f64::from(network.reference_pa) + f64::from(node.start_gauge_pa);
        node.kind == NodeKind::Boundary && pressure_pa < SPACE_PA
    })
}

/// Whether pressures have no say in the flow of a line: a source's, or none behind a closed valve.
fn is_source<E: Element>(network: &Network<'_, E>, inputs: &[f32], line: &Line) -> bool {
    network.segments_of(line).iter().any(|segment| {
        let inputs = inputs.get(segment.first_input as usize..).unwrap_or(&[]);
        let law = || segment.element.law(&Operating::plain(inputs, 0.0));
        // One that acts by itself may open.
        let moves = segment.element.memory() > 0;
        segment.element.is_active() && !moves && (law().is_source() || law().is_tight())
    })
}

impl Islands {
    /// Finds them; refuses one that has no volume either. What hangs on space alone counts as closed where it holds gas
    /// and nobody feeds it: `supplied_kg_s` is what comes into every node.
    pub(super) fn find<E: Element>(
        network: &Network<'_, E>,
        inputs: &[f32],
        supplied_kg_s: &[f64],
    ) -> Result<Self, SteadyError> {
        let count = network.nodes.len();
        let mut root: Vec<u32> = (0..count as u32).collect();
        let join = |root: &mut Vec<u32>, line: &Line| {
            let (from, to) = (find(root, line.from), find(root, line.to));
            root[from.max(to) as usize] = from.min(to);
        };
        let to_space = |line: &Line| is_space(network, line.from) != is_space(network, line.to);
        let sources: Vec<bool> = network.lines.iter().map(|line| is_source(network, inputs, line)).collect();
        for (line, source) in network.lines.iter().zip(&sources) {
            if !source && !to_space(line) {
                join(&mut root, line);
            }
        }
        let gas = |index: u32| matches!(network.nodes[index as usize].kind, NodeKind::Cabin { .. });
        // Of every island without space: whether a boundary holds it, whether it has gas, what it is fed with.
        let (mut held, mut airy, mut fed) = (vec![false; count], vec![false; count], vec![0.0; count]);
        for (index, node) in (0u32..).zip(network.nodes) {
            let root = find(&mut root, index) as usize;
            held[root] |= node.kind == NodeKind::Boundary;
            airy[root] |= gas(index);
            fed[root] += supplied_kg_s.get(index as usize).copied().unwrap_or(0.0);
        }
        let mut leaks = Vec::new();
        let mut open = Vec::new();
        for (index, (line, source)) in (0u32..).zip(network.lines.iter().zip(&sources)) {
            if *source || !to_space(line) {
                continue;
            }
            let inside = if is_space(network, line.to) { line.from } else { line.to };
            let root = find(&mut root, inside) as usize;
            let closed = !held[root] && airy[root] && fed[root] <= 0.0;
            if closed { leaks.push((index, inside)) } else { open.push(line) }
        }
        for line in open {
            join(&mut root, line);
        }
        held.fill(false);
        for (index, node) in (0u32..).zip(network.nodes) {
            held[find(&mut root, index) as usize] |= node.kind == NodeKind::Boundary;
        }
        let apart = (0..count as u32).map(|node| is_space(network, node) && find(&mut root, node) == node);
        let apart: Vec<bool> = apart.collect();
        // Index in `closed` of the island with this root.
        let mut place = vec![usize::MAX; count];
        let mut closed: Vec<Closed> = Vec::new();
        for index in 0..count as u32 {
            let root = find(&mut root, index) as usize;
            if held[root] {
                continue;
            }
            if place[root] == usize::MAX {
                place[root] = closed.len();
                let (nodes, drains, leaks, sources) = Default::default();
                closed.push(Closed { nodes, drains, leaks, sources, pinned: index });
            }
            closed[place[root]].nodes.push(index);
        }
        for (index, inside) in leaks {
            closed[place[find(&mut root, inside) as usize]].leaks.push(index);
        }
        for (index, (line, source)) in (0u32..).zip(network.lines.iter().zip(sources)) {
            let drains = network.segments_of(line).iter().any(|segment| segment.element.removal() > 0.0);
            let ends = [line.from, line.to].map(|node| find(&mut root, node) as usize);
            if drains && !held[ends[0]] {
                closed[place[ends[0]]].drains.push(index);
            }
            for end in ends {
                if source && ends[0] != ends[1] && !held[end] {
                    closed[place[end]].sources.push(index);
                }
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
        Ok(Self { closed, apart })
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
