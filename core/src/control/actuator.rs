//! Actuator: travels to a commanded position with a rate, sticks until it is asked for enough, and fails.

use crate::parameter::ParameterError;
use crate::{Fingerprint, math};

/// Fixed data of one actuator; its position is 0 closed … 1 open and maps to `closed` … `open` of what it drives.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Actuator {
    /// Fastest travel [1/s]; > 0, finite.
    pub rate_per_s: f32,
    /// Least difference of position that moves it from rest [1]; 0…1.
    pub stiction: f32,
    /// Value of the driven input at position 0, in its unit; finite.
    pub closed: f32,
    /// Value of the driven input at position 1; finite.
    pub open: f32,
}

/// What is wrong with an actuator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActuatorFault {
    /// Nothing.
    None,
    /// Stays where it is.
    Stuck,
    /// Travels to position 1 whatever is commanded.
    Open,
    /// Travels to position 0.
    Closed,
}

impl ActuatorFault {
    /// The fault of an input: 0 none, 1 stuck, 2 open, 3 closed; halves decide.
    #[inline]
    pub fn of_input(value: f32) -> Self {
        match value {
            value if value < 0.5 => Self::None,
            value if value < 1.5 => Self::Stuck,
            value if value < 2.5 => Self::Open,
            _ => Self::Closed,
        }
    }
}

impl ActuatorFault {
    /// Returns the fault of a valve that acts by itself, whose first input it is.
    pub fn of_inputs(inputs: &[f32]) -> Self {
        Self::of_input(inputs.first().copied().unwrap_or(0.0))
    }
}

impl Actuator {
    /// State of an actuator: position [1]; 1 while it travels, 0 at rest.
    pub const STATE: usize = 2;

    /// State at the start with the driven input at `value`.
    pub fn start(&self, value: f32) -> [f32; 2] {
        let range = self.open - self.closed;
        let position = if range.abs() > 0.0 { (value - self.closed) / range } else { 0.0 };
        [math::smaller(math::larger(position, 0.0), 1.0), 0.0]
    }

    /// Moves towards `command` [1] for one step of `step_s` [s] and returns the driven input's value.
    #[inline]
    pub fn step(&self, state: &mut [f32; 2], command: f32, fault: ActuatorFault, step_s: f32) -> f32 {
        let [position, moves] = state;
        let target = match fault {
            ActuatorFault::None => math::smaller(math::larger(command, 0.0), 1.0),
            ActuatorFault::Stuck => *position,
            ActuatorFault::Open => 1.0,
            ActuatorFault::Closed => 0.0,
        };
        let way = target - *position;
        let started = *moves > 0.5 || way.abs() > self.stiction;
        let most = self.rate_per_s * step_s;
        let travel = if started { math::smaller(math::larger(way, -most), most) } else { 0.0 };
        *position += travel;
        *moves = if started && way.abs() > most { 1.0 } else { 0.0 };
        self.closed + *position * (self.open - self.closed)
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("rate_per_s", self.rate_per_s)?;
        ParameterError::unless_fraction("stiction", self.stiction)?;
        ParameterError::unless_finite("closed", self.closed)?;
        ParameterError::unless_finite("open", self.open)
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.values(&[self.rate_per_s, self.stiction, self.closed, self.open]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Actuator = Actuator { rate_per_s: 0.5, stiction: 0.0, closed: 0.02, open: 1.0 };

    #[test]
    fn travels_with_its_rate_and_stops_at_the_command() {
        let mut state = VALVE.start(0.02);
        for _ in 0..100 {
            VALVE.step(&mut state, 0.75, ActuatorFault::None, 0.01);
        }
        assert!((state[0] - 0.5).abs() < 1e-4, "{}", state[0]);
        for _ in 0..100 {
            VALVE.step(&mut state, 0.75, ActuatorFault::None, 0.01);
        }
        assert!((state[0] - 0.75).abs() < 1e-6, "{}", state[0]);
    }

    #[test]
    fn stiction_ignores_small_commands_only() {
        let valve = Actuator { stiction: 0.1, ..VALVE };
        let mut state = valve.start(0.51);
        let rest = state[0];
        valve.step(&mut state, rest + 0.05, ActuatorFault::None, 0.01);
        assert!((state[0] - rest).abs() < f32::MIN_POSITIVE);
        for _ in 0..100 {
            valve.step(&mut state, rest + 0.2, ActuatorFault::None, 0.01);
        }
        assert!((state[0] - (rest + 0.2)).abs() < 1e-5, "{}", state[0]);
    }

    #[test]
    fn faults_win_over_commands() {
        let mut state = VALVE.start(0.5);
        let mut end = |fault| {
            for _ in 0..500 {
                VALVE.step(&mut state, 0.3, fault, 0.01);
            }
            state[0]
        };
        assert!(end(ActuatorFault::Open) >= 1.0);
        assert!(end(ActuatorFault::Stuck) >= 1.0);
        assert!(end(ActuatorFault::Closed) <= 0.0);
        assert!((end(ActuatorFault::of_input(0.0)) - 0.3).abs() < 1e-5);
    }
}
