//! Connection tables of a network: the order of sums and of elimination.
//!
//! The implicit methods eliminate the nodes of unknown pressure one after the other. First go the branches of trees,
//! nodes that have one line to one neighbour left, then the node with the fewest neighbours (minimum degree), which
//! keeps a chain tridiagonal and leaves the hub of a star for the end. Among equals the one comes first that has
//! waited longest: a chain is eliminated from both ends at once, two sequences that a processor runs side by side.
//! The pattern with its fill is written down here once; a step of the method then never searches.

use std::collections::{BTreeSet, VecDeque};

use eclss_core::{Climate, Element, Line, Network, Node, NodeKind, Plan, Segment, Series};

/// Owned connection tables; what [`Plan`] borrows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PlanTables {
    /// For every node the first of its entries in `ends`, and one past the last.
    pub end_start: Vec<u32>,
    /// The ends of lines at every node: twice the line's index, plus one for its outlet.
    pub ends: Vec<u32>,
    /// Nodes of unknown pressure in the order of elimination.
    pub order: Vec<u32>,
    /// For every row the first of its entries in `columns`, and one past the last.
    pub row_start: Vec<u32>,
    /// Columns of the entries with fill, ascending within a row.
    pub columns: Vec<u32>,
    /// Entry of the diagonal in every row.
    pub diagonal: Vec<u32>,
    /// Entries that a line adds to: (from, from), (from, to), (to, from), (to, to).
    pub stamps: Vec<[u32; 4]>,
    /// Position in `order` of every node.
    pub row_of: Vec<u32>,
    /// Port and node of the only later neighbour of the first rows.
    pub leaves: Vec<[u32; 2]>,
    /// Port, earlier neighbour and later neighbour's entry of every end in `ends`.
    pub terms: Vec<[u32; 3]>,
    /// Rows with two later neighbours at most.
    pub series: Vec<Series>,
    /// Lines with a port at either end.
    pub composite: Vec<u32>,
    /// Points around every segment.
    pub between: Vec<[u32; 2]>,
}

impl PlanTables {
    /// Makes the tables for lines of segments between nodes; every line's nodes and segments must exist.
    pub fn new<E: Element>(nodes: &[Node], lines: &[Line], segments: &[Segment<E>]) -> Self {
        let (end_start, ends) = ends(nodes.len(), lines);
        let (order, rows, branches) = eliminate(nodes, lines);
        let mut row_of = vec![Plan::NOWHERE; nodes.len()];
        for (row, &node) in order.iter().enumerate() {
            row_of[node as usize] = row as u32;
        }
        let mut tables = Self { end_start, ends, order, row_of, ..Self::default() };
        tables.row_start.push(0);
        for (row, nodes) in rows.iter().enumerate() {
            let mut columns: Vec<u32> = nodes.iter().map(|&node| tables.row_of[node as usize]).collect();
            columns.sort_unstable();
            let before = columns.partition_point(|&column| (column as usize) < row);
            tables.diagonal.push((tables.columns.len() + before) as u32);
            tables.columns.extend(columns);
            tables.row_start.push(tables.columns.len() as u32);
        }
        tables.stamps = lines.iter().map(|line| tables.stamp(line)).collect();
        tables.add_terms(nodes, lines, segments, branches);
        tables
    }

    /// Adds ports, points and terms.
    fn add_terms<E: Element>(
        &mut self,
        nodes: &[Node],
        lines: &[Line],
        segments: &[Segment<E>],
        branches: usize,
    ) {
        let network = Network {
            reference_pa: 0.0,
            nodes,
            lines,
            segments,
            active: &[],
            responsive: &[],
            inputs: &[],
            schedules: &[],
            points: &[],
            plan: Plan::EMPTY,
            climate: Climate::NONE,
        };
        let composite = (0u32..).zip(lines).filter(|(_, line)| Plan::is_composite(&network, line));
        self.composite = composite.map(|(index, _)| index).collect();
        self.between = vec![[Plan::NOWHERE; 2]; segments.len()];
        for line in lines {
            Plan::points_of(&network, line, |segment, points| self.between[segment as usize] = points);
        }
        // The terms ask how many rows are branches, and the branches where their terms lead.
        self.leaves = vec![[Plan::NOWHERE; 2]; branches];
        for node in 0..nodes.len() {
            let own = self.end_start[node] as usize..self.end_start[node + 1] as usize;
            for &end in &self.ends[own] {
                let term = self.plan().term(nodes, segments.len(), lines, node as u32, end);
                self.terms.push(term);
                let row = self.row_of[node] as usize;
                if row < branches && term[2] != Plan::NOWHERE {
                    let column = self.columns[term[2] as usize];
                    self.leaves[row] = [term[0] / 2, self.order[column as usize]];
                }
            }
        }
        let series = (branches..self.order.len()).map_while(|row| self.plan().series_of(row));
        self.series = series.collect();
    }

    /// Lends the tables.
    pub fn plan(&self) -> Plan<'_> {
        Plan {
            end_start: &self.end_start,
            ends: &self.ends,
            order: &self.order,
            row_start: &self.row_start,
            columns: &self.columns,
            diagonal: &self.diagonal,
            stamps: &self.stamps,
            row_of: &self.row_of,
            leaves: &self.leaves,
            terms: &self.terms,
            series: &self.series,
            composite: &self.composite,
            between: &self.between,
        }
    }

    fn stamp(&self, line: &Line) -> [u32; 4] {
        let (from, to) = (self.row_of[line.from as usize], self.row_of[line.to as usize]);
        let across = |row, column| if from == to { Plan::NOWHERE } else { self.entry(row, column) };
        [self.entry(from, from), across(from, to), across(to, from), self.entry(to, to)]
    }

    /// Where the entry of a row and column stands.
    fn entry(&self, row: u32, column: u32) -> u32 {
        if row == Plan::NOWHERE || column == Plan::NOWHERE {
            return Plan::NOWHERE;
        }
        let first = self.row_start[row as usize];
        let columns = &self.columns[first as usize..self.row_start[row as usize + 1] as usize];
        columns.binary_search(&column).map_or(Plan::NOWHERE, |place| first + place as u32)
    }
}

/// Lists the line ends at every node in ascending order.
fn ends(nodes: usize, lines: &[Line]) -> (Vec<u32>, Vec<u32>) {
    let mut of_node = vec![Vec::new(); nodes];
    for (index, line) in (0u32..).zip(lines) {
        of_node[line.from as usize].push(2 * index);
        of_node[line.to as usize].push(2 * index + 1);
    }
    let mut start = vec![0];
    let mut ends = Vec::with_capacity(2 * lines.len());
    for list in of_node {
        ends.extend(list);
        start.push(ends.len() as u32);
    }
    (start, ends)
}

/// Neighbours that are left during an elimination, in ascending order, and those that went before.
struct Rows {
    left: Vec<Vec<u32>>,
    /// Neighbours of every node that were eliminated before it.
    earlier: Vec<Vec<u32>>,
    order: Vec<u32>,
    /// Of every eliminated node the neighbours that it left.
    later: Vec<Vec<u32>>,
}

impl Rows {
    /// Eliminates a node and calls `changed` with every neighbour that was left, before and after it changes.
    fn eliminate(&mut self, node: u32, mut changed: impl FnMut(u32, usize, usize)) {
        self.order.push(node);
        let neighbours = std::mem::take(&mut self.left[node as usize]);
        for &neighbour in &neighbours {
            let row = &mut self.left[neighbour as usize];
            let before = row.len();
            *row = merged(row, &neighbours, [node, neighbour]);
            self.earlier[neighbour as usize].push(node);
            changed(neighbour, before, row.len());
        }
        self.later[node as usize] = neighbours;
    }

    /// All nodes in the row of `node`, with fill.
    fn pattern(&mut self, node: u32) -> Vec<u32> {
        let mut row = std::mem::take(&mut self.earlier[node as usize]);
        row.push(node);
        row.append(&mut self.later[node as usize]);
        row
    }
}

/// Two ascending lists as one, without these two nodes.
fn merged(one: &[u32], other: &[u32], without: [u32; 2]) -> Vec<u32> {
    let mut list = Vec::with_capacity(one.len() + other.len());
    let (mut one, mut other) = (one.iter().copied().peekable(), other.iter().copied().peekable());
    while let Some(next) = match (one.peek(), other.peek()) {
        (Some(a), Some(b)) if a == b => {
            other.next();
            one.next()
        }
        (Some(a), Some(b)) if a > b => other.next(),
        (Some(_), _) => one.next(),
        (None, _) => other.next(),
    } {
        if !without.contains(&next) {
            list.push(next);
        }
    }
    list
}

/// Returns the order of elimination, for every row in that order the nodes in its pattern with fill, and how many
/// rows are branches.
fn eliminate(nodes: &[Node], lines: &[Line]) -> (Vec<u32>, Vec<Vec<u32>>, usize) {
    let unknown = |node: u32| nodes[node as usize].kind != NodeKind::Boundary;
    let count = nodes.len() as u32;
    let mut left: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); nodes.len()];
    // Several lines between the same two nodes are one neighbour, but no branch.
    let mut doubled = BTreeSet::new();
    for line in lines.iter().filter(|line| line.from != line.to && unknown(line.from) && unknown(line.to)) {
        if !left[line.from as usize].insert(line.to) {
            doubled.insert((line.from.min(line.to), line.from.max(line.to)));
        }
        left[line.to as usize].insert(line.from);
    }
    let left: Vec<Vec<u32>> = left.into_iter().map(|row| row.into_iter().collect()).collect();
    let empty = vec![Vec::new(); nodes.len()];
    let mut rows = Rows { left, earlier: empty.clone(), order: Vec::new(), later: empty };
    let is_branch = |left: &[Vec<u32>], node: u32| match left[node as usize][..] {
        [] => true,
        [other] => !doubled.contains(&(node.min(other), node.max(other))),
        _ => false,
    };
    let mut waiting: VecDeque<u32> =
        (0..count).filter(|&node| unknown(node) && is_branch(&rows.left, node)).collect();
    let mut queued: Vec<bool> = (0..count).map(|node| !unknown(node)).collect();
    for &node in &waiting {
        queued[node as usize] = true;
    }
    while let Some(node) = waiting.pop_front() {
        let mut last = None;
        rows.eliminate(node, |neighbour, _, _| last = Some(neighbour));
        if let Some(node) = last.filter(|&node| !queued[node as usize] && is_branch(&rows.left, node)) {
            queued[node as usize] = true;
            waiting.push_back(node);
        }
    }
    let branches = rows.order.len();
    let mut ticket = count;
    let mut tickets: Vec<u32> = (0..count).collect();
    let mut queue: BTreeSet<(usize, u32, u32)> = (0..count)
        .filter(|&node| !queued[node as usize])
        .map(|node| (rows.left[node as usize].len(), node, node))
        .collect();
    while let Some((_, _, node)) = queue.pop_first() {
        rows.eliminate(node, |neighbour, before, after| {
            if before != after {
                queue.remove(&(before, tickets[neighbour as usize], neighbour));
                tickets[neighbour as usize] = ticket;
                queue.insert((after, ticket, neighbour));
                ticket += 1;
            }
        });
    }
    let order = std::mem::take(&mut rows.order);
    let patterns = order.iter().map(|&node| rows.pattern(node)).collect();
    (order, patterns, branches)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::Method;
    use eclss_core::components::Pipe;

    fn nodes(count: usize) -> Vec<Node> {
        let kind = NodeKind::Cabin { volume_m3: 60.0 };
        vec![Node { kind, start_gauge_pa: 0.0, temperature_k: 295.15 }; count]
    }

    fn line((from, to): (u32, u32)) -> Line {
        Line {
            from,
            to,
            first_segment: 0,
            segments: 1,
            flow_segment: 0,
            laminar_below_pa: 1e-3,
            start_flow_kg_s: 0.0,
        }
    }

    /// Tables of lines of one pipe each, which the core must accept.
    fn made(nodes: &[Node], lines: &[Line]) -> PlanTables {
        let pipe = Pipe::new(1e3).into_any();
        let segment =
            Segment { element: pipe, inertance_per_m: 100.0, outlet_volume_m3: 0.0, first_input: 0 };
        let segments = vec![segment; lines.len()];
        let lines: Vec<Line> =
            (0u32..).zip(lines).map(|(index, line)| Line { first_segment: index, ..*line }).collect();
        let tables = PlanTables::new(nodes, &lines, &segments);
        let network = Network {
            nodes,
            lines: &lines,
            segments: &segments,
            active: &[],
            inputs: &[],
            plan: tables.plan(),
            ..eclss_core::example::paper_loop()
        };
        assert_eq!(Method::TrBdf2.check(&network, 1_000), Ok(()));
        tables
    }

    fn tables(count: usize, pairs: &[(u32, u32)]) -> PlanTables {
        made(&nodes(count), &pairs.iter().copied().map(line).collect::<Vec<_>>())
    }

    /// What elimination needs: no pair of later neighbours of a node lacks an entry.
    fn closed_under_fill(tables: &PlanTables) -> bool {
        let rows = tables.order.len() as u32;
        let has = |row, column| tables.entry(row, column) != Plan::NOWHERE;
        (0..rows).all(|by| {
            let later: Vec<u32> = (by + 1..rows).filter(|&row| has(row, by)).collect();
            later.iter().all(|&row| later.iter().all(|&column| has(row, column)))
        })
    }

    #[test]
    fn a_chain_stays_tridiagonal_whatever_the_order_of_its_nodes() {
        let shuffled: Vec<u32> = (0..50).map(|index| index * 17 % 50).collect();
        let pairs: Vec<_> = shuffled.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let tables = tables(50, &pairs);
        assert_eq!(tables.columns.len(), 3 * 50 - 2);
        assert!(closed_under_fill(&tables));
    }

    #[test]
    fn the_hub_of_a_star_waits_for_the_end() {
        let pairs: Vec<_> = (1..20).map(|leaf| (0, leaf)).collect();
        let tables = tables(20, &pairs);
        assert_eq!(tables.columns.len(), 20 + 2 * 19);
        assert!(tables.order[18..].contains(&0));
    }

    #[test]
    fn a_mesh_has_all_its_fill() {
        let side = 7;
        let mut pairs = Vec::new();
        for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
            let node = row * side + column;
            pairs.extend((column + 1 < side).then_some((node, node + 1)));
            pairs.extend((row + 1 < side).then_some((node, node + side)));
        }
        let tables = tables(49, &pairs);
        assert!(closed_under_fill(&tables));
        assert!(pairs.iter().zip(&tables.stamps).all(|(_, stamps)| !stamps.contains(&Plan::NOWHERE)));
    }

    #[test]
    fn boundaries_and_loops_have_no_entries_of_their_own() {
        let mut nodes = nodes(3);
        nodes[1].kind = NodeKind::Boundary;
        let lines = [line((0, 1)), line((2, 2)), line((0, 2))];
        let tables = made(&nodes, &lines);
        let no = Plan::NOWHERE;
        assert_eq!(tables.row_of, [0, no, 1]);
        assert_eq!(tables.stamps, [[0, no, no, no], [3, no, no, 3], [0, 1, 2, 3]]);
        assert_eq!(tables.end_start, [0, 2, 3, 6]);
        assert_eq!(tables.ends, [0, 4, 1, 2, 3, 5]);
        assert_eq!(tables.leaves, [[2, 2], [no, no]]);
        assert_eq!(
            tables.terms,
            [[0, 1, no], [4, 3, 1], [1, 0, no], [2, 3, no], [3, 3, no], [5, 0, no]],
            "the held node is always eliminated, the later one is not yet, and a loop meets itself"
        );
    }

    /// Half of such a graph is one dense block in the end; planning it takes about as long as writing that down.
    #[test]
    fn a_random_graph_of_four_thousand_nodes_is_planned() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 33) % 4_000) as u32
        };
        let pairs: Vec<(u32, u32)> = (0..8_000).map(|line| (line % 4_000, random())).collect();
        let tables = tables(4_000, &pairs);
        assert_eq!(tables.order.len(), 4_000);
        assert!(tables.columns.len() > 500_000, "{}", tables.columns.len());
    }
}
