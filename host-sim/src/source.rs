//! Where a network comes from, and what is said when it is refused.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use eclss_network_file::{FileError, Loaded, Problem, limits, parse_bytes};

use crate::Failure;

/// The shipped network file, as it was when this program was built.
const SHIPPED: &str = include_str!("../../networks/paper.toml");
/// Where the shipped network file stands in the repository.
const SHIPPED_PATH: &str = "networks/paper.toml";

/// All networks that ship: path in the repository, text.
pub(crate) const NETWORKS: [(&str, &str); 6] = [
    (SHIPPED_PATH, SHIPPED),
    ("networks/paper-p0.toml", include_str!("../../networks/paper-p0.toml")),
    ("networks/paper-p.toml", include_str!("../../networks/paper-p.toml")),
    ("networks/station.toml", include_str!("../../networks/station.toml")),
    ("networks/thcs.toml", include_str!("../../networks/thcs.toml")),
    ("networks/hil.toml", include_str!("../../networks/hil.toml")),
];

/// A network and where it came from.
#[derive(Debug, Clone)]
pub struct Source {
    /// The file's path as given, or a description of the built-in copy.
    pub name: String,
    /// The network.
    pub loaded: Loaded,
}

impl Source {
    /// Reads the network file at `path`.
    pub fn file(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        // One byte more than is allowed is enough to see that the file is too long.
        let most = limits::FILE_BYTES as u64 + 1;
        File::open(path)
            .and_then(|file| file.take(most).read_to_end(&mut bytes))
            .map_err(|error| Failure::BadInput(format!("{name}: cannot be read: {error}")))?;
        Self::bytes(&bytes, &name, name.clone())
    }

    /// Reads the paper's network: from the current folder if it stands there, else the copy in this program.
    pub fn paper() -> Result<Self, Failure> {
        let path = Path::new(SHIPPED_PATH);
        if path.is_file() {
            return Self::file(path);
        }
        Self::shipped()
    }

    /// The copy of the paper's network inside this program.
    pub fn shipped() -> Result<Self, Failure> {
        Self::bytes(SHIPPED.as_bytes(), SHIPPED_PATH, format!("copy of {SHIPPED_PATH} inside this program"))
    }

    /// A network that is part of this program, under the path that it has in the repository.
    pub(crate) fn built_in(text: &str, path: &str) -> Result<Self, Failure> {
        Self::bytes(text.as_bytes(), path, format!("copy of {path} inside this program"))
    }

    /// Reads `path`, or the paper's network where none is given.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        path.map_or_else(Self::paper, Self::file)
    }

    /// Reads the bytes of a network file that is called `file` in messages and comes from `name`.
    pub fn text(bytes: &[u8], file: &str, name: String) -> Result<Self, Failure> {
        Self::bytes(bytes, file, name)
    }

    /// A reason behind the file's name, and the line that it is about where that is known.
    pub(crate) fn at(&self, line: Option<usize>, reason: &str) -> String {
        let name = &self.name;
        line.map_or_else(|| format!("{name}: {reason}"), |line| format!("{name}:{line}: {reason}"))
    }

    fn bytes(bytes: &[u8], file: &str, name: String) -> Result<Self, Failure> {
        let loaded = parse_bytes(bytes, file)
            .map_err(|error| Failure::BadInput(explain(&error, &String::from_utf8_lossy(bytes))))?;
        Ok(Self { name, loaded })
    }
}

/// Every problem as `file:line:column: reason` with the line it is about and what helps.
fn explain(error: &FileError, text: &str) -> String {
    let mut parts: Vec<_> = error.problems().iter().map(|problem| explain_one(problem, text)).collect();
    if error.more() > 0 {
        parts.push(format!("{}: and {} more problems", error.name(), error.more()));
    }
    parts.join("\n")
}

fn explain_one(problem: &Problem, text: &str) -> String {
    let mut out = problem.to_string();
    if let (Some(line), Some(span)) = (text.lines().nth(problem.line.wrapping_sub(1)), &problem.span) {
        let number = problem.line.to_string();
        let room = " ".repeat(number.len());
        let shown: String = line.chars().map(|c| if c == '\t' { ' ' } else { c }).take(160).collect();
        let before = problem.column.saturating_sub(1).min(160);
        let rest = line.chars().count().saturating_sub(before).max(1);
        let marked =
            text.get(span.clone()).map_or(1, |part| part.lines().next().unwrap_or("").chars().count());
        let marks = "^".repeat(marked.clamp(1, rest.min(160)));
        let _ = write!(out, "\n {room} |\n {number} | {shown}\n {room} | {}{marks}", " ".repeat(before));
    }
    if let Some(help) = &problem.help {
        let _ = write!(out, "\n  help: {help}");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_copy_is_a_good_network() {
        let source = Source::bytes(SHIPPED.as_bytes(), SHIPPED_PATH, String::new()).unwrap();
        assert!(source.loaded.network().check().is_ok());
        assert!(source.loaded.names.inputs.iter().any(|name| name == "valve.opening"));
    }

    #[test]
    fn every_network_that_ships_is_part_of_the_program() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut found: Vec<_> = files
            .filter(|path| std::fs::read_to_string(path).is_ok_and(|text| text.contains("[[node]]")))
            .map(|path| format!("networks/{}", path.file_name().unwrap().display()))
            .collect();
        let mut known: Vec<_> = NETWORKS.iter().map(|(path, _)| (*path).to_owned()).collect();
        found.sort();
        known.sort();
        assert_eq!(found, known);
        for (path, text) in NETWORKS {
            Source::built_in(text, path).unwrap_or_else(|failure| panic!("{failure}"));
        }
    }

    #[test]
    fn a_bad_value_is_shown_in_its_line() {
        let text = SHIPPED.replace("volume_m3 = 60.0", "volume_m3 = -60.0");
        let failure = Source::bytes(text.as_bytes(), "bad.toml", String::new()).unwrap_err();
        let shown = failure.to_string();
        assert!(shown.starts_with("bad.toml:") && shown.contains("volume_m3 = -60.0"), "{shown}");
        assert!(shown.contains("^^^^^"), "{shown}");
        assert_eq!(failure.exit_code(), 2);
    }
}
