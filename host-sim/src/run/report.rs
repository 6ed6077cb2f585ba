//! The report of a run, as data; its JSON form is what other programs read.

use eclss_core::climate::Ledger;
use eclss_core::signal::Owner;
use eclss_core::{Fault, Health, Margin, Output, Place, Proof, Simulator};
use eclss_network_file::{Loaded, Names};
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Breach, Plan, Slowed};
use crate::Source;

/// Version of the JSON form.
const FORMAT: u32 = 1;

/// Values by id, in the order of the network file.
#[derive(Debug, Clone, PartialEq)]
pub struct ById<V>(pub Vec<(String, V)>);

impl<V: Serialize> Serialize for ById<V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (id, value) in &self.0 {
            map.serialize_entry(id, value)?;
        }
        map.end()
    }
}

/// Everything that a run says.
#[derive(Debug, Clone, serde::Serialize)]
pub struct RunReport {
    /// Version of this form.
    pub format: u32,
    /// Where the network came from.
    pub network: String,
    /// Id of the network, hexadecimal.
    pub network_id: String,
    /// Name of the method.
    pub method: &'static str,
    /// Step [s].
    pub step_s: f64,
    /// Plant time at which the run was to end [s].
    pub until_s: f64,
    /// Whether transients are pseudo-time, so that only states of rest are physical.
    pub pseudo_time: bool,
    /// The state at every asked time that was reached.
    pub at: Vec<Snapshot>,
    /// Where the run ended.
    pub end: End,
    /// Limits of cabin air that were broken where there is a crew, and what makes the figures of any volume doubtful.
    pub breaches: Vec<Breach>,
    /// The node that `adaptive` slowed most, where that bends transients; `null` where it hardly slowed any.
    pub slowed: Option<Slowed>,
    /// Where and when the run left its range; `null` for a run that may be trusted.
    pub diverged: Option<Diverged>,
}

/// The state at one time.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Snapshot {
    /// Plant time [s].
    pub t_s: f64,
    /// Steps taken.
    pub tick: u64,
    /// Mass flows [kg/s]: of each line at its flow element, of each element at its inlet.
    pub flows_kg_s: ById<f32>,
    /// Absolute pressures [Pa]: of each node, and at each element's outlet.
    pub pressures_pa: ById<f64>,
    /// The same from the network's reference pressure [Pa].
    pub gauge_pa: ById<f32>,
    /// Inputs as the last step saw them.
    pub inputs: ById<f32>,
    /// Temperatures, moisture, composition and condensers, each in the unit of its name's figure; empty without `[air]`.
    pub climate: ById<f32>,
    /// Ledgers of gases, water, coolant and energy; empty without `[air]`.
    pub ledgers: Vec<Balance>,
    /// Smallest φ of the last step [1].
    pub phi_min: f32,
    /// Upper bound of the spectral radius of the last step [1]; NaN, `null` in JSON, where the method has none.
    pub spectral_bound: f32,
    /// What makes the last step stable.
    pub proof: &'static str,
    /// Hash over network, method, step, tick and all states, hexadecimal.
    pub state_hash: String,
    /// Whether the run may be trusted up to here.
    pub health: &'static str,
}

/// What a ledger says.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Balance {
    /// What is counted.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Held beyond the start.
    pub held: f64,
    /// Supplied from outside.
    pub supplied: f64,
    /// Supplied and removed, without sign.
    pub turned_over: f64,
}

impl Balance {
    fn all(simulator: &Simulator<'_>) -> Vec<Self> {
        let balance = |ledger: Ledger| {
            let Ledger { name, unit, held, supplied, turned_over } = ledger;
            Self { name, unit, held, supplied, turned_over }
        };
        simulator.ledgers().into_iter().map(balance).collect()
    }
}

/// Where a run ended.
#[derive(Debug, Clone, serde::Serialize)]
pub struct End {
    /// Plant time [s].
    pub t_s: f64,
    /// Steps taken.
    pub tick: u64,
    /// Hash over network, method, step, tick and all states, hexadecimal.
    pub state_hash: String,
    /// Whether the run may be trusted.
    pub health: &'static str,
    /// Worst figures of all steps.
    pub worst: Worst,
}

/// Worst figures of all steps, one by one.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Worst {
    /// Smallest φ [1].
    pub phi_min: f32,
    /// Largest bound of the spectral radius [1]; NaN, `null` in JSON, where the method has none.
    pub spectral_bound: f32,
    /// Weakest proof.
    pub proof: &'static str,
    /// Steps that only the guard `short step` covered, which proves nothing.
    pub guarded_ticks: u64,
    /// Steps in which neither the proof nor the guard held.
    pub unproven_ticks: u64,
}

/// Where and when a run left its range.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Diverged {
    /// Step that did it.
    pub tick: u64,
    /// Plant time [s].
    pub t_s: f64,
    /// `node` or `line`.
    pub kind: &'static str,
    /// Id of the node or line.
    pub id: String,
    /// Element that carries the line's flow, where the fault is in a line.
    pub element: Option<String>,
    /// What left its range, its value and the range, in words.
    pub what: String,
}

/// What is to be known of `short step` wherever it is named.
pub(crate) const GUARD: &str = "`short step` is a guard that covers the paper's loop; it proves nothing.";

/// A proof's name in reports.
pub(crate) fn proof(proof: Proof) -> &'static str {
    if proof == Proof::None {
        "none"
    } else if proof == Proof::ShortStep {
        "short step"
    } else if proof == Proof::Dominant {
        "dominant"
    } else {
        "by construction"
    }
}

fn health(health: Health) -> &'static str {
    match health {
        Health::Trusted => "trusted",
        Health::Faulted(_) => "diverged",
    }
}

fn hash(value: u64) -> String {
    format!("{value:016x}")
}

fn seconds(us: u64) -> f64 {
    crate::Duration::from_us(us).seconds()
}

impl Snapshot {
    pub(super) fn take(loaded: &Loaded, simulator: &Simulator<'_>) -> Self {
        let (mut flows, mut gauges, mut inputs, mut climate) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let named = loaded.standard_signals();
        let signals: Vec<_> = named.iter().map(|named| named.signal).collect();
        let mut values = vec![f32::NAN; signals.len()];
        simulator.read_signals(&signals, &mut values);
        for (named, value) in named.iter().zip(values) {
            match named.signal.output {
                Output::MassFlow | Output::SegmentFlow => flows.push((named.owner().to_owned(), value)),
                Output::Pressure | Output::OutletPressure => gauges.push((named.owner().to_owned(), value)),
                Output::Input => inputs.push((named.name.clone(), value)),
                // They stand beside the lists.
                output if output.owner() == Owner::Run => {}
                _ => climate.push((named.name.clone(), value)),
            }
        }
        let reference = f64::from(loaded.reference_pa);
        let absolute = |(id, gauge): &(String, f32)| (id.clone(), reference + f64::from(*gauge));
        let Margin { phi, spectral_bound, proof: held } = simulator.margin();
        Self {
            t_s: seconds(simulator.time_us()),
            tick: simulator.tick(),
            flows_kg_s: ById(flows),
            pressures_pa: ById(gauges.iter().map(absolute).collect()),
            gauge_pa: ById(gauges),
            inputs: ById(inputs),
            climate: ById(climate),
            ledgers: loaded.climate.volumes.first().map_or_else(Vec::new, |_| Balance::all(simulator)),
            phi_min: phi,
            spectral_bound,
            proof: proof(held),
            state_hash: hash(simulator.state_hash()),
            health: health(simulator.health()),
        }
    }
}

impl Diverged {
    fn new(loaded: &Loaded, fault: Fault, simulator: &Simulator<'_>) -> Self {
        let step_us = simulator.settings().step_us;
        let what = simulator.excursion().map_or_else(String::new, |what| what.to_string());
        let Names { nodes, lines, segments, .. } = &loaded.names;
        let name = |list: &[String], index: usize| list.get(index).cloned().unwrap_or_default();
        let (kind, id, element) = match fault.place {
            Place::Node(node) => ("node", name(nodes, node as usize), None),
            Place::Line(line) => {
                let flow_segment = loaded.lines.get(line as usize);
                let element = flow_segment.map(|line| (line.first_segment + line.flow_segment) as usize);
                ("line", name(lines, line as usize), element.map(|place| name(segments, place)))
            }
        };
        Self { tick: fault.tick, t_s: seconds(fault.tick * u64::from(step_us)), kind, id, element, what }
    }
}

impl RunReport {
    pub(super) fn new(
        source: &Source,
        plan: &Plan,
        at: Vec<Snapshot>,
        simulator: &Simulator<'_>,
        guarded_ticks: u64,
    ) -> Self {
        let worst = simulator.worst_margin();
        // A method without a bound has none in any step.
        let bound = simulator.margin().spectral_bound;
        let bound = if bound.is_nan() { bound } else { worst.spectral_bound };
        let method = plan.settings.method;
        Self {
            format: FORMAT,
            network: source.name.clone(),
            network_id: hash(simulator.network_id()),
            method: method.name(),
            step_s: plan.step().seconds(),
            until_s: plan.until().seconds(),
            pseudo_time: crate::is_pseudo_time(method),
            at,
            end: End {
                t_s: seconds(simulator.time_us()),
                tick: simulator.tick(),
                state_hash: hash(simulator.state_hash()),
                health: health(simulator.health()),
                worst: Worst {
                    phi_min: worst.phi,
                    spectral_bound: bound,
                    proof: proof(worst.proof),
                    guarded_ticks,
                    unproven_ticks: simulator.unproven_ticks(),
                },
            },
            breaches: Vec::new(),
            slowed: None,
            diverged: match simulator.health() {
                Health::Trusted => None,
                Health::Faulted(fault) => Some(Diverged::new(&source.loaded, fault, simulator)),
            },
        }
    }
}
