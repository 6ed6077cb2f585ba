//! `eclss-rt stability`: eigenvalues, Gershgorin discs and margins of any line over any input.

use std::io::Write;

use eclss_core::{BuildError, Method, Settings};

use crate::args::StabilityArgs;
use crate::linear::{disc_figure, eigenvalue_figure, radius_figure};
use crate::output::Folder;
use crate::refusal::refused;
use crate::run::{Plan, Wishes};
use crate::stability::{LineStability, Range, sweep_line, write_stability};
use crate::{Failure, Source};

/// Sweeps the asked lines, prints tables, writes CSV and plots.
pub(super) fn run(args: &StabilityArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let source = Source::open(args.network.as_deref())?;
    let step_us = Plan::step_us(&source, &Wishes { step: args.step, ..Wishes::default() })?;
    let settings = Settings { method: args.method.unwrap_or(source.loaded.run.method), step_us };
    if !crate::is_pseudo_time(settings.method) {
        return Err(Failure::BadInput(format!(
            "{}: eigenvalues are those of the relaxation system, which method `{}` does not step; --method relaxation \
             examines the network as if that ran it",
            source.name,
            settings.method.name()
        )));
    }
    // Plain Euler is looked at because it is unstable, and so is what the file does not run; what it runs and refuses the
    // step never takes it.
    if settings.method != Method::Euler && args.method.is_none() {
        let checked = settings.method.check(&source.loaded.network(), step_us);
        checked.map_err(|error| refused(&source, settings, &BuildError::Method(error)))?;
    }
    let names = &source.loaded.names;
    let known = |list: &[String], id: &str, what: &str| {
        if list.iter().any(|name| name == id) {
            return Ok(());
        }
        let text = format!("{}: no {what} `{id}`; there are {}", source.name, list.join(", "));
        Err(Failure::BadInput(text))
    };
    args.line.as_ref().map_or(Ok(()), |id| known(&names.lines, id, "line"))?;
    args.input.as_ref().map_or(Ok(()), |id| known(&names.inputs, id, "input"))?;

    let range = Range { from: args.from, to: args.to };
    let mut found = Vec::new();
    for (index, id) in names.lines.iter().enumerate() {
        if args.line.as_ref().is_none_or(|wanted| wanted == id) {
            found.extend(sweep_line(&source, index, args.input.as_deref(), range, step_us)?);
        }
    }
    writeln!(out, "network     {}", source.name)?;
    writeln!(out, "network id  {:016x}", source.loaded.network().id())?;
    writeln!(out, "method      {}", settings.method.name())?;
    if found.is_empty() {
        writeln!(
            out,
            "\nNone of the lines asked for has an element with that input: there is nothing to sweep."
        )?;
        return Ok(());
    }
    let folder = args.out.clone().unwrap_or_else(|| super::run::default_folder(&source));
    let folder = Folder::make(&folder)?;
    let mut files = Vec::new();
    for line in &found {
        writeln!(out)?;
        write_stability(out, line)?;
        let name = format!("stability_{}", line.line);
        files.push(folder.file(&format!("{name}.csv"), |file| write_csv(file, line))?);
        let remarks = || vec![format!("Line `{}` of {}, its ends held.", line.line, source.name)];
        let spectrum = &line.spectrum;
        let eigenvalues = eigenvalue_figure(spectrum, &line.moving, remarks());
        files.push(folder.text(&format!("{name}_eigenvalues.svg"), &eigenvalues.svg())?);
        let radius = radius_figure(&[spectrum], &line.moving, remarks());
        files.push(folder.text(&format!("{name}_radius.svg"), &radius.svg())?);
        let mut about_discs = remarks();
        about_discs.push(
            "Discs of the balanced matrix. Inside the unit circle they prove stability; outside they".into(),
        );
        about_discs.push("prove nothing, and the eigenvalues themselves decide.".into());
        let discs = disc_figure(spectrum, &line.moving, about_discs);
        files.push(folder.text(&format!("{name}_discs.svg"), &discs.svg())?);
    }
    super::list_files(out, &files)
}

fn write_csv(file: &mut impl Write, line: &LineStability) -> std::io::Result<()> {
    writeln!(file, "value,flow_kg_s,phi,radius_without_phi,radius_with_phi,live_bound")?;
    for (plain, ours) in line.spectrum.plain.iter().zip(&line.spectrum.stabilised) {
        let bound = ours.margin.spectral_bound;
        let (value, flow, phi) = (ours.value, ours.flow_kg_s, ours.phi);
        writeln!(file, "{value},{flow},{phi},{},{},{bound}", plain.radius, ours.radius)?;
    }
    Ok(())
}
