//! What is wrong with a file: places, reasons and help.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// A file that was refused, with everything found wrong in it.
#[derive(Debug, Clone)]
pub struct FileError {
    name: String,
    problems: Vec<Problem>,
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
    /// Ties findings to the text of the file; `findings` must not be empty.
    pub(crate) fn new(name: &str, text: &str, mut findings: Vec<Finding>) -> Self {
        let source = Arc::new(NamedSource::new(name, text.to_owned()).with_language("toml"));
        findings.sort_by_key(|finding| finding.span.as_ref().map_or(0, |span| span.start));
        let problems = findings.into_iter().map(|finding| Problem::new(name, text, &source, finding));
        Self { name: name.to_owned(), problems: problems.collect() }
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
        Self { name: name.to_owned(), problems: vec![problem] }
    }

    /// Name of the file as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Everything that was found, in file order; never empty.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }
}

impl Problem {
    fn new(name: &str, text: &str, source: &Arc<NamedSource<String>>, finding: Finding) -> Self {
        let Finding { reason, help, span } = finding;
        let (line, column) = span.as_ref().map_or((0, 0), |span| position(text, span.start));
        Self { reason, help, span, line, column, source: Some(Arc::clone(source)), name: name.to_owned() }
    }
}

/// Line and column of a byte of `text`, counted from 1.
fn position(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
    (line, before.get(start..).map_or(0, |rest| rest.chars().count()) + 1)
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
            [first, rest @ ..] => write!(f, "{first} (and {} more)", rest.len()),
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
