//! What is wrong with a file: places, reasons and help.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::notes::Notes;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// A file that was refused, with everything found wrong in it.
#[derive(Debug, Clone)]
pub struct FileError {
    name: String,
    problems: Vec<Problem>,
    /// Number of problems that are not listed.
    more: usize,
}

/// One thing wrong in a file.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Why it was refused.
    pub reason: String,
    /// What to do about it.
    pub help: Option<String>,
    /// Bytes of the file that it is about; `None` where there is no text to point at.
    pub span: Option<Range<usize>>,
    /// Line of the file, counted from 1; 0 without a span.
    pub line: usize,
    /// Column in characters, counted from 1; 0 without a span.
    pub column: usize,
    source: Option<Arc<NamedSource<String>>>,
    name: String,
}

/// A finding while a file is read, before it is tied to the text.
#[derive(Debug, Clone)]
pub(crate) struct Finding {
    pub(crate) reason: String,
    pub(crate) help: Option<String>,
    pub(crate) span: Option<Range<usize>>,
}

impl FileError {
    /// Ties findings to the text of the file; there must be some.
    pub(crate) fn new(name: &str, text: &str, notes: Notes) -> Self {
        let Notes { mut findings, count, .. } = notes;
        let more = count - findings.len();
        let source = Arc::new(NamedSource::new(name, text.to_owned()).with_language("toml"));
        findings.sort_by_key(|finding| finding.span.as_ref().map_or(0, |span| span.start));
        let ends: Vec<usize> = text.match_indices('\n').map(|(byte, _)| byte).collect();
        let problems = findings.into_iter().map(|finding| Problem::new(name, text, &ends, &source, finding));
        Self { name: name.to_owned(), problems: problems.collect(), more }
    }

    /// A file that could not be read at all.
    pub(crate) fn unreadable(name: &str, reason: &std::io::Error) -> Self {
        let reason = format!("cannot be read: {reason}");
        let problem = Problem {
            reason,
            help: None,
            span: None,
            line: 0,
            column: 0,
            source: None,
            name: name.to_owned(),
        };
        Self { name: name.to_owned(), problems: vec![problem], more: 0 }
    }

    /// Name of the file as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many problems beyond [`Self::problems`] there are.
    pub fn more(&self) -> usize {
        self.more
    }

    /// Problems found, in file order, up to [`crate::limits::FINDINGS`]; never empty.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }
}

impl Problem {
    /// `ends` are the places of all line ends in `text`.
    fn new(
        name: &str,
        text: &str,
        ends: &[usize],
        source: &Arc<NamedSource<String>>,
        finding: Finding,
    ) -> Self {
        let Finding { reason, help, span } = finding;
        let (line, column) = span.as_ref().map_or((0, 0), |span| position(text, ends, span.start));
        Self { reason, help, span, line, column, source: Some(Arc::clone(source)), name: name.to_owned() }
    }
}

/// Line and column of a byte of `text`, counted from 1.
fn position(text: &str, ends: &[usize], byte: usize) -> (usize, usize) {
    let line = ends.partition_point(|&end| end < byte);
    let start = line.checked_sub(1).map_or(0, |before| ends[before] + 1);
    (line + 1, text.get(start..byte).map_or(0, |before| before.chars().count()) + 1)
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.name, self.reason),
            line => write!(f, "{}:{line}:{}: {}", self.name, self.column, self.reason),
        }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.problems.as_slice() {
            [] => write!(f, "{}: refused", self.name),
            [only] => write!(f, "{only}"),
            [first, rest @ ..] => write!(f, "{first} (and {} more)", rest.len() + self.more),
        }
    }
}

impl std::error::Error for Problem {}
impl std::error::Error for FileError {}

impl Diagnostic for Problem {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_deref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span.clone()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(span))))
    }
}

impl Diagnostic for FileError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        // With one problem the error is that problem; with several they are listed below it.
        self.only().and_then(Diagnostic::help)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.only().and_then(Diagnostic::source_code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.only().and_then(Diagnostic::labels)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let several = self.problems.len() > 1;
        let list = self.problems.iter().map(|problem| problem as &dyn Diagnostic);
        several.then(|| Box::new(list) as Box<dyn Iterator<Item = &dyn Diagnostic>>)
    }
}

impl FileError {
    fn only(&self) -> Option<&Problem> {
        if let [problem] = self.problems.as_slice() { Some(problem) } else { None }
    }
}
