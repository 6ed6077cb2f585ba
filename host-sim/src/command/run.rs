//! `eclss-rt run`: any network, any method.

use std::io::Write;
use std::path::PathBuf;

use crate::args::RunArgs;
use crate::output::Folder;
use crate::run::{Plan, Wishes, execute, picture, write_table};
use crate::{Failure, Progress, Source};

/// Runs the network and reports. A diverged run is reported like any other and then fails.
pub(super) fn run(args: &RunArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::open(args.network.as_deref())?;
    let wishes = Wishes {
        method: args.stepping.method,
        step: args.stepping.step,
        until: args.until,
        at: args.at.clone(),
        every: args.every,
    };
    let plan = Plan::new(&source, &wishes)?;
    // Made before the run: a folder that cannot be made is known at once.
    let folder = args.out.clone().or_else(|| (!args.json).then(|| default_folder(&source)));
    let folder = folder.map(|folder| Folder::make(&folder)).transpose()?;
    let (report, trace) = execute(&source, &plan, &Progress::new(plan.ticks))?;

    let mut files = Vec::new();
    let written = folder.map_or(Ok::<_, Failure>(()), |folder| {
        let name = format!("run_{}", plan.settings.method.name());
        files.push(folder.file(&format!("{name}.csv"), |file| trace.write_csv(file))?);
        files.push(folder.text(&format!("{name}.svg"), &picture(&report, &trace))?);
        Ok(())
    });
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|error| Failure::Failed(format!("cannot write the report: {error}")))?;
        writeln!(out, "{text}")?;
    } else {
        write_table(out, &source.loaded, &report)?;
        super::list_files(out, &files)?;
    }
    // What was found is told even where it could not be written.
    out.flush()?;
    written?;
    if report.diverged.is_some() { Err(Failure::Reported) } else { Ok(()) }
}

/// `results/` with the network's name.
pub(super) fn default_folder(source: &Source) -> PathBuf {
    PathBuf::from("results").join(&source.loaded.file.name)
}
