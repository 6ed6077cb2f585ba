//! Controllers: PID with dead band, anti-windup and rate limit; thermostat with hysteresis.
//!
//! ```text
//! e = setpoint − reading (0 within the dead band, else beyond it)
//! u = bias + K·(e + ∫e/T_i − T_d·d(reading)/dt), limited to 0…1 and in rate
//! ```
//!
//! Anti-windup: the integral stands still while u is at a limit and e would drive it further out. The output is a
//! share of the actuator's range. A gain below 0 makes a controller that cools.

use crate::parameter::{ParameterError, Reason};
use crate::{Fingerprint, math};

/// Fixed data of a PID controller.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pid {
    /// Gain K, share of the output per unit of the reading; finite, not 0.
    pub gain: f32,
    /// Integral time `T_i` [s]; > 0, infinite for none.
    pub integral_s: f32,
    /// Derivative time `T_d` [s]; finite and ≥ 0.
    pub derivative_s: f32,
    /// Half width of the dead band, in the unit of the reading; finite and ≥ 0.
    pub dead_band: f32,
    /// Output without error [1]; 0…1.
    pub bias: f32,
    /// Fastest change of the output [1/s]; > 0, infinite for none.
    pub rate_per_s: f32,
}

/// Fixed data of a thermostat: full output from `half_band` on one side of the setpoint to `half_band` on the other.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Thermostat {
    /// Half width of the hysteresis, in the unit of the reading; finite and > 0.
    pub half_band: f32,
    /// Whether a high reading switches on (a cooler, a remover) instead of a low one.
    pub on_when_high: bool,
}

/// A controller of either kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Controller {
    /// Continuous.
    Pid(Pid),
    /// On and off.
    Thermostat(Thermostat),
}

impl Controller {
    /// State of a controller: share that the integral adds, and its carry; last reading; last output.
    pub const STATE: usize = 4;

    /// State at the start with this reading and this output.
    pub fn start(&self, reading: f32, output: f32) -> [f32; 4] {
        let integral = match self {
            // Bumpless: with no error the output stays.
            Self::Pid(pid) => output - pid.bias,
            Self::Thermostat(_) => 0.0,
        };
        [integral, 0.0, reading, output]
    }

    /// Returns the output [0…1] for `reading` and `setpoint` after one step of `step_s` [s].
    #[inline]
    pub fn step(&self, state: &mut [f32; 4], setpoint: f32, reading: f32, step_s: f32) -> f32 {
        match self {
            Self::Pid(pid) => pid.step(state, setpoint, reading, step_s),
            Self::Thermostat(thermostat) => thermostat.step(state, setpoint, reading),
        }
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Pid(pid) => pid.check(),
            Self::Thermostat(thermostat) => {
                ParameterError::unless_positive("half_band", thermostat.half_band)
            }
        }
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        match self {
            Self::Pid(pid) => {
                hash.word(1);
                hash.values(&[pid.gain, pid.integral_s, pid.derivative_s]);
                hash.values(&[pid.dead_band, pid.bias, pid.rate_per_s]);
            }
            Self::Thermostat(thermostat) => {
                hash.word(2 + u32::from(thermostat.on_when_high));
                hash.value(thermostat.half_band);
            }
        }
    }
}

impl Pid {
    #[inline]
    fn step(&self, state: &mut [f32; 4], setpoint: f32, reading: f32, step_s: f32) -> f32 {
        let [integral, carry, last, output] = state;
        let error = setpoint - reading;
        let within = math::smaller(math::larger(error, -self.dead_band), self.dead_band);
        let error = error - within;
        let slope = (reading - *last) / step_s;
        *last = reading;
        let proportional = self.bias + self.gain * (error - self.derivative_s * slope);
        let growth = self.gain * error * (step_s / self.integral_s);
        let wanted = proportional + (*integral + growth);
        let inside = (0.0..=1.0).contains(&wanted);
        let returns = (wanted > 1.0 && growth < 0.0) || (wanted < 0.0 && growth > 0.0);
        let growth = if inside || returns { growth } else { 0.0 };
        math::compensated_add(integral, carry, growth);
        let limited = math::smaller(math::larger(wanted, 0.0), 1.0);
        let most = self.rate_per_s * step_s;
        *output += math::smaller(math::larger(limited - *output, -most), most);
        *output
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("gain", self.gain)?;
        ParameterError::unless_positive("gain", self.gain.abs())?;
        ParameterError::unless_not_negative("derivative_s", self.derivative_s)?;
        ParameterError::unless_not_negative("dead_band", self.dead_band)?;
        ParameterError::unless_fraction("bias", self.bias)?;
        for (parameter, value) in [("integral_s", self.integral_s), ("rate_per_s", self.rate_per_s)] {
            // Infinite means none; NaN is neither.
            if value.is_nan() || value <= 0.0 {
                return Err(ParameterError { parameter, reason: Reason::NotPositive });
            }
        }
        Ok(())
    }
}

impl Thermostat {
    #[inline]
    fn step(self, state: &mut [f32; 4], setpoint: f32, reading: f32) -> f32 {
        let [_, _, last, output] = state;
        *last = reading;
        let error = if self.on_when_high { reading - setpoint } else { setpoint - reading };
        if error > self.half_band {
            *output = 1.0;
        } else if error < -self.half_band {
            *output = 0.0;
        }
        *output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PI: Pid = Pid {
        gain: 0.5,
        integral_s: 10.0,
        derivative_s: 0.0,
        dead_band: 0.0,
        bias: 0.0,
        rate_per_s: f32::INFINITY,
    };

    /// Reading of a first-order plant of time constant 20 s and gain 4 after `seconds` under control.
    fn closed_loop(pid: Pid, setpoint: f32, seconds: u32) -> (f32, f32) {
        let controller = Controller::Pid(pid);
        let (mut reading, mut most) = (0.0f32, 0.0f32);
        let mut state = controller.start(reading, 0.0);
        for _ in 0..100 * seconds {
            let output = controller.step(&mut state, setpoint, reading, 0.01);
            reading += 0.01 * (4.0 * output - reading) / 20.0;
            most = most.max(reading);
        }
        (reading, most)
    }

    #[test]
    fn the_integral_removes_the_error() {
        let (reading, _) = closed_loop(PI, 2.0, 300);
        assert!((reading - 2.0).abs() < 1e-3, "{reading}");
    }

    #[test]
    fn an_unreachable_setpoint_does_not_wind_the_integral_up() {
        let controller = Controller::Pid(PI);
        let mut state = controller.start(0.0, 0.0);
        for _ in 0..100_000 {
            controller.step(&mut state, 100.0, 0.0, 0.01);
        }
        assert!(state[0] <= 1.0, "{}", state[0]);
        // Back within one integral time.
        for _ in 0..1_000 {
            controller.step(&mut state, 0.0, 1.0, 0.01);
        }
        assert!(state[3] < 0.5, "{}", state[3]);
    }

    #[test]
    fn dead_band_and_rate_limit_hold() {
        let (reading, _) = closed_loop(Pid { dead_band: 0.3, ..PI }, 2.0, 600);
        assert!((1.69..=2.31).contains(&reading), "{reading}");
        let controller = Controller::Pid(Pid { rate_per_s: 0.1, ..PI });
        let mut state = controller.start(0.0, 0.0);
        let output = controller.step(&mut state, 100.0, 0.0, 0.01);
        assert!((output - 0.001).abs() < 1e-6, "{output}");
    }

    #[test]
    fn a_thermostat_switches_at_both_ends_of_its_band() {
        let controller = Controller::Thermostat(Thermostat { half_band: 0.5, on_when_high: true });
        let mut state = controller.start(20.0, 0.0);
        let mut at = |reading| controller.step(&mut state, 20.0, reading, 0.01) > 0.5;
        assert!(!at(20.4) && at(20.6) && at(19.6) && !at(19.4) && !at(20.4));
    }

    #[test]
    fn bad_parameters_are_named() {
        let check = |pid: Pid| Controller::Pid(pid).check().unwrap_err().parameter;
        assert_eq!(check(Pid { gain: 0.0, ..PI }), "gain");
        assert_eq!(check(Pid { integral_s: f32::NAN, ..PI }), "integral_s");
        assert!(Controller::Pid(PI).check().is_ok());
    }
}
