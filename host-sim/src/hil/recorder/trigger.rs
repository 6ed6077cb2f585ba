//! Captures: what happened tick by tick around a moment that matters.

use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;

use super::super::handover::Row;

/// What starts a capture.
#[derive(Debug, Clone, PartialEq)]
pub enum Trigger {
    /// A tick ran over the next release.
    Overrun,
    /// The loop went to SAFE.
    Safe,
    /// A figure crossed a level.
    Level {
        /// Name of the figure.
        name: String,
        /// Whether it has to rise above the level, or fall below it.
        above: bool,
        /// The level, in the figure's unit.
        level: f32,
    },
}

impl FromStr for Trigger {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "overrun" => return Ok(Self::Overrun),
            "safe" => return Ok(Self::Safe),
            _ => {}
        }
        let above = text.contains('>');
        let parts = text.split_once(['>', '<']).map(|(name, level)| (name.trim(), level.trim().parse()));
        match parts {
            Some((name, Ok(level))) if !name.is_empty() && f32::is_finite(level) => {
                Ok(Self::Level { name: name.into(), above, level })
            }
            _ => Err("there are overrun, safe, NAME>VALUE and NAME<VALUE".into()),
        }
    }
}

impl fmt::Display for Trigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Overrun => f.write_str("overrun"),
            Self::Safe => f.write_str("safe"),
            Self::Level { name, above, level } => {
                write!(f, "{name}{}{level}", if *above { '>' } else { '<' })
            }
        }
    }
}

/// A trigger whose figure has been found.
#[derive(Debug)]
struct Watch {
    trigger: Trigger,
    figure: usize,
    was: bool,
}

/// Watches rows and gives out those around each trigger.
#[derive(Debug)]
pub struct Capture {
    watches: Vec<Watch>,
    before: VecDeque<Row>,
    keep: usize,
    after: u64,
    left: u64,
    captures: u32,
}

/// What a row means for captures.
#[derive(Debug, PartialEq)]
pub enum Captured {
    /// Nothing.
    Nothing,
    /// A capture begins: these rows, the last of which pulled the trigger.
    Begins {
        /// Number of the capture, from 1.
        number: u32,
        /// What pulled.
        by: String,
        /// Rows up to now.
        rows: Vec<Row>,
    },
    /// The row belongs to the capture that is under way.
    GoesOn,
    /// The row belongs to it and is its last.
    Ends,
}

impl Capture {
    /// Watches for `triggers` and keeps `before` ticks before and `after` ticks after each.
    pub fn new(triggers: &[Trigger], names: &[String], before: usize, after: u64) -> Result<Self, String> {
        let watch = |trigger: &Trigger| {
            let figure = match trigger {
                Trigger::Level { name, .. } => {
                    names.iter().position(|known| known == name).ok_or_else(|| {
                        format!("nothing recorded is called `{name}`; there are {}", names.join(", "))
                    })?
                }
                Trigger::Overrun | Trigger::Safe => 0,
            };
            Ok::<_, String>(Watch { trigger: trigger.clone(), figure, was: true })
        };
        let watches = triggers.iter().map(watch).collect::<Result<_, _>>()?;
        Ok(Self { watches, before: VecDeque::new(), keep: before, after, left: 0, captures: 0 })
    }

    /// Takes a tick.
    pub fn add(&mut self, row: &Row) -> Captured {
        if self.watches.is_empty() {
            return Captured::Nothing;
        }
        let pulled = self.pulled(row);
        if self.left > 0 {
            // Pulled again: it goes on for longer.
            self.left = if pulled.is_some() { self.after } else { self.left - 1 };
            return if self.left == 0 { Captured::Ends } else { Captured::GoesOn };
        }
        let Some(by) = pulled else {
            self.before.push_back(row.clone());
            if self.before.len() > self.keep {
                self.before.pop_front();
            }
            return Captured::Nothing;
        };
        self.captures += 1;
        self.left = self.after;
        let rows = self.before.drain(..).chain([row.clone()]).collect();
        Captured::Begins { number: self.captures, by, rows }
    }

    /// Captures so far.
    pub fn captures(&self) -> u32 {
        self.captures
    }

    /// The first trigger that this row pulls: the one in which a condition begins to hold.
    fn pulled(&mut self, row: &Row) -> Option<String> {
        let mut by = None;
        for watch in &mut self.watches {
            let holds = match &watch.trigger {
                Trigger::Overrun => row.head.skipped > 0,
                Trigger::Safe => row.head.mode == eclss_core::mode::Mode::Safe as u8,
                Trigger::Level { above, level, .. } => {
                    let value = row.figures.get(watch.figure).copied().unwrap_or(f32::NAN);
                    if *above { value > *level } else { value < *level }
                }
            };
            // What holds from the first row on has not begun to.
            let begins = holds && !watch.was;
            watch.was = holds;
            if begins && by.is_none() {
                by = Some(watch.trigger.to_string());
            }
        }
        by
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::handover::Head;
    use super::*;

    fn row(tick: u64, value: f32) -> Row {
        Row { head: Head { tick, ..Head::default() }, inputs: Vec::new(), figures: vec![value] }
    }

    #[test]
    fn triggers_are_read_or_refused() {
        let level = |name: &str, above, level| Ok(Trigger::Level { name: name.into(), above, level });
        assert_eq!("overrun".parse(), Ok(Trigger::Overrun));
        assert_eq!("loop.mass_flow > 0.05".parse(), level("loop.mass_flow", true, 0.05));
        assert_eq!("p<-3".parse(), level("p", false, -3.0));
        for wrong in ["", ">1", "p>", "p>x", "p>inf", "p"] {
            assert!(wrong.parse::<Trigger>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_ticks_around_a_crossing_are_given_out() {
        let names = ["p".to_owned()];
        let mut capture = Capture::new(&["p>1".parse().unwrap()], &names, 3, 2).unwrap();
        let mut taken = Vec::new();
        for tick in 0..40 {
            let row = row(tick, if (10..12).contains(&tick) || tick == 30 { 2.0 } else { 0.0 });
            match capture.add(&row) {
                Captured::Nothing => {}
                Captured::Begins { rows, by, .. } => {
                    assert_eq!(by, "p>1");
                    taken.extend(rows.iter().map(|row| row.head.tick));
                }
                Captured::GoesOn | Captured::Ends => taken.push(row.head.tick),
            }
        }
        assert_eq!(taken, [7, 8, 9, 10, 11, 12, 27, 28, 29, 30, 31, 32]);
        assert_eq!(capture.captures(), 2);
        // Nothing around it: the row that pulled, alone, each time.
        let mut capture = Capture::new(&["p>1".parse().unwrap()], &names, 0, 0).unwrap();
        let rows = (0..8).map(|tick| capture.add(&row(tick, if tick % 4 == 2 { 2.0 } else { 0.0 })));
        let begun: Vec<usize> = rows
            .filter_map(|taken| match taken {
                Captured::Nothing => None,
                Captured::Begins { rows, .. } => Some(rows.len()),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(begun, [1, 1]);
        assert!(Capture::new(&["q>1".parse().unwrap()], &names, 3, 2).is_err());
    }
}
