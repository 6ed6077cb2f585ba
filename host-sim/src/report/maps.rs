//! Stability maps: spectral radius over opening and step.

use super::html::Html;
use crate::linear::{Spectrum, SweepPoint};
use crate::plot::style::{self, Colour};
use crate::plot::{Axis, ColourScale, Dots, Figure, Mark, Panel, Point};
use crate::{Failure, Source};

/// Smallest and largest step [µs].
const STEPS_US: (f64, f64) = (100.0, 10_000.0);
/// Openings.
const OPENINGS: (f64, f64) = (0.02, 1.0);
/// Radius that has the last colour: what lies above grows tenfold a step.
const MOST: f64 = 10.0;

/// Writes the section.
pub(super) fn write(
    page: &mut Html,
    source: &Source,
    (openings, steps): (usize, usize),
) -> Result<(), Failure> {
    page.section("Stability maps");
    let network = source.loaded.network();
    let valve = source.loaded.names.inputs.iter().position(|name| name == "valve.opening");
    let valve = valve.ok_or_else(|| Failure::Failed("the paper's network has lost its valve".into()))?;
    let factor = (STEPS_US.1 / STEPS_US.0).powf(1.0 / (steps.max(2) - 1) as f64);
    let mut spectra = Vec::new();
    for index in 0..steps.max(2) {
        let step_us = (STEPS_US.0 * factor.powf(index as f64)).round() as u32;
        let range = (OPENINGS.0, OPENINGS.1, openings);
        let found = Spectrum::compute(&network, 0, valve, step_us, range);
        spectra
            .push(found.ok_or_else(|| Failure::Failed("the eigenvalue iteration did not converge".into()))?);
    }
    let about = "Spectral radius of one explicit step of the paper's loop over valve opening and step. Without φ the \
                 dark part is stable; with φ every point is.";
    let figure = Figure {
        title: "Where one explicit step is stable: spectral radius ρ".into(),
        panels: vec![map("without φ", &spectra, |s| &s.plain), map("with φ", &spectra, |s| &s.stabilised)],
        columns: 2,
        panel_size: (540, 420),
        remarks: vec![format!("Crosses lie outside the unit disc. Radii above {MOST} have the last colour.")],
    };
    page.figure(
        &figure.svg(),
        about,
        "eclss-rt report; one row of it: eclss-rt stability networks/paper.toml --step 1ms",
    );
    let outside = |of: fn(&Spectrum) -> &[SweepPoint]| {
        spectra.iter().flat_map(of).filter(|point| point.radius >= 1.0).count()
    };
    page.paragraph(&format!(
        "Of {} points {} are unstable without φ and {} with it.",
        spectra.iter().map(|spectrum| spectrum.plain.len()).sum::<usize>(),
        outside(|spectrum| &spectrum.plain),
        outside(|spectrum| &spectrum.stabilised)
    ));
    Ok(())
}

fn map(title: &str, spectra: &[Spectrum], of: fn(&Spectrum) -> &[SweepPoint]) -> Panel {
    let across = Axis::linear("opening [%]", 0.0, 102.0);
    let mut panel = Panel::new(title, across, Axis::logarithmic("step [ms]", 0.085, 11.8));
    let points = |keep: fn(f64) -> bool| -> Vec<(Point, Colour)> {
        let all = spectra.iter().flat_map(|spectrum| {
            let step_ms = f64::from(spectrum.step_us) * 1e-3;
            of(spectrum).iter().map(move |point| ((point.value * 100.0, step_ms), point.radius))
        });
        all.filter(|(_, radius)| keep(*radius))
            .map(|(at, radius)| (at, style::scale(place(radius))))
            .collect()
    };
    panel.dots.push(Dots {
        label: "stable".into(),
        mark: Mark::Disc,
        radius: 3.6,
        points: points(|r| r < 1.0),
    });
    panel.dots.push(Dots {
        label: "unstable".into(),
        mark: Mark::Cross,
        radius: 3.6,
        points: points(|r| r >= 1.0),
    });
    panel.colours = Some(ColourScale { label: "ρ [1]".into(), from: 0.0, to: MOST });
    panel
}

/// Part of the colour scale.
fn place(radius: f64) -> f64 {
    (radius / MOST).min(1.0)
}
