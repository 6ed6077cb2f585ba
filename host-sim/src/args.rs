//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use eclss_core::Method;
use eclss_network_file::generate::Shape;

use crate::Duration;

/// Simulates the fluid networks of a space station's life support.
///
/// Without a command it runs the experiment of the paper on which the method rests.
///
/// Exit codes: 0 good, 1 failure (a run that diverged is one), 2 usage or bad input.
#[derive(Debug, Parser)]
#[command(name = "eclss-rt", version, about, long_about)]
pub(crate) struct Cli {
    /// What to do; the paper's experiment when absent.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run the paper's experiment: table, CSV and plots.
    Paper(PaperArgs),
    /// Run a network and report its state at given times.
    Run(RunArgs),
    /// Read a network file, say what is in it and what to watch.
    Check(CheckArgs),
    /// Compute the eigenvalues of a step while an input moves through its range.
    Stability(StabilityArgs),
    /// Measure what a step costs against the number of equations.
    Bench(BenchArgs),
    /// Make up a network of any size.
    Generate(GenerateArgs),
    /// Solve for the state of rest: flows and pressures with the inputs of the start.
    Steady(SteadyArgs),
    /// Draw a network as a piping schematic.
    Schematic(SchematicArgs),
    /// List what a network publishes: names for records, channels, sensors and captures, with unit and meaning.
    Signals(SignalsArgs),
    /// List the kinds of component; with `--markdown` their keys, inputs and outputs, as in docs/components.md.
    Kinds(KindsArgs),
    /// Run a network at the clock's pace and show it in the browser.
    Serve(ServeArgs),
    /// Write the whole validation into one HTML file.
    Report(ReportArgs),
    /// Run the plant in real time with hardware on it, or none.
    #[cfg(feature = "hil")]
    Hil(HilArgs),
    /// Watch a board that runs the plant itself: test bench, recorder and operator at the other end of its link.
    #[cfg(feature = "hil")]
    Watch(WatchArgs),
    /// Run a recorded run again and compare how it ends.
    #[cfg(feature = "hil")]
    Replay(ReplayArgs),
}

/// Arguments of `hil`.
#[cfg(feature = "hil")]
#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub(crate) struct HilArgs {
    /// Network file.
    #[arg(long, value_name = "FILE")]
    pub(crate) network: PathBuf,
    /// Where hardware is: serial:PORT[@BAUD], udp:[ADDRESS:]PORT, unix:PATH (connects) or unix-listen:PATH.
    #[arg(long, value_name = "LINK")]
    pub(crate) link: Option<String>,
    /// File with the key of those who may command over the link: 64 hexadecimal digits.
    #[arg(long, value_name = "FILE")]
    pub(crate) key: Option<PathBuf>,
    /// The one peer that is heard over UDP.
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub(crate) peer: Option<String>,
    /// Method; the file's when absent.
    #[arg(long, value_name = "M", value_parser = method)]
    pub(crate) method: Option<Method>,
    /// Ticks and steps per second; the file's step when absent.
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) rate: Option<u32>,
    /// How long the loop runs, such as 60s; until `quit` or an interrupt when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) duration: Option<Duration>,
    /// Arm hardware as soon as inputs are good and outputs have arrived.
    #[arg(long)]
    pub(crate) arm: bool,
    /// Run a coupling that `check --hil` refuses as unstable.
    #[arg(long)]
    pub(crate) accept_margin: bool,
    /// Ticks of delay that link and hardware add to the coupling's loops.
    #[arg(long, value_name = "TICKS", default_value_t = 0)]
    pub(crate) extra_delay: u32,
    /// Take orders from the standard input: settle, arm, hold, resume, disarm, acknowledge, restart, stop, quit, pause,
    /// step [N], go, speed X.
    #[arg(long)]
    pub(crate) operator: bool,
    /// Core on which the loop runs; any when absent.
    #[arg(long, value_name = "N")]
    pub(crate) core: Option<usize>,
    /// So many times as fast as real time (inf: as fast as it goes); only without hardware.
    #[arg(long, value_name = "X")]
    pub(crate) speed: Option<f64>,
    /// Folder for the record: record.csv, record.mcap, captures.
    #[arg(long, value_name = "DIR")]
    pub(crate) record: Option<PathBuf>,
    /// Time of a row in the record, which keeps smallest and largest values.
    #[arg(long, value_name = "TIME", default_value = "10ms")]
    pub(crate) every: Duration,
    /// What is captured tick by tick: overrun, safe, NAME>VALUE or NAME<VALUE; may be given again.
    #[arg(long, value_name = "TRIGGER")]
    pub(crate) capture: Vec<String>,
    /// How long before and after it.
    #[arg(long, value_name = "TIME", default_value = "500ms")]
    pub(crate) around: Duration,
    /// Start from the state in this file, which --checkpoint left.
    #[arg(long, value_name = "FILE")]
    pub(crate) start: Option<PathBuf>,
    /// Take the state of --start as it is, at rest or not: the plant stands there until it is armed, and goes on from there.
    #[arg(long, requires = "start")]
    pub(crate) resume: bool,
    /// Leave the state at the end in this file.
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Measure the delay from input to output by loopback: a tester within this program is at the other end, or at
    /// LINK, whose wire leads to that of --link.
    #[arg(long, value_name = "LINK", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub(crate) loopback: Option<String>,
    /// Serve a live page of the loop; on this computer alone where only a port is given.
    #[arg(long, value_name = "[ADDRESS:]PORT", value_parser = page)]
    pub(crate) page: Option<std::net::SocketAddr>,
    /// Make a tick longer on purpose, such as 2000:5ms, to see that it is noticed.
    #[arg(long, value_name = "TICK:TIME")]
    pub(crate) stall: Option<String>,
    /// Print one JSON object at the end instead of lines and a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `watch`.
#[cfg(feature = "hil")]
#[derive(Debug, Args)]
pub(crate) struct WatchArgs {
    /// The network file that the board was built from.
    #[arg(long, value_name = "FILE")]
    pub(crate) network: PathBuf,
    /// Where the board is: serial:PORT[@BAUD], udp:[ADDRESS:]PORT, unix:PATH (connects) or unix-listen:PATH.
    #[arg(long, value_name = "LINK")]
    pub(crate) link: String,
    /// File with the key of those who may command over the link: 64 hexadecimal digits.
    #[arg(long, value_name = "FILE")]
    pub(crate) key: Option<PathBuf>,
    /// The one peer that is heard over UDP.
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub(crate) peer: Option<String>,
    /// How long it is watched, such as 60s; until `quit` or an interrupt when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) duration: Option<Duration>,
    /// Arm its hardware as soon as inputs are good and outputs have arrived.
    #[arg(long)]
    pub(crate) arm: bool,
    /// Take orders from the standard input: arm, hold, resume, disarm, acknowledge, restart, stop, set NAME VALUE, get
    /// NAME, quit.
    #[arg(long)]
    pub(crate) operator: bool,
    /// Folder for the record: record.csv, record.mcap, captures.
    #[arg(long, value_name = "DIR")]
    pub(crate) record: Option<PathBuf>,
    /// Time of a row in the record, which keeps smallest and largest values.
    #[arg(long, value_name = "TIME", default_value = "10ms")]
    pub(crate) every: Duration,
    /// What is captured packet by packet: safe, NAME>VALUE or NAME<VALUE; may be given again.
    #[arg(long, value_name = "TRIGGER", requires = "record")]
    pub(crate) capture: Vec<String>,
    /// How long before and after it.
    #[arg(long, value_name = "TIME", default_value = "500ms")]
    pub(crate) around: Duration,
    /// Serve a live page; on this computer alone where only a port is given.
    #[arg(long, value_name = "[ADDRESS:]PORT", value_parser = page)]
    pub(crate) page: Option<std::net::SocketAddr>,
    /// Print one JSON object at the end instead of lines and a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `replay`.
#[cfg(feature = "hil")]
#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The record, record.mcap.
    pub(crate) record: PathBuf,
    /// Print one JSON object instead of lines.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `paper`.
#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    /// Folder for CSV and plots.
    #[arg(long, default_value = "results/paper", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Also draw the README's picture into this file.
    #[arg(long, value_name = "FILE")]
    pub(crate) readme_picture: Option<PathBuf>,
}

impl Default for PaperArgs {
    fn default() -> Self {
        Self { out: PathBuf::from("results/paper"), readme_picture: None }
    }
}

/// How a network is stepped.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Stepping {
    /// Method; the file's when absent.
    #[arg(long, value_name = "M", value_parser = method)]
    pub(crate) method: Option<Method>,
    /// Step, such as 1ms, 0.1ms or 500us; the file's when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) step: Option<Duration>,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Network file; the paper's network when absent.
    pub(crate) network: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) stepping: Stepping,
    /// Plant time at which the run ends, such as 26s, 2min or 24h; the file's when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) until: Option<Duration>,
    /// Plant times to report, separated by commas; the end when absent.
    #[arg(long, value_name = "TIMES", value_delimiter = ',')]
    pub(crate) at: Vec<Duration>,
    /// Time between two rows of the CSV; chosen for at most 20 000 rows when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) every: Option<Duration>,
    /// Folder for CSV and plot; `results/` with the network's name when absent, none with --json.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Network file.
    pub(crate) network: PathBuf,
    #[command(flatten)]
    pub(crate) stepping: Stepping,
    /// Also examine the coupling to hardware: causality, delay and stability of every pair of bound signals.
    #[arg(long)]
    pub(crate) hil: bool,
    /// Ticks that link and hardware add to the delay of the loop, beside the one of the exchange itself.
    #[arg(long, value_name = "TICKS", default_value_t = 0, requires = "hil",
        value_parser = clap::value_parser!(u32).range(0..=1_000))]
    pub(crate) extra_delay: u32,
    /// Write what was read to this file.
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
}

/// Arguments of `stability`.
#[derive(Debug, Args)]
pub(crate) struct StabilityArgs {
    /// Network file; the paper's network when absent.
    pub(crate) network: Option<PathBuf>,
    /// Step, such as 1ms; the file's when absent.
    #[arg(long, value_name = "TIME")]
    pub(crate) step: Option<Duration>,
    /// Method whose matrix is examined, euler or relaxation; the file's when absent.
    #[arg(long, value_name = "M", value_parser = method)]
    pub(crate) method: Option<Method>,
    /// Line; all lines when absent.
    #[arg(long, value_name = "ID")]
    pub(crate) line: Option<String>,
    /// Input that moves, such as valve.opening; each line's stiffest element's when absent.
    #[arg(long, value_name = "ELEMENT.INPUT")]
    pub(crate) input: Option<String>,
    /// First value; 0.02 or the least allowed, whichever is larger, when absent.
    #[arg(long, value_name = "VALUE")]
    pub(crate) from: Option<f64>,
    /// Last value; the largest allowed when absent.
    #[arg(long, value_name = "VALUE")]
    pub(crate) to: Option<f64>,
    /// Folder for CSV and plots; `results/` with the network's name when absent.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    /// Equations of the chains, separated by commas; those of the paper's figure when absent.
    #[arg(long, value_name = "SIZES", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub(crate) sizes: Vec<u32>,
    /// Folder for CSV and plot.
    #[arg(long, default_value = "results/bench", value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Arguments of `generate`.
#[derive(Debug, Args)]
pub(crate) struct GenerateArgs {
    /// How nodes hang together: chain, star, tree or mesh; ring for a closed loop of small cabins, modules for a station of
    /// copies of one file.
    #[arg(value_parser = made)]
    pub(crate) shape: Made,
    /// Number of nodes, supply and exhaust among them; of modules for `modules`.
    #[arg(long, value_name = "N", alias = "count")]
    pub(crate) nodes: usize,
    /// What the figures are drawn from.
    #[arg(long, default_value_t = 1, value_name = "S")]
    pub(crate) seed: u64,
    /// Give a ring heat, moisture and composition.
    #[arg(long)]
    pub(crate) air: bool,
    /// Let losses and heads of a ring follow the density; includes `--air`.
    #[arg(long)]
    pub(crate) density_follows: bool,
    /// Network file of one module, for `modules`.
    #[arg(long, value_name = "FILE", default_value = "networks/thcs.toml")]
    pub(crate) module: PathBuf,
    /// Node at which neighbouring modules are joined, for `modules`.
    #[arg(long, value_name = "ID", default_value = "cabin")]
    pub(crate) joint: String,
    /// File to write; printed when absent.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Kinds of generated network.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Made {
    /// Random figures in a shape.
    Shape(Shape),
    /// Closed loop of small cabins.
    Ring,
    /// Station of equal modules.
    Modules,
}

/// Arguments of `signals`.
#[derive(Debug, Args)]
pub(crate) struct SignalsArgs {
    /// Network file; the paper's network when absent.
    pub(crate) network: Option<PathBuf>,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `kinds`.
#[derive(Debug, Args)]
pub(crate) struct KindsArgs {
    /// Print the whole reference in Markdown.
    #[arg(long)]
    pub(crate) markdown: bool,
}

/// Arguments of `schematic`.
#[derive(Debug, Args)]
pub(crate) struct SchematicArgs {
    /// Network file; the paper's network when absent.
    pub(crate) network: Option<PathBuf>,
    /// File to write; printed when absent.
    #[arg(short, long, value_name = "FILE.svg")]
    pub(crate) output: Option<PathBuf>,
}

/// Arguments of `steady`.
#[derive(Debug, Args)]
pub(crate) struct SteadyArgs {
    /// Network file.
    pub(crate) network: PathBuf,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// File to write.
    #[arg(short, long, default_value = "results/report.html", value_name = "FILE.html")]
    pub(crate) output: PathBuf,
    /// Equations of the chains whose cost is measured, separated by commas; those of the paper's figure when absent.
    #[arg(long, value_name = "SIZES", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub(crate) sizes: Vec<u32>,
    /// Hours of the module's day that are run, 1 to 24.
    #[arg(long, value_name = "HOURS", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=24))]
    pub(crate) hours: u32,
}

/// Arguments of `serve`.
#[derive(Debug, Args)]
pub(crate) struct ServeArgs {
    /// Network file; the paper's network when absent.
    pub(crate) network: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) stepping: Stepping,
    /// Port; 0 takes any free one.
    #[arg(long, default_value_t = 8970, value_name = "PORT")]
    pub(crate) port: u16,
    /// Address to listen at; only this machine can reach the default.
    #[arg(long, default_value = "127.0.0.1", value_name = "ADDRESS")]
    pub(crate) listen: std::net::IpAddr,
    /// Let the page move inputs, break them, hold the plant and choose scenarios.
    #[arg(long)]
    pub(crate) control: bool,
    /// Let the page record into files in this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) recordings: Option<PathBuf>,
    /// Open the page in the browser.
    #[arg(long)]
    pub(crate) open: bool,
    /// Ask the system for real-time priority and locked memory; say what it refuses.
    #[cfg(feature = "hil")]
    #[arg(long)]
    pub(crate) real_time: bool,
}

/// A port of this computer, or an address with a port.
#[cfg(feature = "hil")]
fn page(text: &str) -> Result<std::net::SocketAddr, String> {
    let here = |port| std::net::SocketAddr::from((std::net::Ipv4Addr::LOCALHOST, port));
    text.parse()
        .ok()
        .or_else(|| text.parse().ok().map(here))
        .ok_or_else(|| format!("`{text}` is neither a port nor an address with a port"))
}

fn made(name: &str) -> Result<Made, String> {
    match name {
        "ring" => Ok(Made::Ring),
        "modules" => Ok(Made::Modules),
        _ => Shape::from_name(name).map(Made::Shape).ok_or_else(|| {
            let names: Vec<_> = Shape::ALL.iter().map(|shape| shape.name()).collect();
            format!("no such shape; there are {}, ring, modules", names.join(", "))
        }),
    }
}

fn method(name: &str) -> Result<Method, String> {
    Method::from_name(name).ok_or_else(|| {
        let names: Vec<_> = Method::ALL.iter().map(|method| method.name()).collect();
        format!("no such method; there are {}", names.join(", "))
    })
}
