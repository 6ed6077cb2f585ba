//! The report of a run for people.

use std::collections::HashMap;
use std::io::{self, Write};

use eclss_core::signal::{Display, Shown};
use eclss_network_file::{Loaded, Names};

use super::{ById, GUARD, RunReport, Snapshot, TOLD_BELOW};

/// Writes the report.
pub fn write_table(out: &mut dyn Write, loaded: &Loaded, report: &RunReport) -> io::Result<()> {
    writeln!(out, "network     {}", report.network)?;
    writeln!(out, "network id  {}", report.network_id)?;
    writeln!(out, "method      {}, step {} ms, f32", report.method, report.step_s * 1e3)?;
    for snapshot in &report.at {
        writeln!(out)?;
        write_snapshot(out, &loaded.names, snapshot, loaded)?;
    }
    let worst = &report.end.worst;
    writeln!(out, "\nworst of all {} steps", report.end.tick)?;
    writeln!(out, "  smallest φ        {}", part(worst.phi_min))?;
    if let Some(slowed) = &report.slowed {
        writeln!(
            out,
            "  slowed            node `{}`, φ {} at {} s, as if its volume were {:.3} times as large; φ below \
             {TOLD_BELOW} in {} steps",
            slowed.node,
            part(slowed.phi),
            slowed.t_s,
            1.0 / slowed.phi,
            slowed.ticks
        )?;
        writeln!(out, "                    its transients are not physics: take an implicit method")?;
    }
    writeln!(out, "  spectral bound    {}", bound(worst.spectral_bound))?;
    writeln!(out, "  weakest proof     {}", worst.proof)?;
    writeln!(
        out,
        "  without a proof   {} steps, {} of them without the guard `short step` as well",
        worst.guarded_ticks + worst.unproven_ticks,
        worst.unproven_ticks
    )?;
    if worst.guarded_ticks > 0 {
        writeln!(out, "  {GUARD}")?;
    }
    if report.pseudo_time {
        writeln!(out, "\nTransients of this method are pseudo-time, not physics; its states of rest are.")?;
    }
    if !report.breaches.is_empty() {
        writeln!(out, "\nlimits broken (see docs/theory.md for their sources)")?;
    }
    for breach in &report.breaches {
        writeln!(
            out,
            "  {}: {}, first at {} s, for {:.0} s in all",
            breach.node, breach.limit, breach.first_s, breach.broken_s
        )?;
    }
    if let Some(diverged) = &report.diverged {
        let element = diverged.element.as_ref().map_or(String::new(), |id| format!(" (element `{id}`)"));
        writeln!(
            out,
            "\nDIVERGED at {} s, step {}: {} `{}`{element} left its range: {}. Nothing after that is reported.",
            diverged.t_s, diverged.tick, diverged.kind, diverged.id, diverged.what
        )?;
    }
    Ok(())
}

fn write_snapshot(out: &mut dyn Write, names: &Names, at: &Snapshot, loaded: &Loaded) -> io::Result<()> {
    writeln!(out, "t = {} s, step {}", at.t_s, at.tick)?;
    writeln!(
        out,
        "  φ {}, spectral bound {}, proof {}, state hash {}",
        part(at.phi_min),
        bound(at.spectral_bound),
        at.proof,
        at.state_hash
    )?;
    let room = names.nodes.iter().chain(&names.lines).chain(&names.segments).chain(&names.inputs);
    let climate = at.climate.0.iter().map(|(id, _)| id);
    let room = room.chain(climate).map(|id| id.chars().count()).max().unwrap_or(0).max(6) + 2;
    writeln!(out, "  {:<room$} {:>14} {:>16} {:>14}", "", "flow [g/s]", "absolute [Pa]", "gauge [Pa]")?;
    for id in &names.nodes {
        row(out, at, id, id, room)?;
    }
    let mut segments = names.segments.iter();
    for (id, line) in names.lines.iter().zip(&loaded.lines) {
        row(out, at, id, id, room)?;
        for id in segments.by_ref().take(line.segments as usize) {
            row(out, at, id, &format!("  {id}"), room)?;
        }
    }
    for (id, value) in &at.inputs.0 {
        writeln!(out, "  {id:<room$} {value:>14}")?;
    }
    let displays: HashMap<_, _> =
        loaded.signals().into_iter().map(|named| (named.name, named.spec.display)).collect();
    for (id, value) in &at.climate.0 {
        let Shown { unit, datum, factor, offset } =
            displays.get(id).map_or(Display::Number, |display| *display).shown();
        let shown = f64::from(*value) * factor + offset;
        writeln!(
            out,
            "  {id:<room$} {shown:>14.4} {unit}{}{datum}",
            if datum.is_empty() { "" } else { " " }
        )?;
    }
    for ledger in &at.ledgers {
        let gap = ledger.held - ledger.supplied;
        writeln!(
            out,
            "  ledger of {:<width$} supplied {:>16.6} {unit}, turned over {:>16.6} {unit}, not closed {gap:>10.1e} {unit}",
            ledger.name,
            ledger.supplied,
            ledger.turned_over,
            unit = ledger.unit,
            width = room.saturating_sub(10)
        )?;
    }
    Ok(())
}

fn row(out: &mut dyn Write, at: &Snapshot, id: &str, shown: &str, room: usize) -> io::Result<()> {
    write!(out, "  {shown:<room$}")?;
    match find(&at.flows_kg_s, id) {
        Some(flow) => write!(out, " {:>14.6}", f64::from(flow) * 1e3)?,
        None => write!(out, " {:>14}", "")?,
    }
    match (find(&at.pressures_pa, id), find(&at.gauge_pa, id)) {
        (Some(pressure), Some(gauge)) => writeln!(out, " {pressure:>16.4} {gauge:>14.4}"),
        _ => writeln!(out),
    }
}

/// A bound of the spectral radius, where there is one.
pub(crate) fn bound(value: f32) -> String {
    if value.is_nan() { "–".to_owned() } else { value.to_string() }
}

/// A number of 0…1 in a form that is short for very small ones as well.
pub(crate) fn part(value: f32) -> String {
    if value < 1e-3 { format!("{value:.3e}") } else { format!("{value:.6}") }
}

fn find<V: Copy>(list: &ById<V>, id: &str) -> Option<V> {
    list.0.iter().find(|(name, _)| name == id).map(|(_, value)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_that_does_not_exist_is_a_dash() {
        assert_eq!((bound(f32::NAN).as_str(), bound(0.5).as_str()), ("–", "0.5"));
    }
}
