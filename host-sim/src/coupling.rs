//! Whether hardware and plant are stable together: what `eclss-rt check --hil` says.
//!
//! A *measured* line closes a loop through the outside: the plant gives out pressures, hardware answers with a flow.
//! For every such line the loop gain h·c·G is compared with what its delay allows ([`Loop::limit`]), by itself and
//! together with all others. Other inputs (an opening, a speed) store nothing between plant and hardware; whether a
//! controller that drives them is stable is not the coupling's to say.

mod delay;

pub use delay::{Loop, mean_over_step};

use eclss_core::Element as _;
use eclss_core::process::{Hold, InputChannel, Order};
use eclss_core::{Method, NodeKind, Output, Settings, components};
use eclss_network_file::Loaded;
use nalgebra::{DMatrix, SymmetricEigen};
use serde::Serialize;

/// Margin below which a coupling is warned of.
pub const SMALL_MARGIN: f64 = 2.0;

/// Who decides what at an interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Causality {
    /// The plant gives pressure and takes flow: hardware is a resistance on the plant's volume.
    PressureOutFlowIn,
    /// The input is a signal that stores and moves nothing.
    Signal,
}

/// One input channel, with the outputs that it is paired with.
#[derive(Debug, Clone, Serialize)]
pub struct Pair {
    /// The input.
    pub input: String,
    /// The outputs that hardware answers to.
    pub outputs: Vec<String>,
    /// Who decides what.
    pub causality: Causality,
    /// Delay of the loop [ticks].
    pub delay_ticks: f64,
    /// h·c·G, where the pair closes a loop over a volume.
    pub gain: Option<f64>,
    /// Largest gain with this delay.
    pub limit: Option<f64>,
    /// Limit over gain: stable above 1.
    pub margin: Option<f64>,
}

/// The whole coupling.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Coupling {
    /// Every input channel.
    pub pairs: Vec<Pair>,
    /// h times the largest eigenvalue of all measured lines on all volumes together.
    pub gain_together: Option<f64>,
    /// Limit of the slowest of them over that.
    pub margin_together: Option<f64>,
    /// What makes the coupling impossible.
    pub refusals: Vec<String>,
    /// What to watch.
    pub warnings: Vec<String>,
}

/// A measured line that is bound.
struct Measured {
    from: usize,
    to: usize,
    slope: f64,
}

/// Examines the channels of `loaded`, run with `settings`; `extra_ticks` are what link and hardware add to the delay.
pub fn examine(loaded: &Loaded, settings: Settings, extra_ticks: u32) -> Coupling {
    let mut coupling = Coupling::default();
    let step_s = f64::from(settings.step_us) * 1e-6;
    let mut lines = Vec::new();
    let mut lowest = f64::INFINITY;
    for entry in &loaded.process.inputs {
        let channel = entry.channel();
        let mean = mean_over_step(settings.method, channel.hold == Hold::Linear);
        let filter = f64::from(channel.filter_s) / step_s;
        let looped = Loop { ticks: 1 + extra_ticks, filter, mean };
        let measured = measured_line(loaded, channel.slot as usize);
        coupling.warnings.extend(sudden(&entry.name, &channel, step_s));
        let mut pair = Pair {
            input: entry.name.clone(),
            outputs: Vec::new(),
            causality: Causality::Signal,
            delay_ticks: looped.delay_ticks(),
            gain: None,
            limit: None,
            margin: None,
        };
        let Some(line) = measured else {
            pair.outputs = loaded.process.outputs.iter().map(|output| output.name.clone()).collect();
            coupling.pairs.push(pair);
            continue;
        };
        pair.causality = Causality::PressureOutFlowIn;
        for node in [line.from, line.to] {
            let pressure = Output::Pressure.of(node);
            let seen = |output: &&eclss_network_file::OutputEntry| output.channel().signal == pressure;
            let name = loaded.names.nodes.get(node).map_or("?", String::as_str);
            match loaded.process.outputs.iter().find(seen) {
                Some(output) => pair.outputs.push(output.name.clone()),
                None if rise(loaded, node) > 0.0 => coupling.warnings.push(format!(
                    "`{}` answers to the pressure of `{name}`, which is bound to no output",
                    entry.name
                )),
                None => {}
            }
            let junction = loaded.nodes.get(node).is_some_and(|node| node.kind == NodeKind::Junction);
            if junction {
                coupling.refusals.push(format!(
                    "`{}` comes into junction `{name}`, which stores nothing: its pressure has no bound; give it a \
                     volume",
                    entry.name
                ));
            }
        }
        let gain = step_s * (rise(loaded, line.from) + rise(loaded, line.to)) * line.slope;
        let gain = if line.from == line.to { 0.0 } else { gain };
        let limit = looped.limit();
        lowest = lowest.min(limit);
        let margin = limit / gain;
        (pair.gain, pair.limit, pair.margin) = (Some(gain), Some(limit), Some(margin));
        judge(&mut coupling, &format!("`{}`", entry.name), margin);
        coupling.pairs.push(pair);
        lines.push(line);
    }
    if lines.len() > 1 {
        let gain = step_s * together(loaded, &lines);
        (coupling.gain_together, coupling.margin_together) = (Some(gain), Some(lowest / gain));
        judge(&mut coupling, "all measured lines together", lowest / gain);
    }
    remarks(loaded, settings.method, &lines, &mut coupling);
    coupling
}

/// Warns of an input that a sudden command loses: what moves faster than the channel is rejected until enough time has
/// passed, and rejected for longer than `stale_ticks` it is lost.
fn sudden(name: &str, channel: &InputChannel<'_>, step_s: f64) -> Option<String> {
    let believed = f64::from(channel.max_rate_per_s) * step_s * (f64::from(channel.stale_ticks) + 1.0);
    let consequence = if channel.essential { "leads to SAFE" } else { "gives it its safe value" };
    (believed < f64::from(channel.max) - f64::from(channel.min)).then(|| {
        format!(
            "`{name}`: a sudden change by more than {believed:.4} is rejected as too fast for longer than \
             `stale_ticks` = {}, and the input that is lost {consequence}; command it no faster than \
             `max_rate_per_s` = {}",
            channel.stale_ticks, channel.max_rate_per_s
        )
    })
}

fn judge(coupling: &mut Coupling, what: &str, margin: f64) {
    if margin <= 1.0 {
        coupling.refusals.push(format!(
            "{what}: unstable, margin {margin:.3}; a larger volume, a shorter step, less delay or softer hardware \
             helps"
        ));
    } else if margin < SMALL_MARGIN {
        coupling.warnings.push(format!("{what}: small margin {margin:.3}"));
    }
}

fn remarks(loaded: &Loaded, method: Method, lines: &[Measured], coupling: &mut Coupling) {
    if !lines.is_empty() && crate::is_pseudo_time(method) {
        let text = format!(
            "method `{}` cannot follow a measured flow; take adaptive or an implicit one",
            method.name()
        );
        coupling.refusals.push(text);
    }
    if !lines.is_empty() && loaded.process.order == Order::Immediate {
        coupling.warnings.push(
            "outputs go out at times that vary with the step's: hardware may see them within the tick or only in \
             the next; counted as a whole tick"
                .into(),
        );
    }
    let implicit = matches!(method, Method::ImplicitEuler | Method::TrBdf2);
    let touches = |node: u32| lines.iter().any(|line| line.from == node as usize || line.to == node as usize);
    let inert = loaded.lines.iter().any(|line| {
        let first = line.first_segment as usize;
        let segments = loaded.segments.get(first..first + line.segments as usize).unwrap_or(&[]);
        (touches(line.from) || touches(line.to)) && segments.iter().any(|part| part.inertance_per_m > 0.0)
    });
    if implicit && inert {
        coupling.warnings.push(
            "lines with inertance hang on the same volumes: the margin is that of the volumes alone".into(),
        );
    }
    if loaded.process.inputs.is_empty() {
        coupling.warnings.push("no input is bound: the plant runs without hardware".into());
    }
}

/// dp/dm of a node [Pa/kg]; 0 for one that stores nothing or is held.
fn rise(loaded: &Loaded, node: usize) -> f64 {
    loaded.nodes.get(node).map_or(0.0, |node| f64::from(node.pressure_per_mass_pa_kg()))
}

/// The measured line that reads an input slot.
fn measured_line(loaded: &Loaded, slot: usize) -> Option<Measured> {
    let reads = |segment: &&eclss_core::Segment| {
        segment.first_input as usize == slot && segment.element.input_spec(0).is_some()
    };
    let place = loaded.segments.iter().position(|segment| reads(&segment))?;
    let measured = loaded.segments.get(place)?.element.get::<components::Measured>()?;
    let holds = |line: &&eclss_core::Line| {
        (line.first_segment..line.first_segment + line.segments).contains(&(place as u32))
    };
    let line = loaded.lines.iter().find(holds)?;
    let slope = f64::from(measured.slope_kg_s_pa);
    Some(Measured { from: line.from as usize, to: line.to as usize, slope })
}

/// Largest eigenvalue of C·(Laplacian of the slopes) [1/s], C = dp/dm: symmetric in √C.
fn together(loaded: &Loaded, lines: &[Measured]) -> f64 {
    let order = loaded.nodes.len();
    let root = |node: usize| rise(loaded, node).sqrt();
    let mut matrix = DMatrix::<f64>::zeros(order, order);
    for line in lines.iter().filter(|line| line.from != line.to) {
        let (a, b) = (line.from, line.to);
        matrix[(a, a)] += line.slope * root(a) * root(a);
        matrix[(b, b)] += line.slope * root(b) * root(b);
        matrix[(a, b)] -= line.slope * root(a) * root(b);
        matrix[(b, a)] -= line.slope * root(a) * root(b);
    }
    SymmetricEigen::new(matrix).eigenvalues.max()
}
