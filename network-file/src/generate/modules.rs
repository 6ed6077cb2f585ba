//! A station of equal modules, each the whole of one network file.

use std::collections::BTreeSet;
use std::fmt;

use eclss_core::parameter::Place;
use toml::{Table, Value};

use crate::kinds;

/// Tables whose entries have ids, beside those of components at nodes.
const OWNERS: [&str; 3] = ["node", "line", "control"];
/// Keys whose text is a word of the format, whatever ids there are.
const WORDS: [&str; 7] = ["kind", "interpolation", "method", "part", "density", "contents", "on_when"];

/// Why no station was made of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StationError {
    /// The module's text is not TOML.
    Text(String),
    /// The module has no node of this id, where its neighbours are joined.
    NoSuchNode(String),
    /// No module, or more than a file can hold.
    Count(usize),
}

impl fmt::Display for StationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(reason) => write!(f, "the module is not TOML: {reason}"),
            Self::NoSuchNode(id) => write!(f, "the module has no node `{id}` to join its neighbours at"),
            Self::Count(count) => write!(f, "no station of {count} modules: at least 1, at most {MOST}"),
        }
    }
}

impl std::error::Error for StationError {}

/// Most modules.
const MOST: usize = 1_000;

/// Returns `count` copies of the network in `text`, joined in a chain by two ventilation fans between the nodes `joint` of
/// every two neighbours. Ids get the copy's number behind them; hardware channels are left out.
pub fn modules(text: &str, count: usize, joint: &str) -> Result<String, StationError> {
    if !(1..=MOST).contains(&count) {
        return Err(StationError::Count(count));
    }
    let module: Table =
        text.parse().map_err(|error: toml::de::Error| StationError::Text(error.to_string()))?;
    let ids = ids(&module);
    let nodes = module.get("node").and_then(Value::as_array);
    let is_joint = |node: &Value| node.get("id").and_then(Value::as_str) == Some(joint);
    if !nodes.is_some_and(|nodes| nodes.iter().any(is_joint)) {
        return Err(StationError::NoSuchNode(joint.into()));
    }
    let mut station = Table::new();
    for (key, value) in module.iter().filter(|(key, _)| !matches!(key.as_str(), "process" | "channel")) {
        let value = match value.as_array() {
            Some(rows) => {
                let copies = (0..count).flat_map(|copy| rows.iter().map(move |row| (copy, row)));
                Value::Array(copies.map(|(copy, row)| renamed(key, row, copy, &ids)).collect())
            }
            None => value.clone(),
        };
        station.insert(key.clone(), value);
    }
    if let Some(name) = station.get_mut("name") {
        *name = Value::String(format!("{}_x{count}", name.as_str().unwrap_or("station")));
    }
    // A record of the module names ids that no longer exist.
    if let Some(run) = station.get_mut("run").and_then(Value::as_table_mut) {
        run.remove("record");
    }
    let lines = station.get_mut("line").and_then(Value::as_array_mut);
    if let Some(lines) = lines {
        for after in 1..count {
            lines.push(ventilation(joint, after - 1, after));
            lines.push(ventilation(joint, after, after - 1));
        }
    }
    Ok(station.to_string())
}

/// Ids of everything that has one.
fn ids(module: &Table) -> BTreeSet<String> {
    let rows = |table: &Table, key: &str| -> Vec<Value> {
        table.get(key).and_then(Value::as_array).cloned().unwrap_or_default()
    };
    let id = |row: &Value| row.get("id").and_then(Value::as_str).map(String::from);
    let mut found = BTreeSet::new();
    let parts = kinds::all().iter().filter(|kind| kind.place() != Place::Line).map(|kind| kind.name());
    for row in OWNERS.into_iter().chain(parts).flat_map(|owner| rows(module, owner)) {
        found.extend(id(&row));
        found.extend(
            row.as_table().into_iter().flat_map(|row| rows(row, "element")).filter_map(|row| id(&row)),
        );
    }
    found
}

/// A value with the copy's number behind every id in it, also where an id begins a name such as `fan.speed`.
fn renamed(key: &str, value: &Value, copy: usize, ids: &BTreeSet<String>) -> Value {
    match value {
        Value::String(text) if !WORDS.contains(&key) => {
            let (head, rest) =
                text.split_once('.').map_or((text.as_str(), None), |(head, rest)| (head, Some(rest)));
            let head = if ids.contains(head) { format!("{head}_{copy}") } else { head.into() };
            Value::String(rest.map_or_else(|| head.clone(), |rest| format!("{head}.{rest}")))
        }
        Value::Array(rows) => Value::Array(rows.iter().map(|row| renamed(key, row, copy, ids)).collect()),
        Value::Table(table) => Value::Table(
            table.iter().map(|(key, value)| (key.clone(), renamed(key, value, copy, ids))).collect(),
        ),
        other => other.clone(),
    }
}

/// A fan between two modules.
fn ventilation(joint: &str, from: usize, to: usize) -> Value {
    let text = |text: String| Value::String(text);
    let fan = Table::from_iter([
        ("id".to_owned(), text(format!("imv_fan_{from}_{to}"))),
        ("kind".into(), text("fan".into())),
        ("shutoff_pa".into(), Value::Float(200.0)),
        ("quadratic_pa_s2_kg2".into(), Value::Float(30_000.0)),
        ("inertance_per_m".into(), Value::Float(50.0)),
        ("power_w".into(), Value::Float(20.0)),
    ]);
    Value::Table(Table::from_iter([
        ("id".to_owned(), text(format!("imv_{from}_{to}"))),
        ("from".into(), text(format!("{joint}_{from}"))),
        ("to".into(), text(format!("{joint}_{to}"))),
        ("element".into(), Value::Array(vec![Value::Table(fan)])),
    ]))
}
