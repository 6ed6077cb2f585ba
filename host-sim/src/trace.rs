//! What a run writes down: chosen figures at every so many ticks.

use std::io::{self, Write};

use eclss_core::signal::Owner;
use eclss_core::{Element, Health, Signal, Simulator};
use eclss_network_file::{Loaded, NamedSignal};

use crate::plot::Point;

/// Record of a run of `loaded`: the signals that its file chose, followed by the figures of the run itself.
pub fn columns(loaded: &Loaded) -> Vec<NamedSignal> {
    let mut columns = loaded.records.clone();
    let of_run = |named: &NamedSignal| named.signal.output.owner() == Owner::Run;
    let missing = |named: &NamedSignal| loaded.records.iter().all(|other| other.signal != named.signal);
    columns.extend(loaded.standard_signals().into_iter().filter(of_run).filter(missing));
    columns
}

/// Figures over time.
#[derive(Debug, Clone)]
pub struct Trace {
    columns: Vec<NamedSignal>,
    signals: Vec<Signal>,
    every: u64,
    times_us: Vec<u64>,
    values: Vec<f32>,
}

impl Trace {
    /// An empty record of `columns` at every `every` ticks.
    pub fn new(columns: Vec<NamedSignal>, every: u64) -> Self {
        let signals = columns.iter().map(|column| column.signal).collect();
        Self { columns, signals, every: every.max(1), times_us: Vec::new(), values: Vec::new() }
    }

    /// Whether a row would be written now.
    pub fn is_due<E: Element>(&self, simulator: &Simulator<'_, E>) -> bool {
        simulator.tick() % self.every == 0 || simulator.health() != Health::Trusted
    }

    /// Writes the present figures down if it is their time, or if the run has just left its range.
    pub fn note<E: Element>(&mut self, simulator: &Simulator<'_, E>) {
        if self.is_due(simulator) && self.times_us.last() != Some(&simulator.time_us()) {
            self.times_us.push(simulator.time_us());
            let first = self.values.len();
            self.values.resize(first + self.signals.len(), f32::NAN);
            simulator.read_signals(&self.signals, &mut self.values[first..]);
        }
    }

    /// The columns.
    pub fn columns(&self) -> &[NamedSignal] {
        &self.columns
    }

    /// Times [s] and values of a column, multiplied by `factor`; empty for a column that does not exist.
    pub fn curve(&self, column: usize, factor: f64) -> Vec<Point> {
        let values = self.values.iter().skip(column).step_by(self.columns.len().max(1));
        let times = self.times_us.iter().map(|time| *time as f64 * 1e-6);
        times.zip(values.map(|value| f64::from(*value) * factor)).collect()
    }

    /// Writes comma-separated values with a line of names; time in seconds without rounding.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "t_s")?;
        for column in &self.columns {
            write!(out, ",{}", column.column())?;
        }
        writeln!(out)?;
        let rows = self.values.chunks(self.columns.len().max(1));
        for (time_us, row) in self.times_us.iter().zip(rows) {
            write!(out, "{}.{:06}", time_us / 1_000_000, time_us % 1_000_000)?;
            for value in row {
                // What is no number stays empty: not every method has a bound, and a run may end with such a value.
                if value.is_finite() {
                    write!(out, ",{value}")?;
                } else {
                    write!(out, ",")?;
                }
            }
            writeln!(out)?;
        }
        out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HostBuffers;
    use eclss_core::{Method, Output, Settings, example};

    #[test]
    fn the_csv_has_one_row_per_note_and_exact_times() {
        let network = example::paper_loop();
        let mut buffers = HostBuffers::default();
        let settings = Settings { method: Method::Relaxation, step_us: 100 };
        let mut simulator = buffers.simulator(&network, settings).unwrap();
        let signal = Output::MassFlow.of(0);
        let column = NamedSignal { name: "valve.mass_flow".into(), signal, spec: signal.spec() };
        let mut trace = Trace::new(vec![column], 5);
        trace.note(&simulator);
        for _ in 0..10 {
            simulator.step();
            trace.note(&simulator);
        }
        let mut csv = Vec::new();
        trace.write_csv(&mut csv).unwrap();
        let csv = String::from_utf8(csv).unwrap();
        let lines: Vec<_> = csv.lines().collect();
        assert_eq!(lines[..2], ["t_s,valve.mass_flow_kg_s", "0.000000,0.001"]);
        assert!(lines.len() == 4 && lines[2].starts_with("0.000500,") && lines[3].starts_with("0.001000,"));
        assert_eq!(trace.curve(0, 1e3).len(), 3);
    }
}
