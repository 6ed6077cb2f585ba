//! A plant on this computer: one thread that steps a simulator at the clock's pace and publishes frames.
//!
//! It waits for nobody but the clock. Commands are taken between wake-ups; a simulator is built anew where a scenario
//! begins.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eclss_core::signal::OutputSpec;
use eclss_core::{Health, Network, Place, Settings};

use super::feed::{Catalogue, Input, LineInfo, NodeInfo, Publisher, Value};
use super::hand::{Asked, Hand};
use super::pace::{Costs, Pace};
use super::reading::{published, signals};
use crate::refusal::refused;
use crate::{Closure, Failure, HostBuffers, Source, is_pseudo_time};

/// Time between two frames.
pub const FRAME: Duration = Duration::from_millis(50);
/// Longest time that a wake-up may take before commands are looked at again.
const PATIENCE: Duration = Duration::from_millis(20);

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

    /// Where the network came from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    fn network(&self, scheduled: bool) -> Network<'_> {
        let network = self.source.loaded.network();
        if scheduled { network } else { Network { schedules: &[], points: &[], ..network } }
    }

    /// Slots of the inputs in the order of the catalogue, with their ranges.
    fn inputs(&self) -> Vec<(usize, Input)> {
        let loaded = &self.source.loaded;
        let all = loaded.names.inputs.iter().zip(&loaded.input_specs).zip(&loaded.ranges);
        let input = |((id, spec), &(min, max)): ((&String, &OutputSpec), &(f32, f32))| Input {
            id: id.clone(),
            unit: spec.unit().to_owned(),
            display: spec.display.name(),
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
            values: published(loaded, self.settings.method).iter().map(Value::of).collect(),
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
        let mut hand = Hand::new(self.inputs());
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
        let signals = signals(&self.source.loaded, self.settings.method);
        let mut ledger = Closure::new(&self.source.loaded);
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
                    simulator.read_signals(&signals, &mut frame.values);
                    hand.show(&simulator, &mut frame.inputs);
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
                    figures.fault = simulator.excursion();
                    figures.warn(simulator.first_warning());
                    figures.refused = hand.refused;
                });
            }
        }
        Ok(())
    }
}
