//! How a command fails, and the exit code that says so.

use std::fmt;
use std::io;

/// A command that did not end well.
#[derive(Debug)]
pub enum Failure {
    /// The command line or an input file is wrong; the text names place and reason. Exit code 2.
    BadInput(String),
    /// The command was right but its work failed; the text says what and why. Exit code 1.
    Failed(String),
    /// The work is done and fully reported, and its result is a failure: a diverged run. Exit code 1.
    Reported,
    /// Whoever read our output closed it. Not an error: exit code 0.
    OutputClosed,
}

impl Failure {
    /// The exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::BadInput(_) => 2,
            Self::Failed(_) | Self::Reported => 1,
            Self::OutputClosed => 0,
        }
    }

    /// A file or folder that could not be read or written.
    pub fn file(what: &str, path: &std::path::Path, error: &io::Error) -> Self {
        Self::Failed(format!("cannot {what} {}: {error}", path.display()))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadInput(text) | Self::Failed(text) => f.write_str(text),
            Self::Reported => f.write_str("the run diverged"),
            Self::OutputClosed => f.write_str("the output was closed"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<io::Error> for Failure {
    /// For writes to the output; files name themselves through [`Failure::file`].
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::OutputClosed
        } else {
            Self::Failed(format!("cannot write the output: {error}"))
        }
    }
}
