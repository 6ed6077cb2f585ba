//! Ways for wires: horizontal and vertical, never on top of each other, crossing only straight.
//!
//! A* (Hart, Nilsson, Raphael 1968) over the points of the grid with the direction of the last step.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::geometry::{At, GRID, Rect};

/// Right, down, left, up.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// What a bend, a crossing and a port beside another one cost, in steps.
const BEND: u32 = 6;
const CROSSING: u32 = 9;
const CROWDED: u32 = 8;
/// What a step beside another wire costs on top.
const BESIDE: u32 = 1;

/// What stands at a point of the grid.
#[derive(Debug, Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "four marks of a point, in any combination")]
struct Point {
    /// Inside or on the edge of something.
    blocked: bool,
    /// A wire runs straight through, horizontally or vertically.
    across: bool,
    down: bool,
    /// A wire bends or ends here.
    corner: bool,
}

/// The grid of a drawing with the wires so far.
#[derive(Debug, Clone)]
pub(super) struct Router {
    width: i32,
    height: i32,
    points: Vec<Point>,
    /// Points that searches may still look at.
    left: u64,
}

impl Router {
    /// A grid over a drawing of this size [px].
    pub(super) fn new(width: i32, height: i32) -> Self {
        let (width, height) = (width / GRID + 1, height / GRID + 1);
        Self { width, height, points: vec![Point::default(); (width * height) as usize], left: u64::MAX }
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then_some((y * self.width + x) as usize)
    }

    /// Keeps wires off the box, its edge included.
    pub(super) fn block(&mut self, rect: Rect) {
        for y in rect.y.div_euclid(GRID)..=rect.bottom().div_euclid(GRID) {
            for x in rect.x.div_euclid(GRID)..=rect.right().div_euclid(GRID) {
                if let Some(index) = self.index(x, y) {
                    self.points[index].blocked = true;
                }
            }
        }
    }

    fn free(&self, x: i32, y: i32) -> bool {
        self.index(x, y).is_some_and(|index| {
            let point = self.points[index];
            !point.blocked && !point.corner && !point.across && !point.down
        })
    }

    /// Finds a way from `port`, which lies on the edge of a box and is left in the direction `out` (an index into
    /// [`STEPS`]), to any free point on the edge of `target`. Keeps it free of later wires.
    pub(super) fn connect(&mut self, port: At, out: usize, target: Rect) -> Option<Vec<At>> {
        let path = self.search((port.x / GRID, port.y / GRID), out, target)?;
        self.keep(&path);
        Some(corners(&path).into_iter().map(|(x, y)| At { x: x * GRID, y: y * GRID }).collect())
    }

    /// Lets the searches look at so many points.
    pub(super) fn grant(&mut self, points: u64) {
        self.left = points;
    }

    /// Points that searches may still look at; 0 where one had to give up.
    pub(super) fn left(&self) -> u64 {
        self.left
    }

    fn search(&mut self, start: (i32, i32), out: usize, target: Rect) -> Option<Vec<(i32, i32)>> {
        let (left, top) = (target.x / GRID, target.y / GRID);
        let (right, bottom) = (target.right() / GRID, target.bottom() / GRID);
        let guess = |x: i32, y: i32| {
            ((left - x).max(x - right).max(0) + (top - y).max(y - bottom).max(0)).unsigned_abs()
        };
        let states = self.points.len() * 4;
        let mut cost = vec![u32::MAX; states];
        let mut came = vec![u32::MAX; states];
        let mut queue = BinaryHeap::new();
        let first = self.index(start.0, start.1)? * 4 + out;
        cost[first] = 0;
        queue.push(Reverse((guess(start.0, start.1), first)));
        while let Some(Reverse((_, state))) = queue.pop() {
            self.left = self.left.checked_sub(1)?;
            let (place, direction) = (state / 4, state % 4);
            let (x, y) = (place as i32 % self.width, place as i32 / self.width);
            let on_edge = ((x == left || x == right) && top < y && y < bottom)
                || ((y == top || y == bottom) && left < x && x < right);
            if state != first && on_edge {
                return Some(self.trace(&came, state));
            }
            for (next, (dx, dy)) in STEPS.into_iter().enumerate() {
                let turns = next != direction;
                if (direction + 2) % 4 == next || (turns && state == first) {
                    continue;
                }
                let here = self.points[place];
                // A bend needs the point for itself; the port's own point is on a blocked edge.
                if turns && (here.across || here.down || here.corner) {
                    continue;
                }
                let Some(price) = self.step(x + dx, y + dy, next, (left, top, right, bottom)) else {
                    continue;
                };
                let Some(place) = self.index(x + dx, y + dy) else { continue };
                let total = cost[state] + price + if turns { BEND } else { 0 };
                let then = place * 4 + next;
                if total < cost[then] {
                    cost[then] = total;
                    came[then] = state as u32;
                    queue.push(Reverse((total + guess(x + dx, y + dy), then)));
                }
            }
        }
        None
    }

    /// What entering a point in a direction costs; `None` where it is taken.
    fn step(&self, x: i32, y: i32, direction: usize, target: (i32, i32, i32, i32)) -> Option<u32> {
        let point = self.points[self.index(x, y)?];
        let (left, top, right, bottom) = target;
        let (dx, dy) = STEPS[direction];
        let side = (x == left && dx == 1 || x == right && dx == -1) && top < y && y < bottom;
        let end = (y == top && dy == 1 || y == bottom && dy == -1) && left < x && x < right;
        if side || end {
            if point.corner {
                return None;
            }
            let beside = if side { [(0, 1), (0, -1)] } else { [(1, 0), (-1, 0)] };
            let taken = |(dx, dy): (i32, i32)| {
                self.index(x + dx, y + dy).is_some_and(|index| self.points[index].corner)
            };
            let crowded = beside.into_iter().any(taken);
            return Some(1 + if crowded { CROWDED } else { 0 });
        }
        let along = if dx == 0 { point.down } else { point.across };
        if point.blocked || point.corner || along {
            return None;
        }
        let crossed = if dx == 0 { point.across } else { point.down };
        let beside = !self.free(x + dy, y + dx) || !self.free(x - dy, y - dx);
        Some(1 + if crossed { CROSSING } else { 0 } + if beside { BESIDE } else { 0 })
    }

    fn trace(&self, came: &[u32], last: usize) -> Vec<(i32, i32)> {
        let mut path = Vec::new();
        let mut state = last;
        loop {
            let place = (state / 4) as i32;
            path.push((place % self.width, place / self.width));
            if came[state] == u32::MAX {
                break;
            }
            state = came[state] as usize;
        }
        path.reverse();
        path
    }

    fn keep(&mut self, path: &[(i32, i32)]) {
        for (index, (x, y)) in path.iter().enumerate() {
            let Some(place) = self.index(*x, *y) else { continue };
            let before = index.checked_sub(1).and_then(|before| path.get(before));
            let point = &mut self.points[place];
            match (before, path.get(index + 1)) {
                (Some(before), Some(after)) if before.1 == after.1 => point.across = true,
                (Some(before), Some(after)) if before.0 == after.0 => point.down = true,
                _ => point.corner = true,
            }
        }
    }
}

/// A path without the points at which it goes straight on.
fn corners(path: &[(i32, i32)]) -> Vec<(i32, i32)> {
    let straight = |a: (i32, i32), b: (i32, i32), c: (i32, i32)| {
        (a.0 == b.0 && b.0 == c.0) || (a.1 == b.1 && b.1 == c.1)
    };
    let mut kept: Vec<(i32, i32)> = Vec::new();
    for (index, point) in path.iter().enumerate() {
        let goes_on = match (index.checked_sub(1).and_then(|i| path.get(i)), path.get(index + 1)) {
            (Some(before), Some(after)) => straight(*before, *point, *after),
            _ => false,
        };
        if !goes_on {
            kept.push(*point);
        }
    }
    kept
}
