//! Reads TOML tables key by key and collects what is wrong instead of stopping at it.
//!
//! A value that is refused is recorded as a finding and replaced by a stand-in, so that the rest of the file is
//! still looked at; with any finding the document is thrown away.

use std::ops::{Range as Span, RangeInclusive};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::limits::{ID_BYTES, Range};
use crate::notes::{Notes, join};
use crate::number::{kind_of, number};

/// One table while it is read.
pub(crate) struct Table<'n, 't> {
    pub(crate) notes: &'n mut Notes,
    entries: &'t DeTable<'t>,
    span: Span<usize>,
    path: String,
    known: Vec<&'static str>,
    /// The table's kind is not known, so neither are its keys.
    unclear: bool,
}

impl<'n, 't> Table<'n, 't> {
    pub(crate) fn new(
        notes: &'n mut Notes,
        entries: &'t DeTable<'t>,
        span: Span<usize>,
        path: String,
    ) -> Self {
        notes.places.insert(path.clone(), span.clone());
        Self { notes, entries, span, path, known: Vec::new(), unclear: false }
    }

    /// The value of `key`, which counts as known from here on.
    fn value(&mut self, key: &'static str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.known.push(key);
        let value = self.entries.get(key)?;
        self.notes.places.insert(join(&self.path, key), value.span());
        Some(value)
    }

    /// Whether `key` stands in the table.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// Records a problem at the value of `key`, else at the table.
    pub(crate) fn refuse(&mut self, key: &str, reason: impl Into<String>) {
        let span = self.entries.get(key).map_or_else(|| self.span.clone(), Spanned::span);
        self.notes.refuse(span, reason);
    }

    fn missing(&mut self, key: &str) {
        let span = self.span.clone();
        self.notes.refuse(span, format!("`{key}` is missing"));
    }

    /// Text of a key that may be absent.
    pub(crate) fn text(&mut self, key: &'static str) -> Option<String> {
        let value = self.value(key)?;
        match value.get_ref() {
            // Text shown on a terminal must not contain control characters.
            DeValue::String(text) if text.chars().any(char::is_control) => {
                self.notes.refuse(value.span(), format!("`{key}` has a control character"));
                None
            }
            DeValue::String(text) => Some(text.to_string()),
            other => {
                self.notes.refuse(value.span(), format!("`{key}` must be text, not {}", kind_of(other)));
                None
            }
        }
    }

    /// Text of a key that must be there.
    pub(crate) fn need_text(&mut self, key: &'static str) -> String {
        if !self.has(key) {
            self.known.push(key);
            self.missing(key);
        }
        self.text(key).unwrap_or_default()
    }

    /// An id: a small letter, then small letters, digits and underscores.
    pub(crate) fn need_id(&mut self, key: &'static str) -> String {
        let before = self.notes.count;
        let id = self.need_text(key);
        if self.notes.count == before && !is_id(&id) {
            let span = self.notes.place(&self.path, &[key]);
            let help =
                format!("ids are like `fan_2`: a-z, then a-z, 0-9 and _, at most {ID_BYTES} characters");
            self.notes.refuse_with(span, format!("`{id}` is not an id"), help);
        }
        id
    }

    /// One of a set of words; `None` when absent or refused.
    pub(crate) fn word(&mut self, key: &'static str, words: &[&str]) -> Option<String> {
        let text = self.text(key)?;
        if words.contains(&text.as_str()) {
            return Some(text);
        }
        let span = self.notes.place(&self.path, &[key]);
        let help = format!("{key} is one of {}", words.join(", "));
        self.notes.refuse_with(span, format!("`{text}` is not a {key} that exists"), help);
        None
    }

    /// The kind of the table, one of a set of words that must be there.
    pub(crate) fn need_kind(&mut self, key: &'static str, words: &[&str]) -> Option<String> {
        self.need_word(key, words)
    }

    /// One of a set of words that must be there and decides which keys the table has.
    pub(crate) fn need_word(&mut self, key: &'static str, words: &[&str]) -> Option<String> {
        if !self.has(key) {
            self.known.push(key);
            self.missing(key);
        }
        let kind = self.word(key, words);
        self.unclear |= kind.is_none();
        kind
    }

    /// Number of a key that may be absent.
    pub(crate) fn number(&mut self, key: &'static str, range: &Range) -> Option<f64> {
        let value = self.value(key)?;
        number(self.notes, key, value, range)
    }

    /// True or false, if it is there.
    pub(crate) fn flag(&mut self, key: &'static str) -> Option<bool> {
        let value = self.value(key)?;
        if let DeValue::Boolean(value) = value.get_ref() {
            return Some(*value);
        }
        self.notes.refuse(value.span(), format!("`{key}` is true or false"));
        None
    }

    /// Number of a key that must be there.
    pub(crate) fn need_number(&mut self, key: &'static str, range: &Range) -> f64 {
        if !self.has(key) {
            self.known.push(key);
            self.missing(key);
        }
        // The stand-in is never used: a finding was recorded.
        self.number(key, range).unwrap_or(1.0)
    }

    /// The values of an array; `None` when absent or refused.
    pub(crate) fn array(&mut self, key: &'static str) -> Option<&'t [Spanned<DeValue<'t>>]> {
        let value = self.value(key)?;
        match value.get_ref() {
            DeValue::Array(array) => {
                for (index, item) in array.iter().enumerate() {
                    let path = format!("{}[{index}]", join(&self.path, key));
                    self.notes.places.insert(path, item.span());
                }
                Some(array.as_ref())
            }
            other => {
                self.notes.refuse(value.span(), format!("`{key}` must be a list, not {}", kind_of(other)));
                None
            }
        }
    }

    /// Reads the table of `key` with `read`; `None` when absent or refused.
    pub(crate) fn table<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Table<'_, 't>) -> T,
    ) -> Option<T> {
        let value = self.value(key)?;
        let DeValue::Table(table) = value.get_ref() else {
            self.notes.refuse(value.span(), format!("`{key}` must be a table `[{key}]`"));
            return None;
        };
        let path = join(&self.path, key);
        Some(Table::new(self.notes, table, value.span(), path).read(read))
    }

    /// Reads every table of `[[key]]` with `read`; how many there may be is `count`.
    pub(crate) fn tables<T>(
        &mut self,
        key: &'static str,
        count: RangeInclusive<usize>,
        mut read: impl FnMut(&mut Table<'_, 't>) -> Option<T>,
    ) -> Vec<T> {
        let before = self.notes.count;
        let array = self.array(key).unwrap_or_default();
        if array.len() > *count.end() {
            let (given, most) = (array.len(), count.end());
            self.refuse(key, format!("{given} tables `[[{key}]]`, at most {most} are allowed"));
            return Vec::new();
        }
        if array.len() < *count.start() && self.notes.count == before {
            self.refuse(key, format!("there is no `[[{key}]]`"));
        }
        let mut list = Vec::with_capacity(array.len());
        for (index, value) in array.iter().enumerate() {
            if let DeValue::Table(table) = value.get_ref() {
                let path = format!("{}[{index}]", join(&self.path, key));
                list.extend(Table::new(self.notes, table, value.span(), path).read(&mut read));
            } else {
                self.notes.refuse(value.span(), format!("`{key}` must be tables `[[{key}]]`"));
            }
        }
        list
    }

    /// Reads the table and refuses the keys that nobody asked for.
    pub(crate) fn read<T>(mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let result = read(&mut self);
        for key in self.entries.keys() {
            if !self.unclear && !self.known.contains(&key.get_ref().as_ref()) {
                let name = key.get_ref();
                let nearest = self.known.iter().min_by_key(|known| distance(name, known));
                let help = match nearest.filter(|known| distance(name, known) <= 3) {
                    Some(nearest) => format!("did you mean `{nearest}`?"),
                    None => format!("known here: {}", self.known.join(", ")),
                };
                self.notes.refuse_with(key.span(), format!("unknown key `{name}`"), help);
            }
        }
        result
    }
}

fn is_id(id: &str) -> bool {
    id.len() <= ID_BYTES
        && id.starts_with(|first: char| first.is_ascii_lowercase())
        && id.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
}

/// Edits that turn `a` into `b` (Levenshtein), for advice only.
fn distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, y) in b.bytes().enumerate() {
            let change = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = change.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
