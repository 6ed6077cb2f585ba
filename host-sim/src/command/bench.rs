//! `eclss-rt bench`: the paper's cost figure, measured here.

use std::io::{self, Write};

use eclss_bench::{PAPER_SIZES, Row, chain_costs};

use crate::args::BenchArgs;
use crate::output::Folder;
use crate::plot::style::{self, BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Axis, Curve, Dash, Dots, Figure, Mark, Panel, Point};
use crate::{Failure, Progress};

/// What the paper prints of its own machine, for comparison.
pub(crate) const PRINTED: &str =
    "The paper prints, for its own machine: explicit 0.54 to 0.76 ms, implicit 0.11 to 18 s a step.";

/// Measures, prints the table, writes CSV and plot.
pub(super) fn run(args: &BenchArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let sizes: Vec<usize> = if args.sizes.is_empty() {
        PAPER_SIZES.to_vec()
    } else {
        args.sizes.iter().map(|size| *size as usize).collect()
    };
    let folder = Folder::make(&args.out)?;
    let progress = Progress::new(sizes.len() as u64);
    let rows = chain_costs(&sizes, &mut |part| {
        progress.say(&format!("{} equations", part.equations));
        progress.set(part.done as u64);
    });
    progress.finish();
    let rows = rows.map_err(|failure| Failure::Failed(failure.to_string()))?;
    write_table(out, &rows)?;
    out.flush()?;
    let csv = folder.file("chains.csv", |file| write_csv(file, &rows))?;
    let svg = folder.text("chains.svg", &picture(&rows).svg())?;
    super::list_files(out, &[csv, svg])
}

fn write_table(out: &mut dyn Write, rows: &[Row]) -> io::Result<()> {
    writeln!(out, "Time per step of 1 ms on chains of n equations, one thread of this machine")?;
    writeln!(
        out,
        "{:>6}  {:<15} {:>14} {:>14} {:>14} {:>14} {:>10}",
        "n", "method", "median µs", "mean µs", "repeated µs", "worst µs", "× floor"
    )?;
    let mut n = 0;
    for row in rows {
        if row.n != n && n != 0 {
            writeln!(out)?;
        }
        n = row.n;
        let [median, mean, repeated, worst] =
            [row.median_ns, row.mean_ns, row.repeated_ns, row.worst_ns].map(|ns| ns * 1e-3);
        writeln!(
            out,
            "{:>6}  {:<15} {median:>14.3} {mean:>14.3} {repeated:>14.3} {worst:>14.3} {:>10.2}",
            row.n, row.method, row.ratio_to_floor
        )?;
    }
    writeln!(
        out,
        "\nfloor: one scalar square root and one division per equation over arrays of the same length."
    )?;
    writeln!(
        out,
        "mean, repeated: frames of the valve's closing, each with the fastest of its repeats, and the longest of \
         these."
    )?;
    writeln!(out, "worst: the longest frame of all repeats, interruptions by the operating system and all.")?;
    writeln!(out, "dense-newton: one implicit step with a dense matrix, the paper's baseline.")?;
    if !cfg!(feature = "peers") {
        writeln!(out, "For a modern variable-step solver beside them (minutes to build):")?;
        writeln!(out, "  cargo run --release -p eclss-host-sim --features peers -- bench")?;
    }
    writeln!(out, "{PRINTED}")
}

fn write_csv(file: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    writeln!(file, "n,method,median_ns,mean_ns,repeated_ns,worst_ns,ratio_to_floor")?;
    for row in rows {
        let Row { n, method, median_ns, mean_ns, repeated_ns, worst_ns, ratio_to_floor } = row;
        writeln!(file, "{n},{method},{median_ns},{mean_ns},{repeated_ns},{worst_ns},{ratio_to_floor}")?;
    }
    Ok(())
}

fn looks(method: &str) -> (style::Colour, Dash) {
    match method {
        "floor" => (BLACK, Dash::Dashed),
        "euler" => (GREEN, Dash::Dashed),
        "relaxation" => (BLUE, Dash::Solid),
        "implicit-euler" => (SKY, Dash::Dashed),
        "tr-bdf2" => (ORANGE, Dash::Solid),
        "dense-newton" => (VERMILION, Dash::Solid),
        _ => (PURPLE, Dash::Dotted),
    }
}

/// The cost figure.
pub(crate) fn picture(rows: &[Row]) -> Figure {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method) {
            methods.push(row.method);
        }
    }
    let of = |method: &str, time: fn(&Row) -> f64| -> Vec<Point> {
        let rows = rows.iter().filter(|row| row.method == method);
        rows.map(|row| (row.n as f64, time(row) * 1e-3)).collect()
    };
    let times =
        || rows.iter().flat_map(|row| [row.median_ns, row.mean_ns, row.repeated_ns]).map(|ns| ns * 1e-3);
    let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
    let low = decade(times().fold(f64::INFINITY, f64::min).max(1e-3), f64::floor);
    let high = decade(times().fold(low * 10.0, f64::max), f64::ceil);
    let largest = rows.iter().map(|row| row.n).max().unwrap_or(1) as f64;
    let panel = |title: &str, time: fn(&Row) -> f64| {
        let across = Axis::linear("equations n [1]", 0.0, largest * 1.04);
        let mut panel = Panel::new(title, across, Axis::logarithmic("time per step [µs]", low, high));
        for method in &methods {
            let (colour, dash) = looks(method);
            let points = of(method, time);
            let dots = points.iter().map(|point| (*point, colour)).collect();
            panel.curves.push(Curve::new(method, colour, dash, points));
            panel.dots.push(Dots { label: String::new(), mark: Mark::Disc, radius: 2.6, points: dots });
        }
        panel
    };
    Figure {
        title: "Cost of a step on chains of n equations".into(),
        panels: vec![
            panel("median step", |row| row.median_ns),
            panel("longest frame that repeats", |row| row.repeated_ns),
        ],
        columns: 2,
        panel_size: (540, 460),
        remarks: vec![PRINTED.into()],
    }
}
