//! `eclss-rt check`: what is in a network file, and what to watch.

use std::io::Write;

use eclss_core::{Method, NodeKind};

use crate::args::CheckArgs;
use crate::linear::{LineModel, worst};
use crate::output::write_text;
use crate::refusal::refused;
use crate::run::{Plan, Wishes, part, proof};
use crate::stability::{MOST_ROWS, Range, sweep_line};
use crate::{Duration, Failure, HostBuffers, Source};

/// Reads, checks, summarises.
pub(super) fn run(args: &CheckArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::file(&args.network)?;
    let wishes = Wishes { method: args.stepping.method, step: args.stepping.step, ..Wishes::default() };
    let plan = Plan::new(&source, &wishes)?;
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    buffers.simulator(&network, plan.settings).map_err(|error| refused(&source, plan.settings, &error))?;

    let loaded = &source.loaded;
    writeln!(out, "network     {}", source.name)?;
    writeln!(out, "name        {}", loaded.file.name)?;
    if let Some(title) = &loaded.file.title {
        writeln!(out, "title       {title}")?;
    }
    writeln!(out, "network id  {:016x}", network.id())?;
    writeln!(out, "run         {} at {} until {}", plan.settings.method.name(), plan.step(), plan.until())?;
    write_contents(out, &source)?;
    let warnings = write_margins(out, &source, &plan)?;
    writeln!(out)?;
    for warning in &warnings {
        writeln!(out, "warning: {warning}")?;
    }
    if let Some(path) = &args.save {
        write_text(path, &loaded.file.to_toml())?;
        writeln!(out, "written: {}", path.display())?;
    }
    writeln!(out, "good, {} warnings", warnings.len())?;
    Ok(())
}

fn write_contents(out: &mut dyn Write, source: &Source) -> Result<(), Failure> {
    let loaded = &source.loaded;
    let names = &loaded.names;
    writeln!(out, "\nnodes       {}", names.nodes.len())?;
    for (id, node) in names.nodes.iter().zip(&loaded.nodes) {
        let kind = match node.kind {
            NodeKind::Cabin { volume_m3 } => format!("cabin, {volume_m3} m³"),
            NodeKind::Boundary => "boundary".to_owned(),
            NodeKind::Junction => "junction".to_owned(),
        };
        let pressure = f64::from(loaded.reference_pa) + f64::from(node.start_gauge_pa);
        writeln!(out, "  {id}: {kind}, {pressure} Pa, {} K", node.temperature_k)?;
    }
    writeln!(out, "lines       {}, with {} elements", names.lines.len(), names.segments.len())?;
    let name = |list: &[String], index: u32| list.get(index as usize).cloned().unwrap_or_default();
    for (id, line) in names.lines.iter().zip(&loaded.lines) {
        let first = line.first_segment as usize;
        let elements = names.segments.get(first..first + line.segments as usize).unwrap_or(&[]).join(", ");
        let (from, to) = (name(&names.nodes, line.from), name(&names.nodes, line.to));
        let flow = name(&names.segments, line.first_segment + line.flow_segment);
        writeln!(out, "  {id}: {from} → {elements} → {to}; its flow stands at {flow}")?;
    }
    writeln!(out, "inputs      {}", names.inputs.len())?;
    for (slot, (id, value)) in names.inputs.iter().zip(&loaded.inputs).enumerate() {
        let schedule = loaded.schedules.iter().find(|schedule| schedule.input as usize == slot);
        let points =
            schedule.map_or(String::new(), |list| format!(", scheduled with {} points", list.points));
        writeln!(out, "  {id}: {value}{points}")?;
    }
    Ok(())
}

/// Figures of the operator for every line, and what they warn of.
fn write_margins(out: &mut dyn Write, source: &Source, plan: &Plan) -> Result<Vec<String>, Failure> {
    let mut warnings = Vec::new();
    let method = plan.settings.method;
    if !crate::is_pseudo_time(method) {
        return Ok(warnings);
    }
    let stabilised = method == Method::Relaxation;
    let network = source.loaded.network();
    let step_s = plan.step().seconds();
    writeln!(out, "margins     at rest with the inputs of the start, ends held")?;
    for (index, id) in source.loaded.names.lines.iter().enumerate() {
        let Some(model) = LineModel::new(&network, index, network.inputs) else { continue };
        let flow = model.steady_flow_kg_s();
        let phi = if stabilised { model.phi(flow, step_s) } else { 1.0 };
        let margin = model.margin(flow, step_s, phi);
        writeln!(
            out,
            "  {id}: {:.6} g/s, φ {}, spectral bound {:.6}, proof {}",
            // Rest is 0, whichever side the search came from.
            (flow * 1e9).round() / 1e6 + 0.0,
            part(margin.phi),
            margin.spectral_bound,
            proof(margin.proof)
        )?;
        if source.loaded.lines.get(index).is_none_or(|line| line.flow_segment > MOST_ROWS) {
            continue;
        }
        let sweep = sweep_line(source, index, None, Range::default(), plan.settings.step_us)?;
        let Some(sweep) = sweep else { continue };
        let points = if stabilised { &sweep.spectrum.stabilised } else { &sweep.spectrum.plain };
        if let Some(worst) = worst(points).filter(|worst| worst.radius >= 1.0) {
            warnings.push(format!(
                "line `{id}` is unstable with `{}` at {}: spectral radius {:.4} at {} = {:.3}",
                method.name(),
                Duration::from_us(u64::from(plan.settings.step_us)),
                worst.radius,
                sweep.moving.name,
                worst.value
            ));
        }
    }
    Ok(warnings)
}
