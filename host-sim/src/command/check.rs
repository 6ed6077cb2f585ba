//! `eclss-rt check`: what is in a network file, and what to watch.

use std::io::Write;
use std::path::Path;

use eclss_core::{Method, NodeKind, Proof};
use eclss_network_file::{Loaded, leaks_to_space, unrest};

use crate::args::CheckArgs;
use crate::coupling::{self, Causality, Coupling};
use crate::linear::{LineModel, eigenvalues, spectral_radius, worst};
use crate::output::write_text;
use crate::refusal::refused;
use crate::run::{GUARD, Plan, Wishes, bound, part, proof};
use crate::stability::{MOST_ROWS, Range, sweep_line};
use crate::{Failure, HostBuffers, Source};

/// How far beyond 1 an eigenvalue may lie for its rounding alone.
const ROUNDING: f64 = 1e-9;

/// Most leaks that are listed.
const MOST_LEAKS: usize = 10;
/// Share of the air that may leave for space in a day without a warning [1]: the station's hull is specified for 0.02 %.
const NOTICEABLE_A_DAY: f64 = 1e-3;

/// Reads, checks, summarises.
pub(super) fn run(args: &CheckArgs, out: &mut dyn Write) -> Result<(), Failure> {
    if let Some(path) = args.save.as_deref().filter(|path| same_file(path, &args.network)) {
        let text = "is the file that is checked; --save needs another one";
        return Err(Failure::BadInput(format!("{}: {text}", path.display())));
    }
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
    let mut warnings = write_margins(out, &source, &plan)?;
    warnings.extend(write_leaks(out, loaded)?);
    let mut refusals = Vec::new();
    if args.hil {
        let coupling = coupling::examine(loaded, plan.settings, args.extra_delay);
        write_coupling(out, &coupling)?;
        warnings.extend(coupling.warnings);
        refusals = coupling.refusals;
    }
    writeln!(out)?;
    for found in unrest(loaded) {
        let text = source.at(found.line, &found.reason);
        // That pressures go on falling or rising may be meant.
        if found.drifts {
            writeln!(out, "note: {text}")?;
        } else {
            warnings.push(text);
        }
    }
    for warning in &warnings {
        writeln!(out, "warning: {warning}")?;
    }
    if let Some(path) = &args.save {
        write_text(path, &loaded.file.to_toml())?;
        writeln!(out, "written: {}", path.display())?;
    }
    for refusal in &refusals {
        writeln!(out, "refused: {refusal}")?;
    }
    if !refusals.is_empty() {
        return Err(Failure::Reported);
    }
    writeln!(out, "good, {} warnings", warnings.len())?;
    Ok(())
}

/// Flow to space at the start, with a warning where it is a noticeable part of the air.
fn write_leaks(out: &mut dyn Write, loaded: &Loaded) -> Result<Option<String>, Failure> {
    let leaks = leaks_to_space(&loaded.network(), &loaded.inputs);
    if leaks.lines.is_empty() {
        return Ok(None);
    }
    let sum = leaks.kg_d();
    writeln!(out, "to space    {sum:.3e} kg/d at the start, of {:.3} kg in cabins", leaks.held_kg)?;
    for (line, kg_d) in leaks.lines.iter().take(MOST_LEAKS) {
        writeln!(
            out,
            "  {}: {kg_d:.3e} kg/d",
            loaded.names.lines.get(*line as usize).map_or("?", String::as_str)
        )?;
    }
    if leaks.lines.len() > MOST_LEAKS {
        writeln!(out, "  and {} more", leaks.lines.len() - MOST_LEAKS)?;
    }
    let share = sum / leaks.held_kg;
    let most = leaks.lines.first().and_then(|(line, _)| loaded.names.lines.get(*line as usize));
    Ok((share > NOTICEABLE_A_DAY).then(|| {
        format!(
            "{sum:.3e} kg/d leave for space, {:.2} % of the air a day, most through line `{}`",
            100.0 * share,
            most.map_or("?", String::as_str)
        )
    }))
}

/// Every pair of bound signals with its margin.
fn write_coupling(out: &mut dyn Write, coupling: &Coupling) -> Result<(), Failure> {
    writeln!(out, "coupling    h·c·G against what the delay of the loop allows")?;
    for pair in &coupling.pairs {
        let outputs = if pair.outputs.is_empty() { "no output".to_owned() } else { pair.outputs.join(", ") };
        write!(out, "  {} ← {outputs}: ", pair.input)?;
        match (pair.causality, pair.gain, pair.limit, pair.margin) {
            (Causality::PressureOutFlowIn, Some(gain), Some(limit), Some(margin)) => writeln!(
                out,
                "pressure out, flow in; delay {:.2} ticks, h·c·G {gain:.4}, limit {limit:.4}, margin {margin:.3}",
                pair.delay_ticks
            )?,
            _ => writeln!(
                out,
                "signal; delay {:.2} ticks; stores nothing, its loop is the controller's",
                pair.delay_ticks
            )?,
        }
    }
    if let (Some(gain), Some(margin)) = (coupling.gain_together, coupling.margin_together) {
        writeln!(out, "  all measured lines together: h·c·G {gain:.4}, margin {margin:.3}")?;
    }
    Ok(())
}

/// Whether both paths lead to one file that exists.
fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn write_contents(out: &mut dyn Write, source: &Source) -> Result<(), Failure> {
    let loaded = &source.loaded;
    let names = &loaded.names;
    writeln!(out, "\nnodes       {}", names.nodes.len())?;
    for (id, node) in names.nodes.iter().zip(&loaded.nodes) {
        let kind = match node.kind {
            NodeKind::Cabin { volume_m3 } => format!("cabin, {volume_m3} m³"),
            NodeKind::Liquid { capacity_kg_pa } => format!("liquid, {capacity_kg_pa:e} kg/Pa"),
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
    let mut guarded = false;
    writeln!(out, "margins     at rest with the inputs of the start, ends held")?;
    for (index, id) in source.loaded.names.lines.iter().enumerate() {
        let Some(model) = LineModel::new(&network, index, network.inputs) else {
            writeln!(out, "  {id}: not examined")?;
            continue;
        };
        let flow = model.steady_flow_kg_s();
        let phi = if stabilised { model.phi(flow, step_s) } else { 1.0 };
        let margin = model.margin(flow, step_s, phi);
        writeln!(
            out,
            "  {id}: {:.6} g/s, φ {}, spectral bound {}, proof {}",
            // Rest is 0, whichever side the search came from.
            (flow * 1e9).round() / 1e6 + 0.0,
            part(margin.phi),
            bound(margin.spectral_bound),
            proof(margin.proof)
        )?;
        guarded |= margin.proof == Proof::ShortStep;
        let with = format!("with `{}` at {}", method.name(), plan.step());
        let rows = source.loaded.lines.get(index).map_or(0, |line| line.flow_segment);
        let few = rows <= MOST_ROWS;
        if margin.spectral_bound > 1.0 {
            let found = if few { eigenvalues(&model.step_matrix(flow, step_s, phi)) } else { None };
            let shown = bound(margin.spectral_bound);
            match found.map(|values| spectral_radius(&values)) {
                Some(radius) if radius <= 1.0 + ROUNDING => {}
                Some(radius) => {
                    let text = format!("spectral radius {radius:.4}, bound {shown}");
                    warnings.push(format!("line `{id}` is unstable at rest {with}: {text}"));
                }
                None => warnings.push(format!(
                    "line `{id}` is not proven stable at rest {with}: spectral bound {shown}, eigenvalues \
                     not examined"
                )),
            }
        }
        if !few {
            writeln!(
                out,
                "    eigenvalues not examined: {rows} rows before its flow row, at most {MOST_ROWS}"
            )?;
            continue;
        }
        let sweep = sweep_line(source, index, None, Range::default(), plan.settings.step_us)?;
        let Some(sweep) = sweep else {
            writeln!(out, "    range not examined: no input moves it")?;
            continue;
        };
        let points = if stabilised { &sweep.spectrum.stabilised } else { &sweep.spectrum.plain };
        if let Some(worst) = worst(points).filter(|worst| worst.radius >= 1.0) {
            warnings.push(format!(
                "line `{id}` is unstable {with}: spectral radius {:.4} at {} = {:.3}",
                worst.radius, sweep.moving.name, worst.value
            ));
        }
    }
    if guarded {
        writeln!(out, "  {GUARD}")?;
    }
    Ok(warnings)
}
