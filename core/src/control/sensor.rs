//! Sensor: first-order lag, bias, noise, range, and the faults stuck and dropout.
//!
//! `y' = (x − y)/τ`, solved implicitly so that any lag is stable; reading = y + bias + noise, limited to the range.
//! The noise is a function of seed and tick (a mixed counter), so that a run repeats to the bit.

use crate::parameter::ParameterError;
use crate::{Fingerprint, math};

/// Fixed data of one sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sensor {
    /// Lowest reading, in the unit of what is measured; finite, below `max`.
    pub min: f32,
    /// Highest reading.
    pub max: f32,
    /// Time constant τ [s]; finite and ≥ 0.
    pub lag_s: f32,
    /// Standard deviation of the noise, in the unit of what is measured; finite and ≥ 0.
    pub noise: f32,
    /// Seed of the noise.
    pub seed: u32,
}

/// What is wrong with a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensorFault {
    /// Nothing.
    None,
    /// The reading stays where it was.
    Stuck,
    /// The reading falls to the bottom of the range.
    Dropout,
}

impl SensorFault {
    /// The fault of an input: 0 none, 1 stuck, 2 dropout; halves decide.
    #[inline]
    pub fn of_input(value: f32) -> Self {
        match value {
            value if value < 0.5 => Self::None,
            value if value < 1.5 => Self::Stuck,
            _ => Self::Dropout,
        }
    }
}

impl Sensor {
    /// State of a sensor: what it follows; last reading.
    pub const STATE: usize = 2;

    /// State at the start, where `value` is measured.
    pub fn start(&self, value: f32) -> [f32; 2] {
        [value, self.limit(value)]
    }

    /// Measures `value` for one step of `step_s` [s] and returns the reading.
    #[inline]
    pub fn step(
        &self,
        state: &mut [f32; 2],
        value: f32,
        bias: f32,
        fault: SensorFault,
        step_s: f32,
        tick: u64,
    ) -> f32 {
        let [followed, reading] = state;
        *followed += (value - *followed) * (step_s / (self.lag_s + step_s));
        let noise = if self.noise > 0.0 { self.noise * noise(self.seed, tick) } else { 0.0 };
        *reading = match fault {
            SensorFault::None => self.limit(*followed + bias + noise),
            SensorFault::Stuck => *reading,
            SensorFault::Dropout => self.min,
        };
        *reading
    }

    fn limit(&self, value: f32) -> f32 {
        math::smaller(math::larger(value, self.min), self.max)
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("min", self.min)?;
        ParameterError::unless_positive("max", self.max - self.min)?;
        ParameterError::unless_not_negative("lag_s", self.lag_s)?;
        ParameterError::unless_not_negative("noise", self.noise)
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.values(&[self.min, self.max, self.lag_s, self.noise]);
        hash.word(self.seed);
    }
}

/// Noise of mean 0 and variance 1, bounded by ±3.46: the sum of four uniform numbers, which a mixed counter gives
/// (the finaliser of `MurmurHash3`).
fn noise(seed: u32, tick: u64) -> f32 {
    let mix = |mut x: u32| {
        x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
        x ^ (x >> 16)
    };
    let first = mix(seed ^ mix(tick as u32 ^ mix((tick >> 32) as u32 ^ 0x9e37_79b9)));
    let second = mix(first ^ 0x5851_f42d);
    let halves = [first & 0xffff, first >> 16, second & 0xffff, second >> 16];
    let sum: u32 = halves.iter().sum();
    // Mean 2·65535; variance of each (2³² − 1)/12.
    (sum as f32 - 131_070.0) * (1.0 / 37_837.23)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Sensor = Sensor { min: 0.0, max: 100.0, lag_s: 0.0, noise: 0.0, seed: 7 };

    #[test]
    fn a_lag_follows_its_exponential() {
        let sensor = Sensor { lag_s: 5.0, ..PLAIN };
        let mut state = sensor.start(10.0);
        for tick in 0..500 {
            sensor.step(&mut state, 20.0, 0.0, SensorFault::None, 0.01, tick);
        }
        // After one time constant, within the step's own first-order error.
        assert!((state[1] - (20.0 - 10.0 * (-1.0f32).exp())).abs() < 0.005, "{}", state[1]);
    }

    #[test]
    fn noise_has_its_mean_and_deviation_and_repeats() {
        let (mut sum, mut square) = (0.0f64, 0.0f64);
        for tick in 0..100_000u64 {
            let value = f64::from(noise(3, tick));
            sum += value;
            square += value * value;
        }
        assert!((sum / 1e5).abs() < 0.01 && (square / 1e5 - 1.0).abs() < 0.02, "{sum} {square}");
        assert_eq!(noise(3, 17).to_bits(), noise(3, 17).to_bits());
        assert!((noise(3, 17) - noise(4, 17)).abs() > 1e-3 && (noise(3, 17) - noise(3, 18)).abs() > 1e-3);
    }

    #[test]
    fn faults_and_range() {
        let mut state = PLAIN.start(50.0);
        let mut read = |value, bias, fault| PLAIN.step(&mut state, value, bias, fault, 0.01, 0);
        assert!((read(60.0, 1.0, SensorFault::None) - 61.0).abs() < 1e-5);
        assert!((read(70.0, 0.0, SensorFault::Stuck) - 61.0).abs() < 1e-5);
        assert!(read(70.0, 0.0, SensorFault::Dropout).abs() < f32::MIN_POSITIVE);
        assert!((read(170.0, 0.0, SensorFault::None) - 100.0).abs() < 1e-5);
        assert_eq!(SensorFault::of_input(1.0), SensorFault::Stuck);
        assert_eq!(Sensor { max: -1.0, ..PLAIN }.check().unwrap_err().parameter, "max");
    }
}
