//! `eclss-rt report`: the whole validation in one file.

use std::io::Write;

use crate::args::ReportArgs;
use crate::output::write_text;
use crate::report::{Contents, report};
use crate::{Failure, Progress};

/// Computes and writes the report.
pub(super) fn run(args: &ReportArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let mut contents = Contents::whole();
    if !args.sizes.is_empty() {
        contents.sizes = args.sizes.iter().map(|size| *size as usize).collect();
    }
    contents.day_s = args.hours * 3_600;
    let progress = Progress::new(crate::paper::Experiment::work());
    let page = report(&contents, &progress)?;
    progress.finish();
    write_text(&args.output, &page)?;
    super::list_files(out, std::slice::from_ref(&args.output))
}
