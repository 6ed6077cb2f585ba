//! `eclss-rt schematic`: a network file as a drawing.

use std::io::Write;

use crate::args::SchematicArgs;
use crate::output::write_text;
use crate::schematic::{Drawing, Dress, Graph};
use crate::{Failure, Source};

/// Lays the network out and writes the drawing.
pub(super) fn run(args: &SchematicArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::open(args.network.as_deref())?;
    let graph = Graph::of(&source.loaded.file);
    let drawing = Drawing::new(&graph)
        .map_err(|error| Failure::Failed(format!("{}: {}", source.name, error.text(&graph))))?;
    let svg = drawing.svg(&graph, Dress::File);
    match &args.output {
        Some(path) => {
            write_text(path, &svg)?;
            super::list_files(out, std::slice::from_ref(path))
        }
        None => Ok(out.write_all(svg.as_bytes())?),
    }
}
