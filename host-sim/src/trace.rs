//! What a run writes down: chosen figures at every so many ticks.

use std::io::{self, Write};

use eclss_core::{Element, Health, Simulator};
use eclss_network_file::{AirFigure, ExchangerFigure, Quantity, Record};

use crate::plot::Point;

/// A figure of a running simulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// A recorded point of the network file.
    Point(Quantity),
    /// Smallest φ of the last step [1].
    Phi,
    /// Bound of the spectral radius of the last step [1].
    SpectralBound,
}

/// Flow at the inlet [kg/s] and gauge pressure at the outlet [Pa] of every segment, read line by line: one by one
/// it would take a walk along the line for each.
#[derive(Debug, Clone)]
pub struct Segments(Vec<(f32, f32)>);

impl Segments {
    /// Reads them all.
    pub fn of<E: Element>(simulator: &Simulator<'_, E>) -> Self {
        let network = simulator.network();
        let mut all = Self(vec![(f32::NAN, f32::NAN); network.segments.len()]);
        all.read(simulator);
        all
    }

    /// Reads them all again, without allocating; of the same network as before.
    pub fn read<E: Element>(&mut self, simulator: &Simulator<'_, E>) {
        for line in 0..simulator.network().lines.len() {
            simulator.read_line(line, |segment, flow, outlet| {
                if let Some(place) = self.0.get_mut(segment) {
                    *place = (flow, outlet);
                }
            });
        }
    }
}

impl Figure {
    /// Reads the figure.
    pub fn read<E: Element>(self, simulator: &Simulator<'_, E>, segments: &Segments) -> f32 {
        // Files count segments by line, the core over all lines.
        let of = |line: usize, segment: usize| {
            let first = simulator.network().lines.get(line).map_or(0, |line| line.first_segment as usize);
            segments.0.get(first + segment).copied().unwrap_or((f32::NAN, f32::NAN))
        };
        match self {
            Self::Point(Quantity::NodePressure { node }) => simulator.node_gauge_pa(node),
            Self::Point(Quantity::LineFlow { line }) => simulator.line_flow_kg_s(line),
            Self::Point(Quantity::SegmentFlow { line, segment }) => of(line, segment).0,
            Self::Point(Quantity::OutletPressure { line, segment }) => of(line, segment).1,
            Self::Point(Quantity::Air { node, figure }) => read_air(simulator, node, figure),
            Self::Point(Quantity::Exchanger { exchanger, figure }) => {
                let Some(shown) = simulator.exchanger(exchanger) else { return f32::NAN };
                match figure {
                    ExchangerFigure::Heat => shown.heat_w,
                    ExchangerFigure::CoolantHeat => shown.coolant_w,
                    ExchangerFigure::Condensate => shown.condensate_kg_s,
                    ExchangerFigure::AirOutlet => shown.air_outlet_k,
                    ExchangerFigure::Film => shown.film_kg,
                    ExchangerFigure::Separator => shown.separator_kg,
                    ExchangerFigure::Tank => shown.tank_kg,
                }
            }
            Self::Point(Quantity::Input { slot, .. }) => {
                simulator.inputs().get(slot).copied().unwrap_or(f32::NAN)
            }
            Self::Phi => simulator.margin().phi,
            Self::SpectralBound => simulator.margin().spectral_bound,
        }
    }
}

fn read_air<E: Element>(simulator: &Simulator<'_, E>, node: usize, figure: AirFigure) -> f32 {
    if figure == AirFigure::Temperature {
        return simulator.node_temperature_k(node);
    }
    let Some(air) = simulator.air(node) else { return f32::NAN };
    match figure {
        AirFigure::Temperature => air.temperature_k,
        AirFigure::DewPoint => air.dew_point_k,
        AirFigure::RelativeHumidity => air.relative_humidity,
        AirFigure::Partial(part) => air.partial_pa.get(part).copied().unwrap_or(f32::NAN),
        AirFigure::Liquid => air.liquid_kg,
        AirFigure::Mixed => f32::from(u8::from(air.mixed)),
    }
}

/// A figure with the name of its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name with unit, as in `valve.flow_kg_s`.
    pub name: String,
    /// The figure.
    pub figure: Figure,
}

impl Column {
    /// The column of a recorded point.
    pub fn of(record: &Record) -> Self {
        let unit = match record.quantity {
            Quantity::NodePressure { .. } | Quantity::OutletPressure { .. } => "_gauge_pa",
            Quantity::LineFlow { .. } | Quantity::SegmentFlow { .. } => "_kg_s",
            Quantity::Input { .. } => "",
            other => match other.unit() {
                "K" => "_k",
                "Pa" => "_pa",
                "W" => "_w",
                "kg" => "_kg",
                "kg/s" => "_kg_s",
                _ => "",
            },
        };
        Self { name: format!("{}{unit}", record.name), figure: Figure::Point(record.quantity) }
    }

    /// Columns of all `records`, then φ and the bound of the spectral radius.
    pub fn all(records: &[Record]) -> Vec<Self> {
        let mut columns: Vec<_> = records.iter().map(Self::of).collect();
        columns.push(Self { name: "phi".to_owned(), figure: Figure::Phi });
        columns.push(Self { name: "spectral_bound".to_owned(), figure: Figure::SpectralBound });
        columns
    }
}

/// Figures over time.
#[derive(Debug, Clone)]
pub struct Trace {
    columns: Vec<Column>,
    every: u64,
    times_us: Vec<u64>,
    values: Vec<f32>,
}

impl Trace {
    /// An empty record of `columns` at every `every` ticks.
    pub fn new(columns: Vec<Column>, every: u64) -> Self {
        Self { columns, every: every.max(1), times_us: Vec::new(), values: Vec::new() }
    }

    /// Whether a row would be written now.
    pub fn is_due<E: Element>(&self, simulator: &Simulator<'_, E>) -> bool {
        simulator.tick() % self.every == 0 || simulator.health() != Health::Trusted
    }

    /// Writes the present figures down if it is their time, or if the run has just left its range.
    pub fn note<E: Element>(&mut self, simulator: &Simulator<'_, E>) {
        if self.is_due(simulator) && self.times_us.last() != Some(&simulator.time_us()) {
            self.times_us.push(simulator.time_us());
            let segments = Segments::of(simulator);
            self.values.extend(self.columns.iter().map(|column| column.figure.read(simulator, &segments)));
        }
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
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
            write!(out, ",{}", column.name)?;
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
    use eclss_core::{Method, Settings, example};

    #[test]
    fn the_csv_has_one_row_per_note_and_exact_times() {
        let network = example::paper_loop();
        let mut buffers = HostBuffers::default();
        let settings = Settings { method: Method::Relaxation, step_us: 100 };
        let mut simulator = buffers.simulator(&network, settings).unwrap();
        let column =
            Column { name: "valve.flow_kg_s".into(), figure: Figure::Point(Quantity::LineFlow { line: 0 }) };
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
        assert_eq!(lines[..2], ["t_s,valve.flow_kg_s", "0.000000,0.001"]);
        assert!(lines.len() == 4 && lines[2].starts_with("0.000500,") && lines[3].starts_with("0.001000,"));
        assert_eq!(trace.curve(0, 1e3).len(), 3);
    }
}
