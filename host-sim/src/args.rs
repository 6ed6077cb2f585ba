//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Simulates the fluid networks of a space station's life support.
///
/// Without a command it runs the experiment of the paper on which the method rests.
#[derive(Debug, Parser)]
#[command(name = "eclss-rt", version, about, long_about)]
pub(crate) struct Cli {
    /// What to do; the paper's experiment when absent.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run the paper's experiment: table, CSV and plots.
    Paper(PaperArgs),
}

/// Arguments of `paper`.
#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    /// Folder for CSV and plots.
    #[arg(long, default_value = "results/paper", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Also draw the README's picture into this file.
    #[arg(long, value_name = "FILE")]
    pub(crate) readme_picture: Option<PathBuf>,
}

impl Default for PaperArgs {
    fn default() -> Self {
        Self { out: PathBuf::from("results/paper"), readme_picture: None }
    }
}
