//! Where nodes stand: columns and rows, such that lines are short.
//!
//! Nodes that the file places stay there. The others are moved about by a search that accepts worse places less
//! and less often (simulated annealing, Kirkpatrick et al. 1983); it draws from a fixed seed, so that the same
//! network gives the same drawing on every machine.

use super::graph::Graph;

/// Column and row.
pub(super) type Cell = (i32, i32);

/// Starts of the search.
const STARTS: u64 = 6;

/// Finds cells for all nodes, with no empty column or row, in several ways: the shortest lines first. What no file
/// has placed is also turned over and round, because strips lie between columns and never between rows.
pub(super) fn places(graph: &Graph) -> Vec<Vec<Cell>> {
    let nodes = graph.nodes.len();
    let given: Vec<_> = graph.nodes.iter().map(|node| node.position).collect();
    let fixed = given.iter().flatten();
    let least = |side: i32, most: u32| side.max(most as i32 + 1);
    let columns = (1..=nodes as i32).find(|side| side * side >= nodes as i32).unwrap_or(1);
    let columns = least(columns, fixed.clone().map(|place| place.0).max().unwrap_or(0));
    let rows = (nodes as i32 + columns - 1) / columns;
    let rows = least(rows, fixed.map(|place| place.1).max().unwrap_or(0));
    let pull = pulls(graph);
    let search = |start| Search::new(&given, (columns, rows), start).run(&pull);
    let mut found: Vec<_> = (0..STARTS).map(search).collect();
    found.sort_by_key(|(_, cost)| *cost);
    let free = given.iter().all(Option::is_none);
    let mut all: Vec<Vec<Cell>> = Vec::new();
    for turn in TURNS.iter().take(if free { TURNS.len() } else { 1 }) {
        for (cells, _) in &found {
            let turned = dense(cells.iter().map(|cell| turn(*cell)).collect());
            if !all.contains(&turned) {
                all.push(turned);
            }
        }
    }
    all
}

/// A sheet as it is, mirrored, upside down, and both with rows for columns.
const TURNS: [fn(Cell) -> Cell; 8] = [
    |(x, y)| (x, y),
    |(x, y)| (y, x),
    |(x, y)| (-x, y),
    |(x, y)| (x, -y),
    |(x, y)| (-y, x),
    |(x, y)| (y, -x),
    |(x, y)| (-x, -y),
    |(x, y)| (-y, -x),
];

/// Pairs of nodes with how strongly they pull: once and a half for two lines.
fn pulls(graph: &Graph) -> Vec<(usize, usize, i64)> {
    let mut pull: std::collections::BTreeMap<(usize, usize), i64> = std::collections::BTreeMap::new();
    for line in &graph.lines {
        if line.from != line.to {
            let weight = pull.entry((line.from.min(line.to), line.from.max(line.to))).or_insert(1);
            *weight += 1;
        }
    }
    pull.into_iter().map(|((a, b), weight)| (a, b, weight)).collect()
}

/// Closes up empty columns and rows.
fn dense(mut cells: Vec<Cell>) -> Vec<Cell> {
    let ranks = |values: Vec<i32>| {
        let mut sorted = values;
        sorted.sort_unstable();
        sorted.dedup();
        sorted
    };
    let columns = ranks(cells.iter().map(|cell| cell.0).collect());
    let rows = ranks(cells.iter().map(|cell| cell.1).collect());
    let rank = |list: &[i32], value: i32| list.binary_search(&value).unwrap_or(0) as i32;
    for cell in &mut cells {
        *cell = (rank(&columns, cell.0), rank(&rows, cell.1));
    }
    cells
}

struct Search {
    columns: i32,
    rows: i32,
    /// Node in each cell.
    grid: Vec<Option<usize>>,
    cells: Vec<Cell>,
    movable: Vec<usize>,
    dice: u64,
}

impl Search {
    fn new(given: &[Option<(u32, u32)>], (columns, rows): (i32, i32), start: u64) -> Self {
        let area = (columns * rows) as usize;
        let mut search = Self {
            columns,
            rows,
            grid: vec![None; area.max(given.len())],
            cells: vec![(0, 0); given.len()],
            movable: Vec::new(),
            dice: start,
        };
        for (node, place) in given.iter().enumerate() {
            if let Some((column, row)) = place {
                search.put(node, (*column as i32, *row as i32));
            }
        }
        for (node, place) in given.iter().enumerate() {
            if place.is_none() {
                let free = search.grid.iter().position(Option::is_none);
                // Fixed nodes may have taken cells that the count had meant for others.
                let free = free.unwrap_or_else(|| {
                    search.grid.resize(search.grid.len() + columns as usize, None);
                    search.rows += 1;
                    search.grid.len() - columns as usize
                });
                search.put(node, search.cell(free));
                search.movable.push(node);
            }
        }
        search
    }

    fn cell(&self, index: usize) -> Cell {
        (index as i32 % self.columns, index as i32 / self.columns)
    }

    fn index(&self, cell: Cell) -> usize {
        (cell.1 * self.columns + cell.0) as usize
    }

    fn put(&mut self, node: usize, cell: Cell) {
        let index = self.index(cell);
        self.grid[index] = Some(node);
        self.cells[node] = cell;
    }

    /// A number below `most` (`SplitMix64`, Steele et al. 2014).
    fn draw(&mut self, most: usize) -> usize {
        self.dice = self.dice.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.dice ^ (self.dice >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % most.max(1) as u64) as usize
    }

    /// What a line costs: its length, more where it bends, and more where it passes another node's cell.
    fn stretch(&self, a: Cell, b: Cell) -> i64 {
        let (across, down) = (i64::from((a.0 - b.0).abs()), i64::from((a.1 - b.1).abs()));
        let mut cost = 4 * (across * across + down * down) + 2 * i64::from(across > 0 && down > 0);
        if across == 0 || down == 0 {
            let steps = across + down;
            let sign = |from: i32, to: i32| (to - from).signum();
            let passed = (1..steps as i32)
                .map(|step| (a.0 + step * sign(a.0, b.0), a.1 + step * sign(a.1, b.1)))
                .filter(|cell| self.grid.get(self.index(*cell)).is_some_and(Option::is_some));
            cost += 6 * passed.count() as i64;
        }
        cost
    }

    fn cost(&self, pull: &[(usize, usize, i64)]) -> i64 {
        pull.iter().map(|(a, b, weight)| weight * self.stretch(self.cells[*a], self.cells[*b])).sum()
    }

    fn swap(&mut self, node: usize, other: usize) {
        let (from, to) = (self.cells[node], self.cell(other));
        let there = self.grid[other];
        let here = self.index(from);
        self.grid[here] = there;
        if let Some(there) = there {
            self.cells[there] = from;
        }
        self.grid[other] = Some(node);
        self.cells[node] = to;
    }

    fn run(mut self, pull: &[(usize, usize, i64)]) -> (Vec<Cell>, i64) {
        let area = (self.columns * self.rows) as usize;
        let mut cost = self.cost(pull);
        let mut best = (self.cells.clone(), cost);
        let tries =
            if self.movable.is_empty() { 0 } else { (400_000 / pull.len().max(1)).clamp(2_000, 20_000) };
        for attempt in 0..tries {
            let heat = 40.0 * (1.0 - attempt as f64 / tries as f64).powi(2);
            let pick = self.draw(self.movable.len());
            let node = self.movable[pick];
            let other = self.draw(area);
            let home = self.index(self.cells[node]);
            let fixed = self.grid[other].is_some_and(|there| !self.movable.contains(&there));
            if other == home || fixed {
                continue;
            }
            self.swap(node, other);
            let now = self.cost(pull);
            // A quotient instead of the usual exponential, whose last digit differs from machine to machine.
            let chance = self.draw(1_000_000) as f64 * 1e-6;
            let keep = heat / (heat + (now - cost).max(0) as f64 * 4.0 + 1e-9);
            if now <= cost || keep * keep * keep > chance {
                cost = now;
                if cost < best.1 {
                    best = (self.cells.clone(), cost);
                }
            } else {
                self.swap(node, home);
            }
        }
        best
    }
}
