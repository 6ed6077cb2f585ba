//! The networks that ship, drawn.

use super::html::Html;
use crate::schematic::{Drawing, Dress, Graph};
use crate::source::NETWORKS;
use crate::{Failure, Source};

/// Those that look alike are drawn once.
const DRAWN: [&str; 3] = ["networks/paper.toml", "networks/station.toml", "networks/thcs.toml"];

/// Draws and writes the section.
pub(super) fn write(page: &mut Html) -> Result<(), Failure> {
    page.section("Networks");
    for (path, text) in NETWORKS.into_iter().filter(|(path, _)| DRAWN.contains(path)) {
        let source = Source::built_in(text, path)?;
        let graph = Graph::of(&source.loaded.file);
        let drawing = Drawing::new(&graph)
            .map_err(|error| Failure::Failed(format!("{path}: {}", error.text(&graph))))?;
        let command = format!("eclss-rt schematic {path} -o FILE.svg");
        page.figure(&drawing.svg(&graph, Dress::File), &graph.title, &command);
    }
    Ok(())
}
