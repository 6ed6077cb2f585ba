//! `eclss-rt steady`: the state of rest of a network, with its inputs as they are at the start.

use std::io::Write;

use eclss_network_file::steady::{Steady, steady};
use serde::Serialize;

use crate::args::SteadyArgs;
use crate::{Failure, Source};

/// The answer with ids.
#[derive(Serialize)]
struct Report<'a> {
    network: &'a str,
    iterations: u32,
    residual: f64,
    /// Closed air whose mass is held.
    held: Vec<HeldReport<'a>>,
    nodes: Vec<NodeReport<'a>>,
    lines: Vec<LineReport<'a>>,
}

#[derive(Serialize)]
struct NodeReport<'a> {
    id: &'a str,
    pressure_pa: f64,
    gauge_pa: f64,
}

#[derive(Serialize)]
struct LineReport<'a> {
    id: &'a str,
    from: &'a str,
    to: &'a str,
    mass_flow_kg_s: f64,
}

#[derive(Serialize)]
struct HeldReport<'a> {
    nodes: Vec<&'a str>,
    lines: Vec<&'a str>,
    rate_pa_s: f64,
}

/// Solves and prints.
pub(super) fn run(args: &SteadyArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::file(&args.network)?;
    let loaded = &source.loaded;
    let found = steady(&loaded.network(), &loaded.inputs)
        .map_err(|error| Failure::Failed(source.at(error.place(loaded), &error.text(&loaded.names))))?;
    let report = Report::new(&source, &found);
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|error| Failure::Failed(format!("cannot write the report: {error}")))?;
        writeln!(out, "{text}")?;
    } else {
        report.write_table(out)?;
    }
    Ok(())
}

impl<'a> Report<'a> {
    fn new(source: &'a Source, found: &Steady) -> Self {
        let (loaded, names) = (&source.loaded, &source.loaded.names);
        let reference = f64::from(loaded.reference_pa);
        let node = |(id, gauge_pa): (&'a String, &f64)| NodeReport {
            id,
            pressure_pa: reference + gauge_pa,
            gauge_pa: *gauge_pa,
        };
        let list = |names: &'a [String], indices: &[u32]| {
            indices.iter().filter_map(|index| names.get(*index as usize)).map(String::as_str).collect()
        };
        let held = found.held.iter().map(|held| HeldReport {
            nodes: list(&names.nodes, &held.nodes),
            lines: list(&names.lines, &held.lines),
            rate_pa_s: held.rate_pa_s,
        });
        let name = |index: u32| names.nodes.get(index as usize).map_or("", String::as_str);
        let lines = names.lines.iter().zip(&loaded.lines).zip(&found.flow_kg_s);
        Self {
            network: &source.name,
            iterations: found.iterations,
            residual: found.residual,
            held: held.collect(),
            nodes: names.nodes.iter().zip(&found.gauge_pa).map(node).collect(),
            lines: lines
                .map(|((id, line), flow)| LineReport {
                    id,
                    from: name(line.from),
                    to: name(line.to),
                    mass_flow_kg_s: *flow,
                })
                .collect(),
        }
    }

    fn write_table(&self, out: &mut dyn Write) -> Result<(), Failure> {
        let ids = self.nodes.iter().map(|node| node.id).chain(self.lines.iter().map(|line| line.id));
        let width = ids.map(str::len).max().unwrap_or(0);
        writeln!(out, "network     {}", self.network)?;
        writeln!(out, "iterations  {}, residual {:.1e}", self.iterations, self.residual)?;
        for held in &self.held {
            writeln!(
                out,
                "held        mass of {}; without it {:.3e} Pa/d through {}",
                held.nodes.join(", "),
                86_400.0 * held.rate_pa_s,
                held.lines.join(", ")
            )?;
        }
        writeln!(out, "\n{:width$}  {:>14}  {:>12}", "node", "pressure [Pa]", "gauge [Pa]")?;
        for node in &self.nodes {
            writeln!(
                out,
                "{:width$}  {:14.4}  {:12.4}",
                node.id,
                node.pressure_pa,
                rounded(node.gauge_pa, 1e4)
            )?;
        }
        writeln!(out, "\n{:width$}  {:>14}", "line", "flow [g/s]")?;
        for line in &self.lines {
            let flow = rounded(1e3 * line.mass_flow_kg_s, 1e6);
            writeln!(out, "{:width$}  {flow:14.6}  {} → {}", line.id, line.from, line.to)?;
        }
        Ok(())
    }
}

/// Rounds to a part of `parts`, so that what vanishes is shown as 0, whichever side the search came from.
fn rounded(number: f64, parts: f64) -> f64 {
    (number * parts).round() / parts + 0.0
}
