//! Limit monitor: says which limits a cabin's air breaks.
//!
//! Source: NASA-STD-3001 vol. 2, quoted second hand: carbon dioxide ≤ 3 mmHg as a mean over an hour, off-nominal 15,
//! emergency 20 mmHg; inspired oxygen (p − 47 mmHg)·x, x its share of dry gas, 145–155 mmHg, lowest 127; total 34.5–103 kPa; 18–27 °C; relative
//! humidity 25–75 %. Unverified station-class values: dew point 4.4–15.6 °C, total 97.9–102.7 kPa, oxygen 19.5–23.1 kPa.
//! The mean over an hour is one of sixty means over a minute.

use super::Readings;
use crate::fluid::medium::{CARBON_DIOXIDE, OXYGEN, VAPOUR};

/// A millimetre of mercury [Pa].
pub const MMHG_PA: f32 = 133.322;
/// Vapour pressure in the lungs [mmHg].
const LUNGS_MMHG: f32 = 47.0;
/// Minutes in the mean of carbon dioxide.
const MINUTES: usize = 60;

/// A limit that can be broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Limit {
    /// Carbon dioxide over 3 mmHg as a mean over the last hour.
    CarbonDioxideHour,
    /// Carbon dioxide over 15 mmHg.
    CarbonDioxideOffNominal,
    /// Carbon dioxide over 20 mmHg.
    CarbonDioxideEmergency,
    /// Inspired oxygen outside 145–155 mmHg.
    InspiredOxygen,
    /// Inspired oxygen below 127 mmHg.
    InspiredOxygenLowest,
    /// Total pressure outside 34.5–103 kPa.
    Pressure,
    /// Temperature outside 18–27 °C.
    Temperature,
    /// Relative humidity outside 25–75 %.
    RelativeHumidity,
    /// Dew point outside 4.4–15.6 °C (unverified).
    DewPoint,
    /// Total pressure outside 97.9–102.7 kPa (unverified).
    StationPressure,
    /// Partial pressure of oxygen outside 19.5–23.1 kPa (unverified).
    StationOxygen,
    /// Ventilation too weak for one well-mixed volume: all readings are means that nobody breathes.
    NotMixed,
    /// Temperature held at an end of the range that is followed; the energy goes on counting.
    Held,
    /// More than [`FOGGED`] of saturation: fog.
    Fog,
    /// A volume of air of which next to nothing is left.
    Vacuum,
    /// Water as coolant below 0 °C: it would freeze, here it goes on flowing.
    Ice,
}

/// Relative humidity above which a volume counts as fogged [1]: saturation, and what one step may bring.
pub const FOGGED: f32 = 1.02;

impl Limit {
    /// All limits, in the order of the bits of [`Broken`].
    pub const ALL: [Self; 16] = [
        Self::CarbonDioxideHour,
        Self::CarbonDioxideOffNominal,
        Self::CarbonDioxideEmergency,
        Self::InspiredOxygen,
        Self::InspiredOxygenLowest,
        Self::Pressure,
        Self::Temperature,
        Self::RelativeHumidity,
        Self::DewPoint,
        Self::StationPressure,
        Self::StationOxygen,
        Self::NotMixed,
        Self::Held,
        Self::Fog,
        Self::Vacuum,
        Self::Ice,
    ];

    /// What it says, for people.
    pub const fn text(self) -> &'static str {
        match self {
            Self::CarbonDioxideHour => "carbon dioxide over 3 mmHg, mean of an hour",
            Self::CarbonDioxideOffNominal => "carbon dioxide over 15 mmHg",
            Self::CarbonDioxideEmergency => "carbon dioxide over 20 mmHg",
            Self::InspiredOxygen => "inspired oxygen outside 145–155 mmHg",
            Self::InspiredOxygenLowest => "inspired oxygen below 127 mmHg",
            Self::Pressure => "total pressure outside 34.5–103 kPa",
            Self::Temperature => "temperature outside 18–27 °C",
            Self::RelativeHumidity => "relative humidity outside 25–75 %",
            Self::DewPoint => "dew point outside 4.4–15.6 °C (unverified limit)",
            Self::StationPressure => "total pressure outside 97.9–102.7 kPa (unverified limit)",
            Self::StationOxygen => "oxygen outside 19.5–23.1 kPa (unverified limit)",
            Self::NotMixed => "ventilation too weak for one well-mixed volume",
            Self::Held => "temperature held at 50 or 395 K, the ends of what is followed",
            Self::Fog => "relative humidity over 102 %: fog",
            Self::Vacuum => "next to nothing left of its air",
            Self::Ice => "water as coolant below 0 °C: it would freeze",
        }
    }
}

/// The limits that are broken now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Broken(u32);

impl Broken {
    /// Whether `limit` is broken.
    pub fn has(self, limit: Limit) -> bool {
        self.0 & (1 << limit as u32) != 0
    }

    /// Whether none is.
    pub fn is_none(self) -> bool {
        self.0 == 0
    }

    pub(super) fn set(&mut self, limit: Limit, broken: bool) {
        self.0 |= u32::from(broken) << limit as u32;
    }
}

/// Watches the air of one cabin.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    minutes: [f32; MINUTES],
    filled: usize,
    next: usize,
    sum_pa_s: f32,
    time_s: f32,
}

impl Default for Monitor {
    fn default() -> Self {
        Self { minutes: [0.0; MINUTES], filled: 0, next: 0, sum_pa_s: 0.0, time_s: 0.0 }
    }
}

impl Monitor {
    /// Takes readings that hold for `time_s` [s, > 0, at most a minute or so] and returns what they break.
    pub fn watch(&mut self, air: &Readings, time_s: f32) -> Broken {
        let [carbon_dioxide, oxygen] = [air.partial_pa[CARBON_DIOXIDE], air.partial_pa[OXYGEN]];
        self.sum_pa_s += carbon_dioxide * time_s;
        self.time_s += time_s;
        if self.time_s >= 60.0 {
            if let Some(minute) = self.minutes.get_mut(self.next) {
                *minute = self.sum_pa_s / self.time_s;
            }
            self.next = (self.next + 1) % MINUTES;
            self.filled = (self.filled + 1).min(MINUTES);
            (self.sum_pa_s, self.time_s) = (0.0, 0.0);
        }
        // In the lungs vapour is at its own pressure, whatever the cabin's is: x is the share of dry gas.
        let dry_pa = air.pressure_pa - air.partial_pa[VAPOUR];
        let inspired = (air.pressure_pa / MMHG_PA - LUNGS_MMHG) * oxygen / dry_pa;
        let celsius = air.temperature_k - crate::moist::ZERO_CELSIUS_K;
        let dew_point = air.dew_point_k - crate::moist::ZERO_CELSIUS_K;
        // What is no number breaks every limit, as in a vacuum, where nothing has a share.
        let outside = |value: f32, least: f32, most: f32| !(least..=most).contains(&value);
        let over = |value: f32, mmhg: f32| outside(value, f32::MIN, mmhg * MMHG_PA);
        let mut broken = Broken::default();
        broken.set(Limit::CarbonDioxideHour, over(self.hour_pa(), 3.0));
        broken.set(Limit::CarbonDioxideOffNominal, over(carbon_dioxide, 15.0));
        broken.set(Limit::CarbonDioxideEmergency, over(carbon_dioxide, 20.0));
        broken.set(Limit::InspiredOxygen, outside(inspired, 145.0, 155.0));
        broken.set(Limit::InspiredOxygenLowest, outside(inspired, 127.0, f32::MAX));
        broken.set(Limit::Pressure, outside(air.pressure_pa, 34.5e3, 103e3));
        broken.set(Limit::Temperature, outside(celsius, 18.0, 27.0));
        broken.set(Limit::RelativeHumidity, outside(air.relative_humidity, 0.25, 0.75));
        broken.set(Limit::DewPoint, outside(dew_point, 4.4, 15.6));
        broken.set(Limit::StationPressure, outside(air.pressure_pa, 97.9e3, 102.7e3));
        broken.set(Limit::StationOxygen, outside(oxygen, 19.5e3, 23.1e3));
        broken.set(Limit::NotMixed, !air.mixed);
        broken
    }

    /// Mean of carbon dioxide over the last hour, or what there is of it [Pa]; 0 within the first minute.
    pub fn hour_pa(&self) -> f32 {
        let sum: f32 = self.minutes.iter().take(self.filled).sum();
        if self.filled > 0 { sum / self.filled as f32 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn air() -> Readings {
        Readings {
            temperature_k: 295.35,
            pressure_pa: 101_325.0,
            partial_pa: [78_500.0, 21_200.0, 350.0, 1_200.0, 0.0, 0.0],
            dew_point_k: 282.8,
            relative_humidity: 0.45,
            liquid_kg: 0.0,
            turnover_s: 500.0,
            mixed: true,
        }
    }

    #[test]
    fn good_air_breaks_nothing_and_every_limit_can_be_broken_alone() {
        assert!(Monitor::default().watch(&air(), 1.0).is_none());
        let cases = [
            (Limit::Temperature, Readings { temperature_k: 301.0, ..air() }),
            (Limit::RelativeHumidity, Readings { relative_humidity: 0.8, ..air() }),
            (Limit::DewPoint, Readings { dew_point_k: 290.0, ..air() }),
            (Limit::NotMixed, Readings { mixed: false, ..air() }),
        ];
        for (limit, air) in cases {
            let broken = Monitor::default().watch(&air, 1.0);
            let others = Limit::ALL.into_iter().filter(|other| *other != limit);
            assert!(broken.has(limit) && others.into_iter().all(|other| !broken.has(other)), "{limit:?}");
        }
        let thin =
            Readings { pressure_pa: 70_000.0, partial_pa: [55e3, 14e3, 350.0, 650.0, 0.0, 0.0], ..air() };
        let broken = Monitor::default().watch(&thin, 1.0);
        assert!(broken.has(Limit::InspiredOxygenLowest) && broken.has(Limit::StationPressure));
        assert!(!broken.has(Limit::Pressure));
    }

    #[test]
    fn nothing_to_breathe_and_no_number_at_all_break_the_limits() {
        let vacuum = Readings { pressure_pa: 0.0, partial_pa: [0.0; 6], relative_humidity: 0.0, ..air() };
        let broken = Monitor::default().watch(&vacuum, 1.0);
        assert!(broken.has(Limit::InspiredOxygenLowest) && broken.has(Limit::InspiredOxygen));
        let unknown = Readings { partial_pa: [f32::NAN; 6], ..air() };
        let broken = Monitor::default().watch(&unknown, 60.0);
        for limit in [
            Limit::CarbonDioxideHour,
            Limit::CarbonDioxideOffNominal,
            Limit::CarbonDioxideEmergency,
            Limit::InspiredOxygenLowest,
            Limit::StationOxygen,
        ] {
            assert!(broken.has(limit), "{limit:?}");
        }
    }

    #[test]
    fn a_short_peak_of_carbon_dioxide_does_not_break_the_mean_of_an_hour() {
        let mut monitor = Monitor::default();
        let peak = Readings { partial_pa: [78e3, 21.2e3, 4.0 * MMHG_PA, 1.2e3, 0.0, 0.0], ..air() };
        for _ in 0..3_600 {
            monitor.watch(&air(), 1.0);
        }
        for second in 0..3_600 {
            let broken = monitor.watch(&peak, 1.0);
            // 350 Pa for an hour, then 533 Pa: the mean passes 400 Pa after 0.273 h.
            let exact = 350.0 + 183.29 * ((second + 1) / 60) as f32 / 60.0;
            assert!((monitor.hour_pa() - exact).abs() < 0.1, "{second}");
            assert_eq!(broken.has(Limit::CarbonDioxideHour), exact > 3.0 * MMHG_PA, "{second}");
        }
    }
}
