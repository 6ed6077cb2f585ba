//! What the operator holds of a plant: sliders, malfunctions, pace.

use eclss_core::climate::ControlLoop;
use eclss_core::{Network, Simulator};

use super::feed::{Command, Input, InputState, Malfunction};

/// Most steps that a command may ask for.
const MOST_STEPS: u32 = 1_000_000;
/// Speed over the clock's.
const SPEEDS: std::ops::RangeInclusive<f32> = 0.01..=1_000.0;
/// Place of `actuator_fault` among the inputs of a control loop.
const ACTUATOR_FAULT: usize = 3;

/// What a command asks of the loop.
pub(super) enum Asked {
    Nothing,
    Pace,
    Scenario,
}

/// What the operator has set.
pub(super) struct Hand {
    inputs: Vec<(usize, Input)>,
    /// The actuator that drives an input, where a control loop does.
    drives: Vec<Option<Drive>>,
    broken: Vec<Option<Malfunction>>,
    /// What each slider says, broken or not.
    wanted: Vec<f32>,
    pub(super) paused: bool,
    pub(super) speed: f32,
    pub(super) steps: u32,
    pub(super) scenario: usize,
    pub(super) refused: u64,
}

/// Where an actuator is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Drive {
    /// Slot of its fault.
    fault: usize,
    /// Whether its open end is the upper end of what it drives.
    open_is_high: bool,
}

impl Drive {
    fn of(control: &ControlLoop, slot: usize) -> Option<Self> {
        let slot = u32::try_from(slot).ok()?;
        if control.drives != slot && control.opposite != slot {
            return None;
        }
        let rises = control.actuator.open > control.actuator.closed;
        // The other way of a three-way valve gets what is left.
        let open_is_high = rises == (control.drives == slot);
        Some(Self { fault: control.first_input as usize + ACTUATOR_FAULT, open_is_high })
    }

    /// What the fault's input says: 0 none, 1 stuck, 2 open, 3 closed.
    fn code(self, how: Option<Malfunction>) -> f32 {
        match how {
            None => 0.0,
            Some(Malfunction::Stuck) => 1.0,
            Some(Malfunction::High) if self.open_is_high => 2.0,
            Some(Malfunction::Low) if !self.open_is_high => 2.0,
            Some(Malfunction::High | Malfunction::Low) => 3.0,
        }
    }

    /// What the fault's input says, backwards.
    fn how(self, code: f32) -> Option<Malfunction> {
        let all = [None, Some(Malfunction::Stuck), Some(Malfunction::Low), Some(Malfunction::High)];
        all.into_iter().find(|how| (self.code(*how) - code).abs() < 0.5).flatten()
    }
}

impl Hand {
    /// A hand on these inputs, each with its slot.
    pub(super) fn new(inputs: Vec<(usize, Input)>) -> Self {
        Self {
            inputs,
            drives: Vec::new(),
            broken: Vec::new(),
            wanted: Vec::new(),
            paused: false,
            speed: 1.0,
            steps: 0,
            scenario: 0,
            refused: 0,
        }
    }

    /// Begins anew with a network.
    pub(super) fn begin(&mut self, network: &Network<'_>) {
        let drive = |(slot, _): &(usize, Input)| {
            network.climate.loops.iter().find_map(|control| Drive::of(control, *slot))
        };
        self.drives = self.inputs.iter().map(drive).collect();
        self.broken = vec![None; self.inputs.len()];
        let start = |(slot, _): &(usize, Input)| network.inputs.get(*slot).copied().unwrap_or(0.0);
        self.wanted = self.inputs.iter().map(start).collect();
    }

    /// Does what a command says.
    pub(super) fn take(
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
                if let Some(drive) = self.drives.get(input).copied().flatten() {
                    let taken = simulator.set_input(drive.fault, drive.code(how)).is_ok();
                    self.refused += u64::from(!taken);
                    return Asked::Nothing;
                }
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

    /// Says what moves each input.
    pub(super) fn show(&self, simulator: &Simulator<'_>, states: &mut [InputState]) {
        let schedules = simulator.network().schedules;
        for (place, state) in states.iter_mut().enumerate().take(self.inputs.len()) {
            let slot = self.inputs[place].0;
            let drive = self.drives.get(place).copied().flatten();
            let broken = match drive {
                // The fault may have been set by its own input too.
                Some(drive) => simulator.inputs().get(drive.fault).and_then(|code| drive.how(*code)),
                None => self.broken.get(place).copied().flatten(),
            };
            *state = match broken {
                Some(Malfunction::Stuck) => InputState::Stuck,
                Some(Malfunction::Low) => InputState::Low,
                Some(Malfunction::High) => InputState::High,
                None if drive.is_some() => InputState::Controlled,
                None if schedules.iter().any(|schedule| schedule.input as usize == slot) => {
                    InputState::Scheduled
                }
                None => InputState::Free,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HostBuffers, Source};
    use eclss_core::{Method, Settings};

    #[test]
    fn a_valve_that_a_controller_drives_fails_by_its_actuator() {
        let text = include_str!("../../../networks/thcs.toml");
        let source = Source::built_in(text, "networks/thcs.toml").unwrap();
        let network = source.loaded.network();
        let mut buffers = HostBuffers::default();
        let settings = Settings { method: Method::ImplicitEuler, step_us: 10_000 };
        let mut simulator = buffers.simulator(&network, settings).unwrap();
        let input = |id: &str| source.loaded.names.inputs.iter().position(|name| name == id).unwrap();
        let spec =
            |id: &String| Input { id: id.clone(), unit: "1".into(), display: "ratio", min: 0.0, max: 1.0 };
        let mut hand = Hand::new(source.loaded.names.inputs.iter().map(spec).enumerate().collect());
        hand.begin(&network);
        let mut states = vec![InputState::Free; source.loaded.names.inputs.len()];
        let (che, bypass) = (input("che_valve.opening"), input("bypass_valve.opening"));
        hand.show(&simulator, &mut states);
        assert_eq!(
            (states[che], states[input("fan.speed")]),
            (InputState::Controlled, InputState::Scheduled)
        );
        for (how, state, other, opening) in [
            (Malfunction::Low, InputState::Low, InputState::High, 0.1),
            (Malfunction::High, InputState::High, InputState::Low, 1.0),
        ] {
            hand.take(Command::Break { input: che, how: Some(how) }, &mut simulator, &[]);
            for _ in 0..3_000 {
                simulator.step();
            }
            hand.show(&simulator, &mut states);
            assert_eq!((states[che], states[bypass]), (state, other));
            let [at, rest] = [che, bypass].map(|slot| simulator.inputs()[slot]);
            assert!((at - opening).abs() < 1e-3 && (at + rest - 1.1).abs() < 1e-3, "{at} and {rest}");
        }
        hand.take(Command::Break { input: che, how: None }, &mut simulator, &[]);
        simulator.step();
        hand.show(&simulator, &mut states);
        assert_eq!((states[che], hand.refused), (InputState::Controlled, 0));
        // A slider cannot move what a controller moves.
        hand.take(Command::Set { input: che, value: 0.5 }, &mut simulator, &[]);
        assert_eq!(hand.refused, 1);
    }
}
