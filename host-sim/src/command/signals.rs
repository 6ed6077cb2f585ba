//! `eclss-rt signals`: everything that a network publishes.

use std::io::Write;

use eclss_network_file::NamedSignal;
use serde::Serialize;

use crate::args::SignalsArgs;
use crate::{Failure, Source};

/// Version of the JSON form.
const FORMAT: u32 = 1;

/// The list, as other programs read it.
#[derive(Serialize)]
struct List<'l> {
    format: u32,
    signals: Vec<Row<'l>>,
}

/// One signal.
#[derive(Serialize)]
struct Row<'l> {
    name: &'l str,
    /// Name of its column in CSV files.
    column: String,
    unit: &'static str,
    label: &'static str,
    display: &'static str,
    /// Whether it is written down where `record` is absent.
    standard: bool,
}

impl<'l> Row<'l> {
    fn of(named: &'l NamedSignal) -> Self {
        let spec = &named.spec;
        Self {
            name: &named.name,
            column: named.column(),
            unit: spec.unit(),
            label: spec.label,
            display: spec.display.name(),
            standard: named.is_standard(),
        }
    }
}

/// Lists the signals.
pub(super) fn run(args: &SignalsArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::open(args.network.as_deref())?;
    let named = source.loaded.signals();
    let signals: Vec<_> = named.iter().map(Row::of).collect();
    if args.json {
        let text = serde_json::to_string_pretty(&List { format: FORMAT, signals });
        return Ok(writeln!(out, "{}", text.map_err(|error| Failure::Failed(error.to_string()))?)?);
    }
    let width = signals.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
    for Row { name, unit, label, standard, .. } in &signals {
        let when = if *standard { "" } else { " (where it is named)" };
        writeln!(out, "{name:<width$}  {unit:<5}  {label}{when}")?;
    }
    Ok(())
}
