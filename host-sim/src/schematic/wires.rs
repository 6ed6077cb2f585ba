//! Finds the ways of all wires of a sheet.

use super::geometry::At;
use super::layout::{DrawingError, NodeBox, Sheet};
use super::route::Router;
use super::strip::Strip;

/// Orders of wires that are tried with the same room.
const ORDERS: usize = 12;

impl Sheet<'_> {
    /// The way of every line; `Err` with the line that found none in any order.
    pub(super) fn wires(
        &self,
        width: i32,
        height: i32,
        nodes: &[NodeBox],
        strips: &[Strip],
    ) -> Result<Vec<Vec<At>>, DrawingError> {
        let mut empty = Router::new(width, height);
        for rect in nodes.iter().map(|node| node.rect).chain(strips.iter().map(|strip| strip.rect)) {
            empty.block(rect);
        }
        let far = |line: usize| {
            let strip = &strips[line];
            let entry = &self.graph.lines[line];
            let away = |node: usize| {
                let (a, b) = (nodes[node].rect, strip.rect);
                (a.x + a.width / 2 - b.x - b.width / 2).abs()
                    + (a.y + a.height / 2 - b.y - b.height / 2).abs()
            };
            away(entry.from) + away(entry.to)
        };
        let mut order: Vec<usize> = (0..strips.len()).collect();
        order.sort_by_key(|line| (far(*line), *line));
        let mut failed = 0;
        for _ in 0..ORDERS {
            let mut router = empty.clone();
            router.grant(self.effort.get());
            let mut found = vec![Vec::new(); strips.len()];
            let missing = order.iter().copied().find(|line| {
                let way = self.wire(&mut router, *line, nodes, &strips[*line]);
                way.map(|way| found[*line] = way).is_none()
            });
            self.effort.set(router.left());
            let Some(line) = missing else { return Ok(found) };
            if router.left() == 0 {
                return Err(DrawingError::TooCrowded { lines: strips.len() });
            }
            // Whoever found no way goes first.
            failed = line;
            order.retain(|other| *other != line);
            order.insert(0, line);
        }
        Err(DrawingError::NoWay { line: failed })
    }

    /// The way of a line from node to node.
    fn wire(&self, router: &mut Router, line: usize, nodes: &[NodeBox], strip: &Strip) -> Option<Vec<At>> {
        let entry = &self.graph.lines[line];
        let (inlet, outlet) = (*strip.path.first()?, *strip.path.last()?);
        let out = |port: At| if port.x == strip.rect.x { 2 } else { 0 };
        let mut way = router.connect(inlet, out(inlet), nodes[entry.from].rect)?;
        way.reverse();
        way.extend(&strip.path[1..strip.path.len() - 1]);
        way.extend(router.connect(outlet, out(outlet), nodes[entry.to].rect)?);
        Some(straightened(&way))
    }
}

/// A way without repeated points and without points at which it goes straight on.
fn straightened(way: &[At]) -> Vec<At> {
    let mut kept: Vec<At> = Vec::new();
    for point in way {
        if kept.last() == Some(point) {
            continue;
        }
        let straight = |a: At, b: At| (a.x == b.x && b.x == point.x) || (a.y == b.y && b.y == point.y);
        if matches!(kept[..], [.., a, b] if straight(a, b)) {
            kept.pop();
        }
        kept.push(*point);
    }
    kept
}
