//! `eclss-rt kinds`: the components that a network file may use.

use std::io::Write;

use eclss_network_file::{kinds, reference};

use crate::Failure;
use crate::args::KindsArgs;

/// Lists the kinds, or prints their reference.
pub(super) fn run(args: &KindsArgs, out: &mut dyn Write) -> Result<(), Failure> {
    if args.markdown {
        return Ok(out.write_all(reference::components().as_bytes())?);
    }
    let all = kinds::all();
    let width = all.iter().map(|kind| kind.name().len()).max().unwrap_or(0);
    for kind in all {
        writeln!(out, "{:<width$}  {}", kind.name(), kind.about())?;
    }
    Ok(())
}
