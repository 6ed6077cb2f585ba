//! The commands, one a file.

pub(crate) mod bench;
mod check;
mod generate;
#[cfg(feature = "hil")]
mod hil;
mod kinds;
mod paper;
mod report;
mod run;
mod schematic;
mod serve;
mod signals;
mod stability;
mod steady;

use std::ffi::OsString;
use std::io::{BufWriter, Write, stderr, stdout};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use eclss_network_file::kinds::{Kinds, register};

use crate::Failure;
use crate::args::{Cli, Command, PaperArgs};

/// Runs the program on the arguments of this process; network files may name the kinds `own` beside the shipped ones.
pub fn program(own: Kinds<'_>) -> ExitCode {
    if let Err(error) = register(own) {
        // Nobody is left to tell if this fails too.
        let _ = writeln!(stderr(), "error: {error}");
        return ExitCode::FAILURE;
    }
    let mut out = BufWriter::new(stdout().lock());
    ExitCode::from(main(std::env::args_os(), &mut out, &mut stderr()))
}

/// Runs the program: `arguments` with the program's name first, results to `out`, complaints to `err`. Returns
/// the exit code: 0 good, 2 usage or bad input, 1 failure.
pub fn main(arguments: impl IntoIterator<Item = OsString>, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    let done = match Cli::try_parse_from(arguments) {
        Ok(cli) => dispatch(&cli, out),
        Err(error) => usage(&error, out),
    };
    let done = done.and_then(|()| out.flush().map_err(Failure::from));
    match done {
        Ok(()) => 0,
        Err(failure) => {
            if matches!(failure, Failure::BadInput(_) | Failure::Failed(_)) {
                // Nobody is left to tell if this fails too.
                let _ = writeln!(err, "error: {failure}");
            }
            failure.exit_code()
        }
    }
}

fn usage(error: &clap::Error, out: &mut dyn Write) -> Result<(), Failure> {
    let text = error.render().to_string();
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return Ok(out.write_all(text.as_bytes())?);
    }
    Err(Failure::BadInput(text.trim_start_matches("error: ").trim_end().to_owned()))
}

fn dispatch(cli: &Cli, out: &mut dyn Write) -> Result<(), Failure> {
    match &cli.command {
        None => paper::run(&PaperArgs::default(), out),
        Some(Command::Paper(args)) => paper::run(args, out),
        Some(Command::Run(args)) => run::run(args, out),
        Some(Command::Check(args)) => check::run(args, out),
        Some(Command::Stability(args)) => stability::run(args, out),
        Some(Command::Bench(args)) => bench::run(args, out),
        Some(Command::Generate(args)) => generate::run(args, out),
        Some(Command::Steady(args)) => steady::run(args, out),
        Some(Command::Schematic(args)) => schematic::run(args, out),
        Some(Command::Serve(args)) => serve::run(args, out),
        Some(Command::Signals(args)) => signals::run(args, out),
        Some(Command::Kinds(args)) => kinds::run(args, out),
        #[cfg(feature = "hil")]
        Some(Command::Hil(args)) => hil::run(args, out),
        #[cfg(feature = "hil")]
        Some(Command::Watch(args)) => hil::run_watch(args, out),
        #[cfg(feature = "hil")]
        Some(Command::Replay(args)) => hil::run_replay(args, out),
        Some(Command::Report(args)) => report::run(args, out),
    }
}

/// Names what was written.
fn list_files(out: &mut dyn Write, files: &[PathBuf]) -> Result<(), Failure> {
    if !files.is_empty() {
        writeln!(out, "\nWritten:")?;
    }
    for file in files {
        writeln!(out, "  {}", file.display())?;
    }
    Ok(())
}
