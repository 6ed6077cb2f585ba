//! `eclss-rt generate`: a made-up network of any size.

use std::io::Write;

use eclss_network_file::generate::generate;

use crate::Failure;
use crate::args::GenerateArgs;
use crate::output::write_text;

/// Writes a network file to where the arguments say, or to `out`.
pub(super) fn run(args: &GenerateArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let file =
        generate(args.shape, args.nodes, args.seed).map_err(|error| Failure::BadInput(error.to_string()))?;
    let text = file.to_toml();
    match &args.output {
        None => write!(out, "{text}")?,
        Some(path) => {
            write_text(path, &text)?;
            let (nodes, lines) = (file.nodes.len(), file.lines.len());
            writeln!(out, "written: {}, {nodes} nodes, {lines} lines", path.display())?;
        }
    }
    Ok(())
}
