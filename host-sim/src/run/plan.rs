//! What to run, in whole steps.

use eclss_core::{Method, Settings};

use crate::{Duration, Failure, Source};

/// What the command line says; the rest comes from the file.
#[derive(Debug, Clone, Default)]
pub struct Wishes {
    /// The method.
    pub method: Option<Method>,
    /// Its step.
    pub step: Option<Duration>,
    /// Plant time at the end.
    pub until: Option<Duration>,
    /// Plant times to report.
    pub at: Vec<Duration>,
    /// Time between two rows of the record.
    pub every: Option<Duration>,
}

/// A run in whole steps.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Method and step.
    pub settings: Settings,
    /// Steps to take.
    pub ticks: u64,
    /// Ticks to report, rising.
    pub at_ticks: Vec<u64>,
    /// Ticks between two rows of the record; chosen by length where absent.
    pub every_ticks: Option<u64>,
}

impl Plan {
    /// Joins wishes and file; refuses what is not a whole number of steps or does not fit together.
    pub fn new(source: &Source, wishes: &Wishes) -> Result<Self, Failure> {
        let defaults = source.loaded.run;
        let step_us = Self::step_us(source, wishes)?;
        let settings = Settings { method: wishes.method.unwrap_or(defaults.method), step_us };
        let step = Duration::from_us(u64::from(step_us));
        let whole = |what: &str, time: Duration| {
            if time.us().is_multiple_of(step.us()) {
                Ok(time.us() / step.us())
            } else {
                let text = format!("{what} {time} is not a whole number of steps of {step}");
                Err(Failure::BadInput(format!("{text}; a run has no state between two steps")))
            }
        };
        let at: Result<Vec<_>, _> = wishes.at.iter().map(|time| whole("--at", *time)).collect();
        let mut at_ticks = at?;
        at_ticks.sort_unstable();
        at_ticks.dedup();
        let last = at_ticks.last().copied().unwrap_or(0);
        let ticks = if let Some(until) = wishes.until {
            let ticks = whole("--until", until)?;
            if last > ticks {
                let text = format!("--at {}", Duration::from_us(last * step.us()));
                return Err(Failure::BadInput(format!(
                    "{text} lies behind the end of the run, --until {until}"
                )));
            }
            ticks
        } else {
            whole(&format!("{}: [run] until =", source.name), Duration::from_us(defaults.until_us))?.max(last)
        };
        if at_ticks.is_empty() {
            at_ticks.push(ticks);
        }
        let every_ticks = wishes.every.map(|every| whole("--every", every)).transpose()?;
        if every_ticks == Some(0) {
            return Err(Failure::BadInput("--every 0 s: rows need some time between them".into()));
        }
        Ok(Self { settings, ticks, at_ticks, every_ticks })
    }

    /// The step [µs] that wishes and file ask for.
    pub fn step_us(source: &Source, wishes: &Wishes) -> Result<u32, Failure> {
        let Some(step) = wishes.step else { return Ok(source.loaded.run.step_us) };
        let us = u32::try_from(step.us()).ok().filter(|us| *us > 0);
        us.ok_or_else(|| Failure::BadInput(format!("--step {step}: a step is 1 us or more, and below 1 h")))
    }

    /// The step.
    pub fn step(&self) -> Duration {
        Duration::from_us(u64::from(self.settings.step_us))
    }

    /// The end.
    pub fn until(&self) -> Duration {
        Duration::from_us(self.ticks * u64::from(self.settings.step_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(wishes: &Wishes) -> Result<Plan, String> {
        Plan::new(&Source::shipped().unwrap(), wishes).map_err(|failure| failure.to_string())
    }

    fn time(text: &str) -> Duration {
        text.parse().unwrap()
    }

    #[test]
    fn the_file_says_what_the_command_line_does_not() {
        let plan = plan(&Wishes::default()).unwrap();
        assert_eq!(plan.settings, Settings { method: Method::Relaxation, step_us: 1_000 });
        assert_eq!((plan.ticks, plan.at_ticks), (26_000, vec![26_000]));
    }

    #[test]
    fn times_are_sorted_and_may_lengthen_the_run() {
        let at = vec![time("30s"), time("10s"), time("10s")];
        let plan = plan(&Wishes { at, step: Some(time("10ms")), ..Wishes::default() }).unwrap();
        assert_eq!((plan.ticks, plan.at_ticks), (3_000, vec![1_000, 3_000]));
    }

    #[test]
    fn times_between_two_steps_are_refused_with_a_reason() {
        let error = plan(&Wishes { at: vec![time("1.5ms")], ..Wishes::default() }).unwrap_err();
        assert!(error.contains("1.5 ms is not a whole number of steps of 1 ms"), "{error}");
        let error = plan(&Wishes { until: Some(time("1.5ms")), ..Wishes::default() }).unwrap_err();
        assert!(error.starts_with("--until"), "{error}");
        let error = plan(&Wishes { step: Some(time("7ms")), ..Wishes::default() }).unwrap_err();
        assert!(
            error.contains("networks/paper.toml") && error.contains("[run] until = 26 s is not"),
            "{error}"
        );
    }

    #[test]
    fn times_behind_the_end_and_steps_of_nothing_are_refused() {
        let late = Wishes { at: vec![time("2s")], until: Some(time("1s")), ..Wishes::default() };
        assert!(plan(&late).unwrap_err().contains("behind the end"));
        for step in ["0ms", "2h"] {
            assert!(plan(&Wishes { step: Some(time(step)), ..Wishes::default() }).is_err());
        }
        assert!(plan(&Wishes { every: Some(time("0s")), ..Wishes::default() }).is_err());
    }
}
