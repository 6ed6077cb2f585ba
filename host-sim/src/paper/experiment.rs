//! Runs the experiment and collects its figures.

use eclss_core::{Fault, Health, Margin, Method, Network, Proof, Settings};

use super::{DoubleLoop, Reference};
use crate::linear::Spectrum;
use crate::refusal::refused;
use crate::trace::{Trace, columns};
use crate::{Duration, Failure, HostBuffers, Progress, Source};

/// Steps of the paper [µs].
const STEPS_US: [u32; 2] = [1_000, 10_000];
/// Steps at which the settled flow is compared [µs].
const SETTLE_STEPS_US: [u32; 3] = [10_000, 1_000, 100];
/// Openings at which the settled flow is compared.
const SETTLE_OPENINGS: [f32; 3] = [1.0, 0.2, 0.02];
/// Time after which a run with constant inputs has settled to the last bit [µs]; the slowest mode decays with
/// 1.7 s.
const SETTLE_US: u64 = 60_000_000;
/// End of the run of the paper [µs].
const UNTIL_US: u64 = 26_000_000;
/// Smallest opening of the experiment.
const CLOSED: f64 = 0.02;
/// Openings of a sweep from [`CLOSED`] to fully open.
const SWEEP_POINTS: usize = 197;

/// The experiment on a network that has a line with a valve.
#[derive(Debug)]
pub struct Experiment<'s> {
    source: &'s Source,
    valve: usize,
    double: DoubleLoop,
}

/// One run of the valve's closing.
#[derive(Debug, Clone)]
pub struct Run {
    /// Method and step.
    pub settings: Settings,
    /// Everything written down, at every step.
    pub trace: Trace,
    /// Flow at the flow segment over time, [s] and [g/s].
    pub flow: Vec<(f64, f64)>,
    /// Where the run left its range.
    pub fault: Option<Fault>,
    /// Worst margin of all steps.
    pub worst: Margin,
    /// Steps that only the guard `short step` covered.
    pub guarded_ticks: u64,
    /// Steps in which neither proof nor guard held.
    pub unproven_ticks: u64,
    /// Steps taken.
    pub ticks: u64,
    /// State hash at the end.
    pub state_hash: u64,
}

impl Run {
    /// Flow [g/s] at a time [s] at which the run was written down.
    pub fn flow_at(&self, time_s: f64) -> Option<f64> {
        let near = |point: &&(f64, f64)| (point.0 - time_s).abs() < 1e-7;
        self.flow.iter().find(near).map(|point| point.1)
    }

    /// Time of divergence [s].
    pub fn diverged_s(&self) -> Option<f64> {
        let step_s = f64::from(self.settings.step_us) * 1e-6;
        self.fault.map(|fault| fault.tick as f64 * step_s)
    }
}

/// A flow after constant inputs for a long time.
#[derive(Debug, Clone, Copy)]
pub struct Settled {
    /// Opening.
    pub opening: f32,
    /// Step [µs].
    pub step_us: u32,
    /// Flow that stands still [kg/s].
    pub flow_kg_s: f32,
    /// Fixed point in closed form [kg/s].
    pub exact_kg_s: f64,
}

impl Settled {
    /// Relative deviation from the fixed point [1].
    pub fn error(&self) -> f64 {
        f64::from(self.flow_kg_s) / self.exact_kg_s - 1.0
    }
}

/// Everything that the experiment found.
#[derive(Debug, Clone)]
pub struct Results {
    /// Method `relaxation` at the paper's steps.
    pub relaxation: Vec<Run>,
    /// Plain Euler at the paper's steps.
    pub euler: Vec<Run>,
    /// Settled flows.
    pub settled: Vec<Settled>,
    /// Time of divergence of plain Euler in `f64` [s], at the paper's steps.
    pub double_diverged_s: Vec<Option<f64>>,
    /// Eigenvalues at the paper's steps.
    pub spectra: Vec<Spectrum>,
    /// Deviation from the reference while the valve closes, at the paper's steps: [s] and [g/s].
    pub transient_errors: Vec<Vec<(f64, f64)>>,
    /// Id of the network.
    pub network_id: u64,
}

impl<'s> Experiment<'s> {
    /// The experiment on `source`; refused where there is no input `valve.opening`.
    pub fn new(source: &'s Source) -> Result<Self, Failure> {
        let slot = source.loaded.names.inputs.iter().position(|name| name == "valve.opening");
        let refused = |text: &str| Failure::BadInput(format!("{}: {text}", source.name));
        let valve = slot.ok_or_else(|| {
            refused("the paper's experiment needs an input `valve.opening`, which this network has not")
        })?;
        let double = DoubleLoop::of(&source.loaded.network()).ok_or_else(|| {
            refused("the paper's experiment needs a loop of quadratic losses as the first line")
        })?;
        Ok(Self { source, valve, double })
    }

    /// Work that [`Self::run`] reports, in ticks and their like.
    pub fn work() -> u64 {
        let runs: u64 = STEPS_US.iter().map(|step| 2 * (UNTIL_US / u64::from(*step))).sum();
        let settling: u64 = SETTLE_STEPS_US.iter().map(|step| 3 * (SETTLE_US / u64::from(*step))).sum();
        runs + settling
    }

    /// Runs everything.
    pub fn run(&self, progress: &Progress) -> Result<Results, Failure> {
        let network = self.source.loaded.network();
        let all = |method: Method| -> Result<Vec<Run>, Failure> {
            STEPS_US
                .iter()
                .map(|step_us| self.closing(Settings { method, step_us: *step_us }, progress))
                .collect()
        };
        let (relaxation, euler) = (all(Method::Relaxation)?, all(Method::Euler)?);
        progress.say("settled flows");
        let mut settled = Vec::new();
        for opening in SETTLE_OPENINGS {
            for step_us in SETTLE_STEPS_US {
                settled.push(self.settle(&network, opening, step_us)?);
                progress.add(SETTLE_US / u64::from(step_us));
            }
        }
        let opening = |time_us| self.opening(&network, time_us);
        let double =
            |step_us: &u32| self.double.plain_euler_diverges_s(u64::from(*step_us), UNTIL_US, opening);
        let double_diverged_s = STEPS_US.iter().map(double).collect();
        progress.say("eigenvalues");
        let range = (CLOSED, 1.0, SWEEP_POINTS);
        let spectrum = |step_us: &u32| Spectrum::compute(&network, 0, self.valve, *step_us, range);
        let spectra: Option<_> = STEPS_US.iter().map(spectrum).collect();
        let spectra =
            spectra.ok_or_else(|| Failure::Failed("the eigenvalue iteration did not converge".into()))?;
        let reference = Reference::stored();
        let transient_errors = relaxation.iter().map(|run| reference.errors_g_s(&run.flow)).collect();
        let network_id = network.id();
        Ok(Results { relaxation, euler, settled, double_diverged_s, spectra, transient_errors, network_id })
    }

    /// Opening of the valve at a time, in `f64`, with straight lines between the schedule's points.
    fn opening(&self, network: &Network<'_>, time_us: u64) -> f64 {
        let schedule = network.schedules.iter().find(|schedule| schedule.input as usize == self.valve);
        let points = schedule.map_or(&[][..], |schedule| {
            let first = schedule.first_point as usize;
            network.points.get(first..first + schedule.points as usize).unwrap_or(&[])
        });
        let next = points.partition_point(|point| point.time_us <= time_us);
        let value = |index: usize| points.get(index).map(|point| f64::from(point.value));
        match (next.checked_sub(1).and_then(value), value(next)) {
            (Some(last), Some(then)) => {
                let (from, to) = (points[next - 1].time_us, points[next].time_us);
                last + (then - last) * (time_us - from) as f64 / (to - from) as f64
            }
            (Some(value), None) | (None, Some(value)) => value,
            (None, None) => network.inputs.get(self.valve).map_or(1.0, |value| f64::from(*value)),
        }
    }

    fn closing(&self, settings: Settings, progress: &Progress) -> Result<Run, Failure> {
        let step = Duration::from_us(u64::from(settings.step_us));
        progress.say(&format!("{} at {step}", settings.method.name()));
        let loaded = &self.source.loaded;
        let network = loaded.network();
        let mut buffers = HostBuffers::default();
        let mut simulator =
            buffers.simulator(&network, settings).map_err(|error| refused(self.source, settings, &error))?;
        let mut trace = Trace::new(columns(loaded), 1);
        let mut flow = vec![(0.0, f64::from(simulator.line_flow_kg_s(0)) * 1e3)];
        trace.note(&simulator);
        let mut fault = None;
        let mut guarded_ticks = 0;
        for _ in 0..UNTIL_US / u64::from(settings.step_us) {
            let health = simulator.step();
            guarded_ticks += u64::from(simulator.margin().proof == Proof::ShortStep);
            trace.note(&simulator);
            flow.push((simulator.time_us() as f64 * 1e-6, f64::from(simulator.line_flow_kg_s(0)) * 1e3));
            progress.add(1);
            if let Health::Faulted(found) = health {
                fault = Some(found);
                break;
            }
        }
        let (worst, unproven_ticks) = (simulator.worst_margin(), simulator.unproven_ticks());
        let (ticks, state_hash) = (simulator.tick(), simulator.state_hash());
        Ok(Run { settings, trace, flow, fault, worst, guarded_ticks, unproven_ticks, ticks, state_hash })
    }

    /// Holds the valve at `opening` until nothing moves.
    fn settle(&self, network: &Network<'_>, opening: f32, step_us: u32) -> Result<Settled, Failure> {
        let mut inputs = network.inputs.to_vec();
        inputs[self.valve] = opening;
        let held = Network { inputs: &inputs, schedules: &[], points: &[], ..*network };
        let mut buffers = HostBuffers::default();
        let settings = Settings { method: Method::Relaxation, step_us };
        let mut simulator =
            buffers.simulator(&held, settings).map_err(|error| refused(self.source, settings, &error))?;
        for _ in 0..SETTLE_US / u64::from(step_us) {
            simulator.step();
        }
        let exact_kg_s = self.double.fixed_point_kg_s(f64::from(opening));
        Ok(Settled { opening, step_us, flow_kg_s: simulator.line_flow_kg_s(0), exact_kg_s })
    }
}
