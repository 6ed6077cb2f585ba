//! `eclss-rt generate`: a made-up network of any size.

use std::io::Write;

use eclss_network_file::generate::{Gas, generate, modules, ring};

use crate::Failure;
use crate::args::{GenerateArgs, Made};
use crate::output::write_text;

/// Writes a network file to where the arguments say, or to `out`.
pub(super) fn run(args: &GenerateArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let (text, size) = made(args)?;
    match &args.output {
        None => write!(out, "{text}")?,
        Some(path) => {
            write_text(path, &text)?;
            writeln!(out, "written: {}, {size}", path.display())?;
        }
    }
    Ok(())
}

/// The text of the file, and its size for people.
fn made(args: &GenerateArgs) -> Result<(String, String), Failure> {
    let refuse = |error: &dyn std::fmt::Display| Failure::BadInput(error.to_string());
    let gas = match (args.air, args.density_follows) {
        (_, true) => Gas::Following,
        (true, false) => Gas::Air,
        (false, false) => Gas::Plain,
    };
    if gas != Gas::Plain && !matches!(args.shape, Made::Ring) {
        return Err(refuse(&"--air and --density-follows are for `generate ring`"));
    }
    let file = match args.shape {
        Made::Modules => {
            let text = std::fs::read_to_string(&args.module)
                .map_err(|error| refuse(&format!("{}: {error}", args.module.display())))?;
            let text = modules(&text, args.nodes, &args.joint).map_err(|error| refuse(&error))?;
            return Ok((text, format!("{} modules", args.nodes)));
        }
        Made::Ring => ring(args.nodes, gas),
        Made::Shape(shape) => generate(shape, args.nodes, args.seed),
    };
    let file = file.map_err(|error| refuse(&error))?;
    Ok((file.to_toml(), format!("{} nodes, {} lines", file.nodes.len(), file.lines.len())))
}
