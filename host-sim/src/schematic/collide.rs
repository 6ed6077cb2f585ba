//! What overlaps in a drawing, by geometry: nothing should.

use super::geometry::{At, Rect};
use super::graph::Graph;
use super::layout::Drawing;

impl Drawing {
    /// Boxes, symbols and texts with names.
    fn things(&self, graph: &Graph) -> Vec<(String, Rect)> {
        let mut things = Vec::new();
        for (node, drawn) in graph.nodes.iter().zip(&self.nodes) {
            things.push((format!("node {}", node.id), drawn.rect));
        }
        for (line, strip) in graph.lines.iter().zip(&self.strips) {
            things.push((format!("title of {}", line.id), strip.title.rect()));
            things.push((format!("flow of {}", line.id), strip.flow.rect()));
            for glyph in &strip.glyphs {
                let id = line.elements.get(glyph.element).map_or("?", |element| element.id.as_str());
                things.push((format!("symbol {id}"), glyph.rect));
                things.push((format!("name of {id}"), glyph.label.rect()));
                let values = glyph.values.iter().enumerate();
                things
                    .extend(values.map(|(number, label)| (format!("value {number} of {id}"), label.rect())));
            }
        }
        things
    }

    /// Everything that overlaps, is cut or hangs over the edge; empty for a good drawing.
    pub fn collisions(&self, graph: &Graph) -> Vec<String> {
        let mut found = Vec::new();
        let things = self.things(graph);
        let sheet = Rect { x: 0, y: 0, width: self.width, height: self.height };
        for (index, (name, rect)) in things.iter().enumerate() {
            if !sheet.holds(rect) {
                found.push(format!("{name} hangs over the edge"));
            }
            for (other, with) in &things[index + 1..] {
                if rect.overlaps(with) {
                    found.push(format!("{name} overlaps {other}"));
                }
            }
        }
        for (node, drawn) in graph.nodes.iter().zip(&self.nodes) {
            let texts = [&drawn.title, &drawn.first, &drawn.second];
            let used = if node.kind == "junction" { 1 } else { 3 };
            for (number, text) in texts.into_iter().take(used).enumerate() {
                if !drawn.rect.holds(&text.rect()) {
                    found.push(format!("text {number} of node {} hangs out of it", node.id));
                }
                let below = texts.get(number + 1).filter(|_| number + 1 < used);
                if below.is_some_and(|below| below.rect().overlaps(&text.rect())) {
                    found.push(format!("text {number} of node {} lies on the next", node.id));
                }
            }
        }
        self.cut(graph, &things, &mut found);
        self.shared(graph, &mut found);
        found
    }

    /// Wires that cut something which is not a symbol of their own.
    fn cut(&self, graph: &Graph, things: &[(String, Rect)], found: &mut Vec<String>) {
        for (line, wire) in graph.lines.iter().zip(&self.wires) {
            let own: Vec<_> = line.elements.iter().map(|element| format!("symbol {}", element.id)).collect();
            for pair in wire.windows(2) {
                if pair[0].x != pair[1].x && pair[0].y != pair[1].y {
                    found.push(format!("wire {} runs aslant", line.id));
                }
                for (name, rect) in things {
                    if rect.is_cut_by(pair[0], pair[1]) && !own.contains(name) {
                        found.push(format!("wire {} cuts {name}", line.id));
                    }
                }
            }
            let ends = [(wire.first(), line.from), (wire.last(), line.to)];
            for (end, node) in ends {
                let on_edge = |end: &At| {
                    let rect = self.nodes[node].rect;
                    let (x, y) =
                        (end.x == rect.x || end.x == rect.right(), end.y == rect.y || end.y == rect.bottom());
                    rect.holds(&Rect { x: end.x, y: end.y, width: 0, height: 0 }) && (x != y)
                };
                if !end.is_some_and(on_edge) {
                    found.push(format!("wire {} does not end at node {}", line.id, graph.nodes[node].id));
                }
            }
        }
    }

    /// Wires that run on top of each other, or touch where one of them bends or ends.
    fn shared(&self, graph: &Graph, found: &mut Vec<String>) {
        for (first, wire) in self.wires.iter().enumerate() {
            for (second, other) in self.wires.iter().enumerate() {
                let names = || format!("{} and {}", graph.lines[first].id, graph.lines[second].id);
                for a in wire.windows(2) {
                    for (place, b) in other.windows(2).enumerate() {
                        if first < second && along((a[0], a[1]), (b[0], b[1])) {
                            found.push(format!("wires {} run on top of each other", names()));
                        }
                        let bend = if place == 0 { vec![b[0], b[1]] } else { vec![b[1]] };
                        if first != second && bend.iter().any(|point| on(*point, a[0], a[1])) {
                            found.push(format!("wires {} touch at a bend", names()));
                        }
                    }
                }
            }
        }
    }
}

/// Whether two stretches share more than a point.
fn along((a, b): (At, At), (c, d): (At, At)) -> bool {
    let shared = |a: i32, b: i32, c: i32, d: i32| a.max(b).min(c.max(d)) - a.min(b).max(c.min(d));
    let (x, y) = (shared(a.x, b.x, c.x, d.x), shared(a.y, b.y, c.y, d.y));
    let (flat, level) = (a.y == b.y && c.y == d.y, a.x == b.x && c.x == d.x);
    (flat && a.y == c.y && x > 0) || (level && a.x == c.x && y > 0)
}

/// Whether a point lies on a stretch.
fn on(point: At, a: At, b: At) -> bool {
    (a.x.min(b.x)..=a.x.max(b.x)).contains(&point.x) && (a.y.min(b.y)..=a.y.max(b.y)).contains(&point.y)
}
