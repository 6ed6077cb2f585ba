//! `eclss-rt` and `eclss-rt paper`: the paper's experiment.

use std::io::Write;
use std::path::PathBuf;

use crate::args::PaperArgs;
use crate::output::{Folder, write_text};
use crate::paper::{Experiment, Results, pictures, readme_picture, write_report};
use crate::{Failure, Progress, Source};

/// Runs the experiment, prints the table, writes CSV and plots.
pub(super) fn run(args: &PaperArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::paper()?;
    let folder = Folder::make(&args.out)?;
    let progress = Progress::new(Experiment::work());
    let results = Experiment::new(&source)?.run(&progress);
    progress.finish();
    let results = results?;

    let mut files = Vec::new();
    let written = write_files(args, &folder, &results, &mut files);
    write_report(out, &source, &results)?;
    super::list_files(out, &files)?;
    // What was found is told even where it could not be written.
    out.flush()?;
    written
}

fn write_files(
    args: &PaperArgs,
    folder: &Folder,
    results: &Results,
    files: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    for run in results.relaxation.iter().chain(&results.euler) {
        let name = format!("{}_{}ms.csv", run.settings.method.name(), run.settings.step_us / 1_000);
        files.push(folder.file(&name, |file| run.trace.write_csv(file))?);
    }
    for picture in pictures(results) {
        files.push(folder.text(&picture.file, &picture.svg)?);
    }
    if let (Some(path), Some(svg)) = (&args.readme_picture, readme_picture(results)) {
        write_text(path, &svg)?;
        files.push(path.clone());
    }
    Ok(())
}
