//! A drawing as SVG.

use std::fmt::Write as _;

use super::geometry::{Hang, Label, text_width};
use super::graph::Graph;
use super::layout::Drawing;
use super::strip::{Glyph, Style};
use super::symbol::{NAMELESS, symbol};

/// Colours and strokes of a drawing, light and dark: what a file carries inside and the page links to.
pub const STYLE: &str = include_str!("../../page/schematic.css");

/// Where a drawing goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dress {
    /// A file of its own: with style and background.
    File,
    /// Part of a page that has the style.
    Page,
}

impl Drawing {
    /// Writes the drawing.
    pub fn svg(&self, graph: &Graph, dress: Dress) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut out, graph, dress);
        out
    }

    fn write(&self, out: &mut String, graph: &Graph, dress: Dress) -> std::fmt::Result {
        let (width, height) = (self.width, self.height);
        let title = escaped(&graph.title);
        write!(
            out,
            r#"<svg xmlns="http://www.w3.org/2000/svg" class="schematic" viewBox="0 0 {width} {height}""#
        )?;
        if dress == Dress::File {
            write!(out, r#" width="{width}" height="{height}""#)?;
        }
        writeln!(out, r#" role="group" aria-label="Schematic: {title}">"#)?;
        if dress == Dress::File {
            writeln!(out, "<title>{title}</title>\n<style>{STYLE}</style>")?;
            writeln!(out, r#"<rect class="sheet" width="{width}" height="{height}"/>"#)?;
        }
        writeln!(out, r#"<g class="wires">"#)?;
        for (line, wire) in self.wires.iter().enumerate() {
            let mut way = String::new();
            for (index, point) in wire.iter().enumerate() {
                write!(way, "{}{} {}", if index == 0 { 'M' } else { 'L' }, point.x, point.y)?;
            }
            writeln!(
                out,
                r#"<path class="halo" d="{way}"/><path class="wire"{} d="{way}"/>"#,
                name(dress, &format!("l{line}"))
            )?;
        }
        writeln!(out, r#"</g><g class="arrows">"#)?;
        for (line, wire) in self.wires.iter().enumerate() {
            // Without a flow the arrow says which direction counts as positive.
            let mark = wire.last().zip(wire.len().checked_sub(2).and_then(|index| wire.get(index)));
            if let (Dress::File, Some((end, before))) = (dress, mark) {
                let (x, y) = ((end.x - before.x).signum(), (end.y - before.y).signum());
                let (a, b) = (end.x - 9 * x, end.y - 9 * y);
                let (c, d) = (4 * y, 4 * x);
                writeln!(
                    out,
                    r#"<path d="M{} {}L{} {}L{} {}Z"/>"#,
                    end.x,
                    end.y,
                    a + c,
                    b + d,
                    a - c,
                    b - d
                )?;
            } else {
                writeln!(out, r#"<path id="l{line}a"/>"#)?;
            }
        }
        writeln!(out, r#"</g><g class="nodes">"#)?;
        self.write_nodes(out, graph, dress)?;
        writeln!(out, r#"</g><g class="elements">"#)?;
        let mut number = 0;
        for (line, strip) in graph.lines.iter().zip(&self.strips) {
            for glyph in &strip.glyphs {
                write_glyph(out, &line.elements[glyph.element], glyph, number, self.style, dress)?;
                number += 1;
            }
        }
        writeln!(out, r#"</g><g class="lines">"#)?;
        for (index, (line, strip)) in graph.lines.iter().zip(&self.strips).enumerate() {
            let (from, to) = (&graph.nodes[line.from].id, &graph.nodes[line.to].id);
            let about = format!("<title>{}: {} to {}</title>", line.id, from, to);
            text(out, &strip.title, "id", None, &about)?;
            text(out, &strip.flow, "value", live(dress, &format!("l{index}f")).as_deref(), "")?;
        }
        writeln!(out, "</g></svg>")
    }

    fn write_nodes(&self, out: &mut String, graph: &Graph, dress: Dress) -> std::fmt::Result {
        for (index, (node, drawn)) in graph.nodes.iter().zip(&self.nodes).enumerate() {
            let (rect, kind) = (drawn.rect, node.kind);
            let round = match kind {
                "cabin" => 8,
                "accumulator" => rect.height / 2,
                _ => 2,
            };
            let focus = if dress == Dress::Page { r#" tabindex="0" role="button""# } else { "" };
            writeln!(
                out,
                r#"<g class="node {kind}"{}{focus} aria-label="{kind} {}">"#,
                name(dress, &format!("n{index}")),
                node.id
            )?;
            writeln!(
                out,
                r#"<title>{kind} {} {}</title><rect x="{}" y="{}" width="{}" height="{}" rx="{round}"/>"#,
                node.id, node.remark, rect.x, rect.y, rect.width, rect.height
            )?;
            if kind == "accumulator" {
                // A bladder within the shell.
                let (x, y, width, height) = (rect.x + 4, rect.y + 4, rect.width - 8, rect.height - 8);
                writeln!(
                    out,
                    r#"<path class="bladder" d="M{} {y}h{w}a{r} {r} 0 0 1 0 {height}h-{w}a{r} {r} 0 0 1 0-{height}"/>"#,
                    x + height / 2,
                    w = width - height,
                    r = height / 2,
                )?;
            }
            // The third line of type is for the page; without it the other two stand in the middle.
            let low = if dress == Dress::File && kind != "junction" { self.style.leading() / 2 } else { 0 };
            let sunk = |label: &Label| {
                let mut label = label.clone();
                label.at.y += low;
                label
            };
            text(out, &sunk(&drawn.title), "id", None, "")?;
            if kind != "junction" {
                text(out, &sunk(&drawn.first), "value", live(dress, &format!("n{index}a")).as_deref(), "")?;
                text(out, &drawn.second, "value", live(dress, &format!("n{index}b")).as_deref(), "")?;
            }
            writeln!(out, "</g>")?;
        }
        Ok(())
    }
}

/// The name under which the page finds a text.
fn live(dress: Dress, id: &str) -> Option<String> {
    (dress == Dress::Page).then(|| id.to_owned())
}

/// The attribute under which the page finds a thing.
fn name(dress: Dress, id: &str) -> String {
    live(dress, id).map(|id| format!(r#" id="{id}""#)).unwrap_or_default()
}

fn write_glyph(
    out: &mut String,
    element: &super::graph::Element,
    glyph: &Glyph,
    number: usize,
    style: Style,
    dress: Dress,
) -> std::fmt::Result {
    let half = f64::from(style.glyph) / 2.0;
    let turn = if glyph.mirrored { -half } else { half };
    let (kind, id) = (escaped(&element.kind), &element.id);
    let focus = if dress == Dress::Page { r#" tabindex="0" role="button""# } else { "" };
    writeln!(
        out,
        r#"<g class="element {kind}"{}{focus} aria-label="{kind} {id}">"#,
        name(dress, &format!("e{number}"))
    )?;
    let (x, y) = (glyph.centre.x, glyph.centre.y);
    let drawn = symbol(&element.kind);
    writeln!(
        out,
        r#"<title>{kind} {id}</title><g class="symbol" transform="translate({x} {y}) scale({turn} {half})">{}</g>"#,
        drawn.unwrap_or(NAMELESS)
    )?;
    if drawn.is_none() {
        // As large as fits; the whole name is in the tooltip.
        let px = (1..=style.text_px)
            .rev()
            .find(|px| text_width(&element.kind, *px) <= style.glyph - 4)
            .unwrap_or(4);
        writeln!(out, r#"<text class="kind" x="{x}" y="{}" font-size="{px}">{kind}</text>"#, y + px / 3)?;
    }
    text(out, &glyph.label, "name", None, "")?;
    for (value, label) in glyph.values.iter().enumerate() {
        text(
            out,
            label,
            "value",
            live(dress, &format!("e{number}{}", ['a', 'b'][value % 2])).as_deref(),
            "",
        )?;
    }
    writeln!(out, "</g>")
}

fn text(out: &mut String, label: &Label, class: &str, id: Option<&str>, inside: &str) -> std::fmt::Result {
    if label.text.is_empty() && id.is_none() {
        return Ok(());
    }
    let hang = match label.hang {
        Hang::Start => "start",
        Hang::Middle => "middle",
        Hang::End => "end",
    };
    let id = id.map(|id| format!(r#" id="{id}""#)).unwrap_or_default();
    let (x, y, px) = (label.at.x, label.at.y, label.px);
    let shown = escaped(&label.text);
    writeln!(
        out,
        r#"<text class="{class}"{id} x="{x}" y="{y}" font-size="{px}" text-anchor="{hang}">{inside}{shown}</text>"#
    )
}

/// Text as SVG and HTML take it, in elements and in quoted attributes.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(other),
        }
    }
    out
}
