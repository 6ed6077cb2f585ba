//! What is found while a file is read, and where every key of it stands.

use std::collections::HashMap;
use std::ops::Range as Span;

use eclss_core::component::FileKind;

use crate::error::Finding;
use crate::{kinds, limits};

/// Findings, and where in the text every key stands, by its path as in `line[0].element[2].exponent`.
#[derive(Debug)]
pub(crate) struct Notes {
    /// Kinds of component that the file may name.
    pub(crate) kinds: &'static [&'static dyn FileKind],
    pub(crate) findings: Vec<Finding>,
    /// All problems, of which the first [`limits::FINDINGS`] are kept.
    pub(crate) count: usize,
    pub(crate) places: HashMap<String, Span<usize>>,
}

impl Default for Notes {
    fn default() -> Self {
        Self { kinds: kinds::all(), findings: Vec::new(), count: 0, places: HashMap::new() }
    }
}

impl Notes {
    /// Records a problem at a span.
    pub(crate) fn refuse(&mut self, span: Span<usize>, reason: impl Into<String>) {
        self.add(span, || (reason.into(), None));
    }

    /// Records a problem with advice.
    pub(crate) fn refuse_with(
        &mut self,
        span: Span<usize>,
        reason: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(span, || (reason.into(), Some(help.into())));
    }

    fn add(&mut self, span: Span<usize>, words: impl FnOnce() -> (String, Option<String>)) {
        self.count += 1;
        if self.findings.len() < limits::FINDINGS {
            let (reason, help) = words();
            self.findings.push(Finding { reason, help, span: Some(span) });
        }
    }

    /// Records a problem at the first of `keys` that stands in the table at `path`, else at the table.
    pub(crate) fn refuse_at(&mut self, path: &str, keys: &[&str], reason: impl Into<String>) {
        let span = self.place(path, keys);
        self.refuse(span, reason);
    }

    /// Where the first of `keys` stands that is in the table at `path`, else the table, else what it is in.
    pub(crate) fn place(&self, path: &str, keys: &[&str]) -> Span<usize> {
        let of_key = keys.iter().find_map(|key| self.places.get(&join(path, key)));
        let mut path = Some(path);
        let above = std::iter::from_fn(|| {
            let here = path?;
            path = here.rfind(['.', '[']).map(|end| &here[..end]);
            Some(here)
        });
        of_key.or_else(|| above.into_iter().find_map(|path| self.places.get(path))).cloned().unwrap_or(0..0)
    }
}

/// Path of a key in the table at `path`.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
