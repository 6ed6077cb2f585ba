//! Stability of any network's lines over any input's range.

mod table;

pub use table::write_stability;

use eclss_core::{Element, InputSpec};

use crate::linear::{Moving, Spectrum};
use crate::{Failure, Source};

/// Values of a sweep.
const POINTS: usize = 99;
/// Rows of a line's matrix up to which eigenvalues are computed; the work grows with the third power.
pub const MOST_ROWS: u32 = 200;
/// Smallest value from which an input is swept when nothing else is asked: a passage nearly closed.
const NEARLY_CLOSED: f32 = 0.02;

/// What to sweep, as far as it is said.
#[derive(Debug, Clone, Copy, Default)]
pub struct Range {
    /// First value.
    pub from: Option<f64>,
    /// Last value.
    pub to: Option<f64>,
}

/// One line under one moving input.
#[derive(Debug, Clone)]
pub struct LineStability {
    /// Id of the line.
    pub line: String,
    /// The input.
    pub moving: Moving,
    /// What was found.
    pub spectrum: Spectrum,
}

/// An input of an element of a line.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    slot: usize,
    spec: InputSpec,
    on_flow_element: bool,
}

/// Inputs of a line's elements.
fn candidates(source: &Source, line: usize) -> Vec<Candidate> {
    let network = source.loaded.network();
    let Some(description) = network.lines.get(line) else { return Vec::new() };
    let mut list = Vec::new();
    for (place, segment) in (0u32..).zip(network.segments_of(description)) {
        let specs = (0..).map_while(|index| segment.element.input_spec(index));
        // A fault's code has no range to sweep: what lies between two codes is nothing.
        for (slot, spec) in (segment.first_input as usize..).zip(specs).filter(|(_, spec)| !spec.is_code()) {
            list.push(Candidate { slot, spec, on_flow_element: place == description.flow_segment });
        }
    }
    list
}

/// Sweeps one line. With `input` that one moves, else the one of the line's stiffest element, else any of the
/// line; a line without inputs has nothing to sweep and gives `None`.
pub fn sweep_line(
    source: &Source,
    line: usize,
    input: Option<&str>,
    range: Range,
    step_us: u32,
) -> Result<Option<LineStability>, Failure> {
    let names = &source.loaded.names;
    let list = candidates(source, line);
    let name = |candidate: &Candidate| names.inputs.get(candidate.slot).map_or("?", String::as_str);
    let chosen = match input {
        Some(input) => list.iter().find(|candidate| name(candidate) == input),
        None => list.iter().find(|candidate| candidate.on_flow_element).or(list.first()),
    };
    let Some(chosen) = chosen else { return Ok(None) };
    let id = names.lines.get(line).cloned().unwrap_or_default();
    let rows = source.loaded.lines.get(line).map_or(0, |line| line.flow_segment);
    if rows > MOST_ROWS {
        let text = format!("line `{id}` has {rows} rows before its flow row; eigenvalues are computed up to");
        return Err(Failure::BadInput(format!("{}: {text} {MOST_ROWS}", source.name)));
    }
    let (low, high) = (f64::from(chosen.spec.min), f64::from(chosen.spec.max));
    let from = range.from.unwrap_or(f64::from(chosen.spec.min.max(NEARLY_CLOSED)).min(high));
    let to = range.to.unwrap_or(high);
    if !(low <= from && from < to && to <= high) {
        let text = format!("`{}` moves within {low} … {high}, not from {from} to {to}", name(chosen));
        return Err(Failure::BadInput(text));
    }
    // An f32 such as 0.02 is shown as it was meant.
    let from = if range.from.is_none() { (from * 1e6).round() / 1e6 } else { from };
    let network = source.loaded.network();
    let spectrum = Spectrum::compute(&network, line, chosen.slot, step_us, (from, to, POINTS));
    let spectrum = spectrum.ok_or_else(|| {
        Failure::Failed(format!("line `{id}`: its eigenvalues cannot be computed in this range"))
    })?;
    let moving = Moving { name: name(chosen).to_owned(), unit: chosen.spec.unit.to_owned(), factor: 1.0 };
    Ok(Some(LineStability { line: id, moving, spectrum }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Valves that act by themselves take a fault's code and nothing else: there is nothing to sweep.
    #[test]
    fn no_code_of_a_fault_is_swept() {
        let valve = "\n[[line]]\nid = \"back\"\nfrom = \"node1\"\nto = \"lab\"\n\n[[line.element]]\nid = \"check\"\nkind = \
                     \"check_valve\"\nresistance_pa_s2_kg2 = 300.0\nreverse_leak_kg_s = 0.0005\nreverse_pressure_pa = 300.0\n";
        let text = [include_str!("../tests/two_cabins.toml"), valve].concat();
        let source = Source::text(text.as_bytes(), "two_cabins.toml", "two cabins".into()).unwrap();
        let network = source.loaded.network();
        let mut codes = 0;
        for (line, description) in network.lines.iter().enumerate() {
            for segment in network.segments_of(description) {
                codes += (0..)
                    .map_while(|index| segment.element.input_spec(index))
                    .filter(InputSpec::is_code)
                    .count();
            }
            assert!(
                candidates(&source, line).iter().all(|candidate| !candidate.spec.is_code()),
                "line {line}"
            );
        }
        assert!(codes > 0, "there are some");
    }
}
