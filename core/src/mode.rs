//! Modes of a plant that hardware may hang on: what may change into what, who may ask for it, and what inputs,
//! plant, outputs and clock do meanwhile.
//!
//! ```text
//! POWERUP → INIT → READY → RUN ⇄ HOLD      any → SAFE, latched until acknowledged
//! ```
//!
//! Both tables stand in `docs/hil.md` as well; a test compares them. An emergency stop is a wire that removes
//! power, and software only reads it: SAFE is no substitute.

use crate::Fault;

/// What the loop is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Nothing has been checked yet.
    PowerUp,
    /// The plant is brought to its start: a steady state, or the state that the file gives.
    Init,
    /// The plant stands at its start and outputs go there, each at its rate.
    Ready,
    /// Plant and hardware are coupled.
    Run,
    /// Plant time stands, outputs stay as they are.
    Hold,
    /// Something went wrong: outputs go to their safe values and stay there until somebody acknowledges it.
    Safe,
}

impl Mode {
    /// Every mode, in the order of [`CONDUCT`].
    pub const ALL: [Self; 6] = [Self::PowerUp, Self::Init, Self::Ready, Self::Run, Self::Hold, Self::Safe];

    /// The name, as in logs and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::PowerUp => "POWERUP",
            Self::Init => "INIT",
            Self::Ready => "READY",
            Self::Run => "RUN",
            Self::Hold => "HOLD",
            Self::Safe => "SAFE",
        }
    }

    /// Whether hardware is driven by the plant: pause, single step and scaled time are refused then.
    pub fn is_armed(self) -> bool {
        matches!(self, Self::Run | Self::Hold)
    }

    /// What the loop does in this mode.
    pub fn conduct(self) -> &'static Conduct {
        let [power_up, init, ready, run, hold, safe] = &CONDUCT;
        match self {
            Self::PowerUp => power_up,
            Self::Init => init,
            Self::Ready => ready,
            Self::Run => run,
            Self::Hold => hold,
            Self::Safe => safe,
        }
    }
}

/// Who asks for a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Actor {
    /// The loop, when a condition holds.
    Loop,
    /// Whoever operates the bench, by a command.
    Operator,
    /// The loop's watch over itself, plant, inputs and link.
    Watch,
}

/// What inputs do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inputs {
    /// Nobody looks at them.
    Ignored,
    /// They are read, judged and reported; the plant does not see them.
    Watched,
    /// They are read and drive the plant; each starts from the value that the plant has and moves at its rate.
    Applied,
}

/// What the plant does. Its clock is its tick: it runs exactly when the plant steps, which it does in INIT as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlantDoes {
    /// There is none yet.
    Absent,
    /// Is set to its start, and settles with its start inputs if nobody solved its steady state.
    Starts,
    /// Stands.
    Stands,
    /// Takes one step a tick.
    Steps,
}

/// What outputs do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outputs {
    /// Are what the board gives before software runs.
    Reset,
    /// Are at their safe values, or on the way there at their rates.
    Safe,
    /// Go to the plant's values at their rates.
    Approach,
    /// Follow the plant.
    Follow,
    /// Stay as they are.
    Frozen,
}

/// One row: what the loop does in a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conduct {
    /// The mode.
    pub mode: Mode,
    /// Inputs.
    pub inputs: Inputs,
    /// Plant.
    pub plant: PlantDoes,
    /// Outputs.
    pub outputs: Outputs,
}

/// What the loop does in each mode.
pub const CONDUCT: [Conduct; 6] = [
    conduct(Mode::PowerUp, Inputs::Ignored, PlantDoes::Absent, Outputs::Reset),
    conduct(Mode::Init, Inputs::Watched, PlantDoes::Starts, Outputs::Safe),
    conduct(Mode::Ready, Inputs::Watched, PlantDoes::Stands, Outputs::Approach),
    conduct(Mode::Run, Inputs::Applied, PlantDoes::Steps, Outputs::Follow),
    conduct(Mode::Hold, Inputs::Watched, PlantDoes::Stands, Outputs::Frozen),
    conduct(Mode::Safe, Inputs::Watched, PlantDoes::Stands, Outputs::Safe),
];

const fn conduct(mode: Mode, inputs: Inputs, plant: PlantDoes, outputs: Outputs) -> Conduct {
    Conduct { mode, inputs, plant, outputs }
}

/// One change that is possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// From this mode; `None` stands for any but SAFE itself.
    pub from: Option<Mode>,
    /// To this one.
    pub to: Mode,
    /// Who may ask for it.
    pub by: Actor,
    /// When it is granted.
    pub when: &'static str,
}

/// Every change that is possible.
pub const CHANGES: [Change; 13] = [
    change(Some(Mode::PowerUp), Mode::Init, Actor::Loop, "the board was started on purpose"),
    change(Some(Mode::Init), Mode::Ready, Actor::Loop, "rates of change are below their limit"),
    change(Some(Mode::Init), Mode::Ready, Actor::Operator, "settle: the plant is taken as it is"),
    change(Some(Mode::Ready), Mode::Run, Actor::Operator, "arm: inputs good, outputs at the plant's values"),
    change(Some(Mode::Ready), Mode::Run, Actor::Loop, "no hardware is bound to the plant"),
    change(Some(Mode::Ready), Mode::Init, Actor::Operator, "restart"),
    change(Some(Mode::Run), Mode::Hold, Actor::Operator, "hold"),
    change(Some(Mode::Hold), Mode::Run, Actor::Operator, "resume: inputs good"),
    change(Some(Mode::Run), Mode::Ready, Actor::Operator, "disarm"),
    change(Some(Mode::Hold), Mode::Ready, Actor::Operator, "disarm"),
    change(Some(Mode::Safe), Mode::Ready, Actor::Operator, "acknowledge: the plant can be trusted"),
    change(Some(Mode::Safe), Mode::Init, Actor::Operator, "restart, which acknowledges"),
    change(None, Mode::Safe, Actor::Watch, "a fault, or the operator's stop"),
];

const fn change(from: Option<Mode>, to: Mode, by: Actor, when: &'static str) -> Change {
    Change { from, to, by, when }
}

/// Returns whether the table has a change from `from` to `to` by `by`; whether it is granted now is the caller's
/// to judge.
pub fn possible(from: Mode, to: Mode, by: Actor) -> bool {
    CHANGES.iter().any(|change| {
        let starts = change.from.map_or(from != Mode::Safe, |mode| mode == from);
        starts && change.to == to && change.by == by
    })
}

/// Why outputs went safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// The start was not a clean one.
    Reset,
    /// Too many overruns in a row.
    Overruns {
        /// How many.
        in_a_row: u32,
    },
    /// The plant's clock fell too far behind.
    Lag {
        /// By how much [µs].
        lag_us: u64,
    },
    /// The plant's state can no longer be trusted.
    Plant(Fault),
    /// The link was silent for too long.
    Silence {
        /// Ticks without a value.
        ticks: u32,
    },
    /// An essential input was not good for too long.
    Input {
        /// The channel.
        channel: u16,
    },
    /// Somebody asked for it.
    Operator,
}

impl Cause {
    /// The cause as a number, as the protocol has it; 0 is none.
    pub fn code(self) -> u8 {
        match self {
            Self::Reset => 1,
            Self::Overruns { .. } => 2,
            Self::Lag { .. } => 3,
            Self::Plant(_) => 4,
            Self::Silence { .. } => 5,
            Self::Input { .. } => 6,
            Self::Operator => 7,
        }
    }
}

/// What an operator can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// READY → RUN.
    Arm,
    /// RUN → HOLD.
    Hold,
    /// HOLD → RUN.
    Resume,
    /// RUN or HOLD → READY.
    Disarm,
    /// SAFE → READY.
    Acknowledge,
    /// READY or SAFE → INIT.
    Restart,
    /// Any → SAFE.
    Stop,
    /// INIT → READY: the plant is taken as it is.
    Settle,
}

/// What a request depends on, as it is now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conditions {
    /// The plant has been brought to its start since it last was restarted, and is finite and in range.
    pub plant_trusted: bool,
    /// Every essential input is good, and the link that brings some of them is up.
    pub inputs_good: bool,
    /// Every output has reached the plant's value.
    pub outputs_arrived: bool,
}

/// Why a request was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// There is no such change from the present mode.
    Mode,
    /// The plant cannot be trusted, or never was at its start; it has to be restarted.
    Plant,
    /// An essential input is not good.
    Inputs,
    /// Outputs are still on the way.
    Outputs,
    /// The command came over a link with a key, and nothing proves that its sender has it.
    Key,
}

/// The mode and why it is SAFE, if it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Machine {
    mode: Mode,
    cause: Option<Cause>,
}

impl Default for Machine {
    fn default() -> Self {
        Self::new()
    }
}

impl Machine {
    /// Starts in POWERUP.
    pub const fn new() -> Self {
        Self { mode: Mode::PowerUp, cause: None }
    }

    /// The mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Why the mode is SAFE; `None` in any other.
    pub fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// Changes to `to` on the loop's own account. Returns whether the table allows it.
    pub fn advance(&mut self, to: Mode) -> bool {
        let allowed = possible(self.mode, to, Actor::Loop);
        if allowed {
            self.mode = to;
        }
        allowed
    }

    /// Goes to SAFE and stays there. Returns whether it was not there already: the first cause is the one kept.
    pub fn fail(&mut self, cause: Cause) -> bool {
        let first = possible(self.mode, Mode::Safe, Actor::Watch);
        if first {
            self.mode = Mode::Safe;
            self.cause = Some(cause);
        }
        first
    }

    /// Does what an operator asks for, or says why not.
    pub fn request(&mut self, request: Request, now: Conditions) -> Result<Mode, Refusal> {
        let unless = |holds: bool, refusal| if holds { Ok(()) } else { Err(refusal) };
        let to = match request {
            Request::Arm | Request::Resume => Mode::Run,
            Request::Hold => Mode::Hold,
            Request::Disarm | Request::Acknowledge | Request::Settle => Mode::Ready,
            Request::Restart => Mode::Init,
            Request::Stop => {
                // Asked for twice is no mistake.
                self.fail(Cause::Operator);
                return Ok(self.mode);
            }
        };
        let from = match request {
            Request::Arm => self.mode == Mode::Ready,
            Request::Resume => self.mode == Mode::Hold,
            Request::Acknowledge => self.mode == Mode::Safe,
            Request::Disarm => self.mode.is_armed(),
            Request::Settle => self.mode == Mode::Init,
            Request::Hold | Request::Restart | Request::Stop => true,
        };
        unless(from && possible(self.mode, to, Actor::Operator), Refusal::Mode)?;
        unless(to == Mode::Init || now.plant_trusted, Refusal::Plant)?;
        if to == Mode::Run {
            unless(now.inputs_good, Refusal::Inputs)?;
            unless(request == Request::Resume || now.outputs_arrived, Refusal::Outputs)?;
        }
        self.mode = to;
        self.cause = None;
        Ok(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::format;
    use std::string::String;

    const REQUESTS: [Request; 8] = [
        Request::Arm,
        Request::Hold,
        Request::Resume,
        Request::Disarm,
        Request::Acknowledge,
        Request::Restart,
        Request::Stop,
        Request::Settle,
    ];

    fn every_condition() -> impl Iterator<Item = Conditions> {
        (0..8).map(|bits| Conditions {
            plant_trusted: bits & 1 != 0,
            inputs_good: bits & 2 != 0,
            outputs_arrived: bits & 4 != 0,
        })
    }

    /// Whatever happens in whatever order, hardware is armed by an operator's request only, with everything in
    /// order, and never straight out of SAFE.
    #[test]
    fn no_way_leads_from_safe_to_run_without_an_acknowledgement() {
        for mode in Mode::ALL {
            for now in every_condition() {
                for request in REQUESTS {
                    let mut machine = Machine { mode, cause: (mode == Mode::Safe).then_some(Cause::Reset) };
                    let result = machine.request(request, now);
                    if machine.mode() == Mode::Run && mode != Mode::Run {
                        assert!(now.plant_trusted && now.inputs_good);
                        assert!(mode == Mode::Hold || mode == Mode::Ready && now.outputs_arrived);
                    }
                    if mode == Mode::Safe && machine.mode() != Mode::Safe {
                        assert!(matches!(request, Request::Acknowledge | Request::Restart));
                    }
                    assert_eq!(machine.cause().is_some(), machine.mode() == Mode::Safe);
                    if result.is_err() {
                        assert_eq!(machine.mode(), mode, "a refused request changes nothing");
                    }
                }
            }
            for to in Mode::ALL {
                let mut machine = Machine { mode, cause: None };
                let advanced = machine.advance(to);
                assert!(mode != Mode::Safe || !advanced, "the loop leaves SAFE by itself");
            }
        }
    }

    #[test]
    fn every_mode_is_reached_and_can_fail() {
        let mut reached = BTreeSet::from(["POWERUP"]);
        for _ in Mode::ALL {
            for change in CHANGES {
                if change.from.is_none_or(|from| reached.contains(from.name())) {
                    reached.insert(change.to.name());
                }
            }
        }
        assert_eq!(reached.len(), Mode::ALL.len());
        for mode in Mode::ALL {
            let mut machine = Machine { mode, cause: None };
            assert_eq!(machine.fail(Cause::Operator), mode != Mode::Safe);
            assert_eq!(machine.mode(), Mode::Safe);
        }
    }

    #[test]
    fn the_first_cause_is_kept_until_it_is_acknowledged() {
        let mut machine = Machine::new();
        assert!(machine.fail(Cause::Silence { ticks: 5 }));
        assert!(!machine.fail(Cause::Operator));
        assert_eq!(machine.cause(), Some(Cause::Silence { ticks: 5 }));
        let now = Conditions { plant_trusted: true, inputs_good: false, outputs_arrived: false };
        assert_eq!(machine.request(Request::Acknowledge, now), Ok(Mode::Ready));
        assert_eq!(machine.request(Request::Arm, now), Err(Refusal::Inputs));
    }

    /// The documents say what the code does.
    #[test]
    fn both_tables_are_those_of_the_document() {
        let document = include_str!("../../docs/hil.md");
        for row in CHANGES {
            let from = row.from.map_or("any", Mode::name);
            let by = format!("{:?}", row.by).to_lowercase();
            let row = format!("| {from} | {} | {by} | {} |", row.to.name(), row.when);
            assert!(document.contains(&row), "docs/hil.md lacks\n{row}");
        }
        for (mode, row) in Mode::ALL.into_iter().zip(CONDUCT) {
            assert_eq!((row.mode, mode.conduct().mode), (mode, mode));
            let words: [String; 3] =
                [format!("{:?}", row.inputs), format!("{:?}", row.plant), format!("{:?}", row.outputs)];
            let steps = matches!(row.plant, PlantDoes::Starts | PlantDoes::Steps);
            let clock = if steps { "runs" } else { "stands" };
            let row = format!(
                "| {} | {} | {clock} |",
                mode.name(),
                words.map(|word| word.to_lowercase()).join(" | ")
            );
            assert!(document.contains(&row), "docs/hil.md lacks\n{row}");
        }
        let rows = document.lines().filter(|line| line.starts_with("| ") && line.contains(" SAFE ")).count();
        assert!(rows >= 3, "{rows} rows with SAFE");
    }
}
