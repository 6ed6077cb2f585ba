//! Component of a line in a document: its kind and the keys of that kind.

use std::collections::BTreeMap;

use eclss_core::component::FileKind;
use serde::Serialize;

use super::air::Starts;

/// One value of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number in the unit of its key.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A word or an id.
    Text(String),
}

/// Kind of a component with the keys that its table gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// The kind.
    #[serde(skip)]
    pub kind: &'static dyn FileKind,
    /// Keys of the kind that the table gives.
    #[serde(flatten)]
    pub keys: BTreeMap<&'static str, Value>,
    /// Start values of inputs that the table gives.
    #[serde(flatten)]
    pub starts: Starts,
}

impl Entry {
    /// Returns an entry with these numbers.
    pub fn new(kind: &'static dyn FileKind, numbers: &[(&'static str, f64)]) -> Self {
        let keys = numbers.iter().map(|&(key, number)| (key, Value::Number(number))).collect();
        Self { kind, keys, starts: Starts::new() }
    }

    /// Returns a number that the table gives.
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.keys.get(key)? {
            Value::Number(number) => Some(*number),
            Value::Flag(_) | Value::Text(_) => None,
        }
    }

    /// Returns a flag that the table gives.
    pub fn flag(&self, key: &str) -> Option<bool> {
        match self.keys.get(key)? {
            Value::Flag(flag) => Some(*flag),
            Value::Number(_) | Value::Text(_) => None,
        }
    }

    /// Returns a word or an id that the table gives.
    pub fn text(&self, key: &str) -> Option<&str> {
        match self.keys.get(key)? {
            Value::Text(text) => Some(text),
            Value::Number(_) | Value::Flag(_) => None,
        }
    }
}
