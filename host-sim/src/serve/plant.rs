//! A plant on this computer: one thread that steps a simulator at the clock's pace and publishes frames.
//!
//! It waits for nobody but the clock. Commands are taken between wake-ups; a simulator is built anew where a scenario
//! begins.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eclss_core::{Health, Network, Place, Settings, Simulator};

use super::feed::{Catalogue, Command, Input, InputState, LineInfo, Malfunction, NodeInfo, Publisher};
use super::pace::{Costs, Pace};
use super::reading::{Reading, values};
use crate::refusal::refused;
use crate::trace::Segments;
use crate::{Closure, Failure, HostBuffers, Source, is_pseudo_time};

/// Time between two frames.
pub const FRAME: Duration = Duration::from_millis(50);
/// Longest time that a wake-up may take before commands are looked at again.
const PATIENCE: Duration = Duration::from_millis(20);
/// Most steps that a command may ask for.
const MOST_STEPS: u32 = 1_000_000;
/// Speed over the clock's.
const SPEEDS: std::ops::RangeInclusive<f32> = 0.01..=1_000.0;

/// The network as its file says.
const AS_WRITTEN: &str = "as in the file";
/// Without its schedules.
const BY_HAND: &str = "by hand";

/// What a plant runs.
#[derive(Debug, Clone)]
pub struct Plant {
    source: Source,
    settings: Settings,
    /// Whether each scenario keeps the schedules.
    scenarios: Vec<(&'static str, bool)>,
}

impl Plant {
    /// A plant of `source`; refused where the method does not take it.
    pub fn new(source: Source, settings: Settings) -> Result<Self, Failure> {
        let mut scenarios = vec![(AS_WRITTEN, true)];
        if !source.loaded.schedules.is_empty() {
            scenarios.push((BY_HAND, false));
        }
        let plant = Self { source, settings, scenarios };
        for (_, scheduled) in &plant.scenarios {
            let network = plant.network(*scheduled);
            let built = HostBuffers::default().simulator(&network, settings).map(|_| ());
            built.map_err(|error| refused(&plant.source, settings, &error))?;
        }
        Ok(plant)
    }

    fn network(&self, scheduled: bool) -> Network<'_> {
        let network = self.source.loaded.network();
        if scheduled { network } else { Network { schedules: &[], points: &[], ..network } }
    }

    /// Slots of the inputs in the order of the catalogue, with their ranges.
    fn inputs(&self) -> Vec<(usize, Input)> {
        let loaded = &self.source.loaded;
        let all = loaded.names.inputs.iter().zip(&loaded.units).zip(&loaded.ranges);
        let input = |((id, unit), &(min, max)): ((&String, &&str), &(f32, f32))| Input {
            id: id.clone(),
            unit: (*unit).to_owned(),
            min,
            max,
        };
        all.map(input).enumerate().collect()
    }

    /// What the page is told once.
    pub fn catalogue(&self, control: bool) -> Catalogue {
        let loaded = &self.source.loaded;
        let graph = crate::schematic::Graph::of(&loaded.file);
        let step = crate::Duration::from_us(u64::from(self.settings.step_us));
        Catalogue {
            title: graph.title.clone(),
            source: self.source.name.clone(),
            plant: "this computer".to_owned(),
            network_id: format!("{:016x}", loaded.network().id()),
            method: format!("{}, step {step}", self.settings.method.name()),
            pseudo_time: is_pseudo_time(self.settings.method),
            reference_pa: loaded.reference_pa,
            control,
            scenarios: self.scenarios.iter().map(|(name, _)| (*name).to_owned()).collect(),
            values: values(loaded, self.settings.method),
            inputs: self.inputs().into_iter().map(|(_, input)| input).collect(),
            nodes: graph
                .nodes
                .iter()
                .zip(&loaded.nodes)
                .map(|(node, data)| NodeInfo {
                    id: node.id.clone(),
                    kind: node.kind.to_owned(),
                    temperature_k: data.temperature_k,
                })
                .collect(),
            lines: graph
                .lines
                .into_iter()
                .map(|line| LineInfo {
                    id: line.id,
                    from: line.from,
                    to: line.to,
                    elements: line.elements.into_iter().map(|element| (element.id, element.kind)).collect(),
                })
                .collect(),
            channels: Vec::new(),
        }
    }

    /// Runs until `stop`. Returns what went wrong, if anything did.
    pub fn run(&self, mut publisher: Publisher, stop: &Arc<AtomicBool>) -> Result<(), Failure> {
        let mut hand = Hand {
            inputs: self.inputs(),
            broken: Vec::new(),
            wanted: Vec::new(),
            paused: false,
            speed: 1.0,
            steps: 0,
            scenario: 0,
            refused: 0,
        };
        let costs = || Failure::Failed("the histogram of costs cannot be made".into());
        let mut costs = Costs::new().ok_or_else(costs)?;
        while !stop.load(Ordering::Relaxed) {
            self.play(&mut hand, &mut costs, &mut publisher, stop)?;
        }
        Ok(())
    }

    /// Runs one scenario until another one is asked for.
    fn play(
        &self,
        hand: &mut Hand,
        costs: &mut Costs,
        publisher: &mut Publisher,
        stop: &Arc<AtomicBool>,
    ) -> Result<(), Failure> {
        let scheduled = self.scenarios.get(hand.scenario).is_none_or(|(_, scheduled)| *scheduled);
        let network = self.network(scheduled);
        let mut buffers = HostBuffers::default();
        let mut simulator = buffers
            .simulator(&network, self.settings)
            .map_err(|error| refused(&self.source, self.settings, &error))?;
        hand.begin(&network);
        let reading = Reading::new(&self.source.loaded);
        let mut ledger = Closure::new(&self.source.loaded);
        let mut segments = Segments::of(&simulator);
        let mut pace = Pace::new(self.settings.step_us);
        pace.set_speed(hand.speed);
        let mut shown = Instant::now().checked_sub(FRAME).unwrap_or_else(Instant::now);
        while !stop.load(Ordering::Relaxed) {
            let due = pace.wait();
            while let Some(command) = publisher.command() {
                match hand.take(command, &mut simulator, &self.scenarios) {
                    Asked::Nothing => {}
                    Asked::Pace => pace.set_speed(hand.speed),
                    Asked::Scenario => return Ok(()),
                }
            }
            let due = if hand.paused { hand.steps } else { due };
            let began = Instant::now();
            let (mut last, mut done) = (began, 0);
            while done < due && last - began < PATIENCE {
                simulator.step();
                done += 1;
                let now = Instant::now();
                costs.note(now - last);
                last = now;
            }
            if hand.paused {
                hand.steps = due - done;
            } else {
                pace.skip(due - done);
            }
            let busy = (last - began).as_secs_f64() / pace.period().as_secs_f64();
            costs.close(last);
            if last - shown >= FRAME {
                shown = if last - shown < 2 * FRAME { shown + FRAME } else { last };
                let closure = ledger.read(&simulator);
                publisher.publish(|frame| {
                    reading.read(&simulator, &mut segments, &mut frame.values);
                    hand.show(&network, &mut frame.inputs);
                    let figures = &mut frame.figures;
                    (figures.tick, figures.t_s) = (simulator.tick(), simulator.time_us() as f64 * 1e-6);
                    (figures.scenario, figures.paused, figures.speed) =
                        (hand.scenario, hand.paused, hand.speed);
                    (figures.overruns, figures.lag_s) = (Some(pace.overruns), pace.lag_s);
                    (figures.mean_us, figures.p99_us) = (costs.mean_us, costs.p99_us);
                    figures.worst_us = costs.worst_us;
                    figures.headroom = 1.0 - busy;
                    figures.phi = simulator.margin().phi;
                    figures.phi_worst = simulator.worst_margin().phi;
                    figures.closure = closure;
                    figures.trusted = simulator.health() == Health::Trusted;
                    (figures.fault_node, figures.fault_line) = match simulator.health() {
                        Health::Trusted => (None, None),
                        Health::Faulted(fault) => match fault.place {
                            Place::Node(node) => (Some(node), None),
                            Place::Line(line) => (None, Some(line)),
                        },
                    };
                    figures.refused = hand.refused;
                });
            }
        }
        Ok(())
    }
}

/// What a command asks of the loop.
enum Asked {
    Nothing,
    Pace,
    Scenario,
}

/// What the operator has set.
struct Hand {
    inputs: Vec<(usize, Input)>,
    broken: Vec<Option<Malfunction>>,
    /// What each slider says, broken or not.
    wanted: Vec<f32>,
    paused: bool,
    speed: f32,
    steps: u32,
    scenario: usize,
    refused: u64,
}

impl Hand {
    fn begin(&mut self, network: &Network<'_>) {
        self.broken = vec![None; self.inputs.len()];
        let start = |(slot, _): &(usize, Input)| network.inputs.get(*slot).copied().unwrap_or(0.0);
        self.wanted = self.inputs.iter().map(start).collect();
    }

    fn take(
        &mut self,
        command: Command,
        simulator: &mut Simulator<'_>,
        scenarios: &[(&'static str, bool)],
    ) -> Asked {
        match command {
            Command::Set { input, value } => {
                let good = match self.inputs.get(input) {
                    Some((slot, spec)) if value.is_finite() => {
                        let value = value.clamp(spec.min, spec.max);
                        let free = self.broken[input].is_none();
                        let taken = if free { simulator.set_input(*slot, value).is_ok() } else { true };
                        if taken {
                            self.wanted[input] = value;
                        }
                        taken
                    }
                    _ => false,
                };
                self.refused += u64::from(!good);
                Asked::Nothing
            }
            Command::Break { input, how } => {
                let Some((slot, spec)) = self.inputs.get(input) else {
                    self.refused += 1;
                    return Asked::Nothing;
                };
                let present = simulator.inputs().get(*slot).copied().unwrap_or(0.0);
                let value = match how {
                    None => self.wanted[input],
                    Some(Malfunction::Stuck) => present,
                    Some(Malfunction::Low) => spec.min,
                    Some(Malfunction::High) => spec.max,
                };
                if simulator.set_input(*slot, value).is_ok() {
                    self.broken[input] = how;
                } else {
                    self.refused += 1;
                }
                Asked::Nothing
            }
            Command::Pause { on } => {
                self.paused = on;
                self.steps = 0;
                Asked::Pace
            }
            Command::Step { steps } => {
                self.paused = true;
                self.steps = steps.min(MOST_STEPS);
                Asked::Nothing
            }
            Command::Speed { factor } if SPEEDS.contains(&factor) => {
                self.speed = factor;
                Asked::Pace
            }
            Command::Scenario { number } if number < scenarios.len() => {
                self.scenario = number;
                Asked::Scenario
            }
            Command::Speed { .. } | Command::Scenario { .. } => {
                self.refused += 1;
                Asked::Nothing
            }
        }
    }

    fn show(&self, network: &Network<'_>, states: &mut [InputState]) {
        for ((slot, _), (broken, state)) in self.inputs.iter().zip(self.broken.iter().zip(states)) {
            let scheduled = network.schedules.iter().any(|schedule| schedule.input as usize == *slot);
            *state = match broken {
                Some(Malfunction::Stuck) => InputState::Stuck,
                Some(Malfunction::Low) => InputState::Low,
                Some(Malfunction::High) => InputState::High,
                None if scheduled => InputState::Scheduled,
                None => InputState::Free,
            };
        }
    }
}
