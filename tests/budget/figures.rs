//! Figures that the measuring program reports.

use crate::emulator::{self, Run};

/// Instructions of one thing that was measured many times.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Figure {
    /// `law`, `paper`, `paper-loaded`, `thcs`, `thcs-loaded`, or a large network.
    pub(crate) kind: String,
    /// The component or method.
    pub(crate) name: String,
    /// How often it was measured.
    pub(crate) samples: u32,
    /// Fewest instructions.
    pub(crate) min: u32,
    /// Mean.
    pub(crate) mean: f64,
    /// Most.
    pub(crate) max: u32,
}

impl Figure {
    /// Reads `INFO  KIND NAME SAMPLES MIN SUM MAX`.
    fn read(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, kind, name, samples, min, sum, max] = words.as_slice() else { return None };
        let samples: u32 = samples.parse().ok()?;
        let sum: f64 = sum.parse().ok()?;
        let mean = sum / f64::from(samples);
        let (min, max) = (min.parse().ok()?, max.parse().ok()?);
        Some(Self { kind: (*kind).into(), name: (*name).into(), samples, min, mean, max })
    }

    /// Largest over mean.
    pub(crate) fn spread(&self) -> f64 {
        f64::from(self.max) / self.mean
    }
}

/// Everything that is counted on one board.
pub(crate) fn measure(machine: &str) -> Vec<Figure> {
    let runs =
        [emulator::measure(machine, &["figures=all"]), emulator::measure_day(machine, &["figures=all"])];
    for run in &runs {
        assert!(run.status.success(), "{}", run.log.join("\n"));
    }
    runs.iter().flat_map(|run| &run.log).filter_map(|line| Figure::read(line)).collect()
}

/// The whole tick of a board's firmware over the paper's scenario [instructions], and its worst stack [bytes].
pub(crate) fn firmware(machine: &str) -> ([f64; 3], u64) {
    let run = emulator::run(machine, &["seconds=26"]);
    assert!(run.status.success(), "{}", run.log.join("\n"));
    let stack = run.after("stack ")[0].parse().expect("bytes");
    (last_tick(&run), stack)
}

/// Smallest, mean and largest of the last `tick A/B/C counts`; a count is 40 ns, an instruction 32 ns.
fn last_tick(run: &Run) -> [f64; 3] {
    let line = run.log.iter().rev().find(|line| line.contains(" counts, ") && line.contains("tick "));
    let words: Vec<&str> = line.expect("a status").split_whitespace().collect();
    let mut counts = words[2].split('/').map(|count| 1.25 * count.parse::<f64>().expect("counts"));
    [(); 3].map(|()| counts.next().expect("three of them"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_figure_or_none() {
        let figure = Figure::read("INFO  paper adaptive 4 10 50 20").expect("a figure");
        assert_eq!((figure.samples, figure.min, figure.max), (4, 10, 20));
        assert!((figure.mean - 12.5).abs() < 1e-12 && (figure.spread() - 1.6).abs() < 1e-12);
        assert_eq!(Figure::read("INFO  run paper euler 10931 c65c00ef643e5e4a bfb2f6cedce04e99"), None);
    }
}
