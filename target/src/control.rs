//! The one loop: read inputs, step, write outputs, account time. Every board runs this and nothing else.
//!
//! What each part does depends on the mode ([`eclss_core::mode`]). With [`Order::Latched`] a tick gives out what the
//! tick before has made, at its begin; with [`Order::Immediate`] what it has made itself, at its end.

use crate::account::{Account, Tick};
use crate::board::Board;
use crate::coupling::{Coupling, LinkReport};
use crate::plant::{Plant, Untrusted};
use crate::schedule::Schedule;
use core::num::NonZeroU32;
pub use eclss_core::mode::Cause;
use eclss_core::mode::{Conditions, Machine, Mode, PlantDoes, Request};
use eclss_core::process::Order;
use eclss_core::protocol::{Command, CommandFrame, Outcome};

/// What the loop is told.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Time between ticks \[µs\].
    pub period_us: NonZeroU32,
    /// Ticks after which the loop ends; `None` on hardware, where it never does.
    pub ticks: Option<u64>,
    /// Ticks that count as start-up in the account.
    pub startup_ticks: u32,
    /// Overruns in a row after which the loop goes to SAFE; at least 1.
    pub overruns_to_safe: u32,
    /// Lag of the plant's clock behind the wall's, since it was armed, beyond which the loop goes to SAFE \[µs\].
    pub lag_to_safe_us: u64,
    /// Whether to start in SAFE, as after a fault.
    pub start_safe: bool,
    /// Whether the plant is settled as it is given, so that the first INIT takes no step.
    pub settled: bool,
    /// Ticks between two [`Event::Status`].
    pub status_every: NonZeroU32,
}

/// How many outputs a status carries.
pub const SHOWN_OUTPUTS: usize = 4;

/// What the loop tells about itself. Whoever logs it does so outside of the tick.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is no heap")]
pub enum Event {
    /// The account up to now, at regular intervals.
    Status {
        /// Timing.
        account: Account,
        /// The first outputs; NaN where there are fewer.
        outputs: [f32; SHOWN_OUTPUTS],
        /// The mode.
        mode: Mode,
        /// The link, where there is one.
        link: Option<LinkReport>,
    },
    /// A tick ended after the next release.
    Overrun {
        /// Number of the tick, from 0.
        tick: u64,
        /// Releases skipped.
        skipped: u32,
    },
    /// The mode has changed.
    Mode {
        /// Number of the tick, from 0.
        tick: u64,
        /// From this one.
        from: Mode,
        /// To this one.
        to: Mode,
    },
    /// The mode is SAFE and stays so until it is acknowledged.
    Safe {
        /// Number of the tick, from 0.
        tick: u64,
        /// Why.
        cause: Cause,
    },
    /// The loop has ended.
    Ended {
        /// Timing.
        account: Account,
        /// Hash over the plant's state.
        state_hash: u64,
        /// Hash over its integrated values alone.
        values_hash: u64,
        /// The mode.
        mode: Mode,
        /// The link, where there is one.
        link: Option<LinkReport>,
    },
}

/// What changes from tick to tick besides plant, board and coupling.
struct Loop {
    machine: Machine,
    /// The mode at the end of the tick before.
    was: Mode,
    trust: Result<(), Untrusted>,
    /// Whether INIT has brought the plant to its start since it was last restarted.
    ready: bool,
    /// How far the plant is behind since it was armed \[µs\].
    lag_us: u64,
    /// Whether the plant is as it was given, and settled.
    given: bool,
    /// What of the account's lag came while it was to stand \[µs\].
    stood_us: u64,
}

/// Runs the loop until [`Settings::ticks`] have run; `tell` takes events and must not wait.
///
/// In SAFE the plant stands; the loop goes on ticking and feeding the watchdog, so that the board can say what
/// happened and take an acknowledgement.
pub async fn run<B: Board, P: Plant>(
    board: &mut B,
    plant: &mut P,
    coupling: &mut Coupling<'_>,
    settings: &Settings,
    mut tell: impl FnMut(Event),
) {
    let period_us = settings.period_us;
    let first_us = board.now_us() + u64::from(period_us.get());
    let mut schedule = Schedule::new(first_us, period_us);
    let mut account = Account::new(first_us, period_us, settings.startup_ticks);
    let mut state = Loop {
        machine: Machine::new(),
        was: Mode::PowerUp,
        trust: Ok(()),
        ready: false,
        lag_us: 0,
        given: settings.settled,
        stood_us: 0,
    };
    if settings.start_safe {
        state.fail(Cause::Reset, board, coupling, 0, &mut tell);
        board.safe_outputs();
    }
    let mut until_status = settings.status_every.get();
    while settings.ticks.is_none_or(|ticks| account.ticks < ticks) {
        let release_us = schedule.release_us();
        board.sleep_until(release_us).await;
        let begun_us = board.now_us();
        let begun = board.counter();
        board.feed_watchdog();
        let tick = account.ticks;
        coupling.read(board, begun_us);
        let latched = coupling.order() == Order::Latched;
        if latched {
            coupling.write(board, tick, &state.machine, begun_us);
        }
        let read_counts = board.counter().wrapping_sub(begun);
        if let Some(request) = board.request() {
            // Who asks here sees by the mode whether it was granted.
            let _ = state.command(Command::Mode(request), plant, coupling);
        }
        if let Some(forcing) = board.force() {
            // Whoever asks looks at the channel's range before.
            let _ = coupling.force(forcing);
        }
        state.prepare(plant, coupling);
        if let Some(cause) = state.trouble(coupling) {
            state.fail(cause, board, coupling, tick, &mut tell);
        }
        let stepping = board.counter();
        let does = state.machine.mode().conduct().plant;
        if matches!(does, PlantDoes::Starts | PlantDoes::Steps) {
            if does == PlantDoes::Steps {
                coupling.apply(plant);
            }
            state.trust = plant.step();
        }
        let stepped = board.counter();
        if let Err(fault) = state.trust {
            state.fail(Cause::Plant(fault), board, coupling, tick, &mut tell);
        }
        coupling.emit(plant, state.machine.mode().conduct());
        let writing = board.counter();
        if !latched {
            coupling.write(board, tick, &state.machine, board.now_us());
        }
        let ended = board.counter();
        let link_counts = read_counts.wrapping_add(ended.wrapping_sub(writing));
        let skipped = schedule.finish(board.now_us());
        let (tick_counts, step_counts) = (ended.wrapping_sub(begun), stepped.wrapping_sub(stepping));
        account.book(&Tick { release_us, begun_us, tick_counts, step_counts, link_counts, skipped });
        if skipped > 0 {
            tell(Event::Overrun { tick, skipped });
        }
        let stalled = skipped > coupling.process().image().safe_after_ticks;
        if stalled && coupling.is_bound() && state.machine.mode() == Mode::Run {
            // Hardware was without its plant for longer than the plant may be without its hardware.
            let lag_us = u64::from(skipped) * u64::from(period_us.get());
            state.fail(Cause::Lag { lag_us }, board, coupling, tick, &mut tell);
        }
        if let Some(cause) = state.judge(&account, settings) {
            state.fail(cause, board, coupling, tick, &mut tell);
        }
        state.tell_mode(tick, &mut tell);
        board.observe(&account, &state.machine, coupling);
        until_status -= 1;
        if until_status == 0 {
            until_status = settings.status_every.get();
            let (mode, link) = (state.machine.mode(), coupling.link_report());
            tell(Event::Status { account, outputs: first(plant.outputs()), mode, link });
        }
    }
    board.safe_outputs();
    tell(Event::Ended {
        account,
        state_hash: plant.state_hash(),
        values_hash: plant.values_hash(),
        mode: state.machine.mode(),
        link: coupling.link_report(),
    });
}

impl Loop {
    /// What happens before the plant steps: commands, the loop's own changes of mode, and inputs.
    fn prepare<P: Plant>(&mut self, plant: &mut P, coupling: &mut Coupling<'_>) {
        if let Some(CommandFrame { id, command }) = coupling.take_command() {
            let outcome = self.command(command, plant, coupling);
            coupling.acknowledge(id, outcome);
        }
        let bound = coupling.is_bound();
        if self.machine.mode() == Mode::PowerUp {
            self.machine.advance(Mode::Init);
            coupling.unsettle();
        }
        if self.machine.mode() == Mode::Init && (!bound || self.given || coupling.settle(plant)) {
            self.ready = self.machine.advance(Mode::Ready);
        }
        if self.machine.mode() == Mode::Ready && !bound {
            self.machine.advance(Mode::Run);
        }
        if self.machine.mode() == Mode::Run && self.was != Mode::Run {
            coupling.start_from(plant);
        }
        coupling.ingest(self.machine.mode().conduct());
    }

    fn command<P: Plant>(&mut self, command: Command, plant: &mut P, coupling: &mut Coupling<'_>) -> Outcome {
        let ready = self.ready || command == Command::Mode(Request::Settle);
        let conditions = Conditions {
            plant_trusted: self.trust.is_ok() && ready,
            inputs_good: coupling.inputs_good(),
            outputs_arrived: coupling.outputs_arrived(),
        };
        let channels = coupling.process().image().inputs;
        let free = |parameter: u16| channels.iter().all(|channel| channel.slot != u32::from(parameter));
        match command {
            Command::Mode(request) => match self.machine.request(request, conditions) {
                Ok(mode) => {
                    self.ready = ready;
                    if mode == Mode::Init {
                        plant.restart();
                        coupling.unsettle();
                        (self.trust, self.ready, self.given) = (Ok(()), false, false);
                    }
                    Outcome::Mode(mode)
                }
                Err(refusal) => Outcome::Refused(refusal),
            },
            Command::Set { parameter, value } if free(parameter) => match plant.input(parameter.into()) {
                Some(_) if plant.set(parameter.into(), value) => Outcome::Value(value),
                // What does not even take the value that it has is driven by something else.
                Some(present) if plant.set(parameter.into(), present) => Outcome::OutOfRange,
                _ => Outcome::NoSuchParameter,
            },
            Command::Set { .. } => Outcome::NoSuchParameter,
            Command::Get { parameter } => {
                plant.input(parameter.into()).map_or(Outcome::NoSuchParameter, Outcome::Value)
            }
        }
    }

    /// What of the coupling speaks against going on; only armed hardware is in danger.
    fn trouble(&self, coupling: &Coupling<'_>) -> Option<Cause> {
        if self.machine.mode().is_armed() { coupling.trouble() } else { None }
    }

    /// Whether timing alone is reason enough to go safe. Lag counts while the plant is to run, from when it was armed: a
    /// board that once was late could never leave SAFE otherwise.
    fn judge(&mut self, account: &Account, settings: &Settings) -> Option<Cause> {
        let in_a_row = account.consecutive_overruns;
        if in_a_row >= settings.overruns_to_safe {
            return Some(Cause::Overruns { in_a_row });
        }
        let behind_us = account.lag_us();
        match self.machine.mode() {
            Mode::Run => self.lag_us = behind_us.saturating_sub(self.stood_us),
            // What it is behind stays, and does not grow.
            Mode::Hold => self.stood_us = behind_us.saturating_sub(self.lag_us),
            _ => (self.lag_us, self.stood_us) = (0, behind_us),
        }
        let lag_us = self.lag_us;
        (lag_us > settings.lag_to_safe_us).then_some(Cause::Lag { lag_us })
    }

    /// Goes to SAFE, unless it is there. Outputs that are channels go there at their rates; without any, the board's
    /// are safe at once.
    fn fail<B: Board>(
        &mut self,
        cause: Cause,
        board: &mut B,
        coupling: &Coupling<'_>,
        tick: u64,
        tell: &mut impl FnMut(Event),
    ) {
        if self.machine.fail(cause) {
            if !coupling.is_bound() {
                board.safe_outputs();
            }
            tell(Event::Safe { tick, cause });
        }
    }

    /// Tells a change of mode. SAFE is told with its cause where it happens, unless somebody asked for it.
    fn tell_mode(&mut self, tick: u64, tell: &mut impl FnMut(Event)) {
        let (from, to) = (self.was, self.machine.mode());
        self.was = to;
        match self.machine.cause() {
            _ if from == to => {}
            Some(Cause::Operator) => tell(Event::Safe { tick, cause: Cause::Operator }),
            Some(_) => {}
            None => tell(Event::Mode { tick, from, to }),
        }
    }
}

fn first(outputs: &[f32]) -> [f32; SHOWN_OUTPUTS] {
    core::array::from_fn(|i| outputs.get(i).copied().unwrap_or(f32::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::Converters;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};
    use eclss_core::mode::Request;
    use eclss_core::process::Applied;
    use eclss_core::{Place, Signal};

    /// A board whose clock moves only as the script says: each tick takes the next duration \[µs\].
    #[derive(Default)]
    struct Scripted {
        clock_us: core::cell::Cell<u64>,
        durations_us: Vec<u64>,
        begun: Vec<u64>,
        written: usize,
        safe_calls: usize,
        fed: usize,
        /// What the operator asks for, by tick.
        requests: Vec<(usize, Request)>,
    }

    impl Board for Scripted {
        const COUNTER_HZ: u32 = 1_000_000;
        fn name(&self) -> &'static str {
            "scripted"
        }
        fn now_us(&self) -> u64 {
            self.clock_us.get()
        }
        async fn sleep_until(&mut self, at_us: u64) {
            self.clock_us.set(self.clock_us.get().max(at_us));
        }
        fn counter(&self) -> u32 {
            self.clock_us.get() as u32
        }
        fn read_inputs(&mut self, _converters: &mut Converters) {
            self.begun.push(self.clock_us.get());
            let duration = self.durations_us.get(self.begun.len() - 1).copied().unwrap_or(100);
            self.clock_us.set(self.clock_us.get() + duration);
        }
        fn write_outputs(&mut self, _converters: &Converters, armed: bool) {
            let asked = !self.requests.is_empty();
            assert!(asked || self.safe_calls == 0 || !armed, "outputs live after they went safe");
            self.written += usize::from(armed);
        }
        fn safe_outputs(&mut self) {
            self.safe_calls += 1;
        }
        fn feed_watchdog(&mut self) {
            self.fed += 1;
        }
        fn request(&mut self) -> Option<Request> {
            let tick = self.begun.len() - 1;
            self.requests.iter().find(|(at, _)| *at == tick).map(|(_, request)| *request)
        }
    }

    /// Counts its steps and breaks at one of them.
    struct Counting {
        steps: [f32; 1],
        breaks_at: f32,
    }

    impl Plant for Counting {
        fn restart(&mut self) {
            self.steps = [0.0];
        }
        fn apply(&mut self, _channel: usize, _slot: u32, _applied: Applied) {}
        /// Slot 0 is free, slot 1 follows a schedule.
        fn set(&mut self, slot: u32, value: f32) -> bool {
            slot == 0 && (0.0..=1.0).contains(&value)
        }
        fn input(&self, slot: u32) -> Option<f32> {
            (slot < 2).then_some(0.5)
        }
        fn signal(&self, _signal: Signal) -> f32 {
            self.steps[0]
        }
        fn step(&mut self) -> Result<(), Untrusted> {
            self.steps[0] += 1.0;
            if self.steps[0] >= self.breaks_at { Err(BROKEN) } else { Ok(()) }
        }
        fn outputs(&self) -> &[f32] {
            &self.steps
        }
        fn state_hash(&self) -> u64 {
            self.steps[0].to_bits().into()
        }
        fn values_hash(&self) -> u64 {
            self.state_hash()
        }
    }

    const BROKEN: Untrusted = Untrusted { tick: 4, place: Place::Node(7) };

    const SETTINGS: Settings = Settings {
        period_us: NonZeroU32::new(1_000).unwrap(),
        ticks: Some(10),
        startup_ticks: 0,
        overruns_to_safe: 3,
        lag_to_safe_us: 1_000_000,
        start_safe: false,
        settled: false,
        status_every: NonZeroU32::new(5).unwrap(),
    };

    fn run_scripted(
        durations_us: &[u64],
        breaks_at: f32,
        settings: &Settings,
    ) -> (Scripted, Counting, Vec<Event>) {
        run_asked(durations_us, &[], breaks_at, settings)
    }

    fn run_asked(
        durations_us: &[u64],
        requests: &[(usize, Request)],
        breaks_at: f32,
        settings: &Settings,
    ) -> (Scripted, Counting, Vec<Event>) {
        let (durations_us, requests) = (durations_us.to_vec(), requests.to_vec());
        let mut board = Scripted { durations_us, requests, ..Scripted::default() };
        let mut plant = Counting { steps: [0.0], breaks_at };
        let mut events = Vec::new();
        let mut nothing = Coupling::none();
        {
            let looped =
                pin!(run(&mut board, &mut plant, &mut nothing, settings, |event| events.push(event)));
            // Nothing in a scripted board waits, so one poll runs to the end.
            assert_eq!(looped.poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(()));
        }
        (board, plant, events)
    }

    fn causes(events: &[Event]) -> Vec<(u64, Cause)> {
        let cause = |event: &Event| {
            if let Event::Safe { tick, cause } = event { Some((*tick, *cause)) } else { None }
        };
        events.iter().filter_map(cause).collect()
    }

    #[test]
    fn steps_and_writes_once_per_tick_on_the_grid() {
        let (board, plant, events) = run_scripted(&[], f32::INFINITY, &SETTINGS);
        assert_eq!(board.begun, (1..=10).map(|n| n * 1_000).collect::<Vec<_>>());
        assert_eq!((board.written, board.fed, plant.steps[0] as usize), (9, 10, 10), "a tick behind");
        assert_eq!(board.safe_calls, 1, "at the end");
        let states = events.iter().filter(|event| matches!(event, Event::Status { .. })).count();
        assert_eq!(states, 2);
        assert!(matches!(events.last(), Some(Event::Ended { mode: Mode::Run, .. })));
    }

    /// One long tick: its successors are not made up for, and all later ones are back on the grid.
    #[test]
    fn a_long_tick_is_skipped_over_not_caught_up_with() {
        let (board, plant, events) = run_scripted(&[100, 2_500], f32::INFINITY, &SETTINGS);
        let expected: Vec<u64> = [1, 2].into_iter().chain(5..=12).map(|n| n * 1_000).collect();
        assert_eq!(board.begun, expected);
        assert_eq!(plant.steps[0] as usize, 10);
        assert!(events.iter().any(|event| matches!(event, Event::Overrun { tick: 1, skipped: 2 })));
        let Some(Event::Ended { account, .. }) = events.last() else { panic!("no end") };
        assert_eq!((account.overruns, account.skipped, account.lag_us()), (1, 2, 2_000));
        assert_eq!(causes(&events), []);
    }

    #[test]
    fn overruns_in_a_row_go_safe_for_good() {
        let (board, plant, events) =
            run_scripted(&[1_500, 100, 1_500, 1_500, 1_500], f32::INFINITY, &SETTINGS);
        assert_eq!(causes(&events), [(4, Cause::Overruns { in_a_row: 3 })]);
        assert_eq!(plant.steps[0] as usize, 5, "the plant is held afterwards");
        assert_eq!((board.written, board.fed), (4, 10), "but the loop goes on");
        assert!(matches!(events.last(), Some(Event::Ended { mode: Mode::Safe, .. })));
    }

    #[test]
    fn lag_beyond_its_limit_goes_safe() {
        let settings = Settings { lag_to_safe_us: 2_999, ..SETTINGS };
        let (_, _, events) = run_scripted(&[3_500], f32::INFINITY, &settings);
        assert_eq!(causes(&events), [(1, Cause::Lag { lag_us: 3_000 })]);
    }

    /// Lag that was acknowledged is over, and so is what came while the plant was to stand: only what comes afterwards
    /// leads to SAFE again. The account shows all of it.
    #[test]
    fn lag_can_be_acknowledged() {
        let settings = Settings { lag_to_safe_us: 2_999, overruns_to_safe: 9, ticks: Some(20), ..SETTINGS };
        // 3 ms in RUN; 2 ms in SAFE; acknowledged; 2 ms in RUN, 2 ms in HOLD, 1 ms in RUN.
        let mut durations_us = [100; 20];
        for (tick, skipped) in [(0, 3), (2, 2), (6, 2), (9, 2), (12, 1)] {
            durations_us[tick] = 1_000 * skipped + 500;
        }
        let requests = [(4, Request::Acknowledge), (8, Request::Hold), (11, Request::Resume)];
        let (_, plant, events) = run_asked(&durations_us, &requests, f32::INFINITY, &settings);
        assert_eq!(causes(&events), [(1, Cause::Lag { lag_us: 3_000 }), (13, Cause::Lag { lag_us: 3_000 })]);
        let Some(Event::Ended { account, .. }) = events.last() else { panic!("no end") };
        assert_eq!((account.lag_us(), plant.steps[0] as usize), (10_000, 9));
    }

    /// What drives itself can be asked for, and is not there to be set.
    #[test]
    fn a_parameter_is_set_told_or_not_there() {
        let mut plant = Counting { steps: [0.0], breaks_at: 9.0 };
        let (machine, was, trust) = (Machine::new(), Mode::PowerUp, Ok(()));
        let mut state = Loop { machine, was, trust, ready: false, lag_us: 0, given: false, stood_us: 0 };
        let mut ask = |command| state.command(command, &mut plant, &mut Coupling::none());
        let cases = [
            (0, 0.7, Outcome::Value(0.7)),
            (0, 1.7, Outcome::OutOfRange),
            (0, f32::NAN, Outcome::OutOfRange),
        ];
        let cases = cases.into_iter().chain([1, 2].map(|slot| (slot, 0.5, Outcome::NoSuchParameter)));
        for (parameter, value, outcome) in cases {
            assert_eq!(ask(Command::Set { parameter, value }), outcome, "{parameter} to {value}");
        }
        assert_eq!(ask(Command::Get { parameter: 1 }), Outcome::Value(0.5));
        assert_eq!(ask(Command::Get { parameter: 2 }), Outcome::NoSuchParameter);
    }

    /// What a broken plant computed never reaches the outputs.
    #[test]
    fn an_untrusted_plant_goes_safe_before_its_outputs_are_written() {
        let (board, _, events) = run_scripted(&[], 4.0, &SETTINGS);
        assert_eq!(causes(&events), [(3, Cause::Plant(BROKEN))]);
        assert_eq!(board.written, 3, "what three good steps have made");
    }

    #[test]
    fn after_a_fault_nothing_moves() {
        let (board, plant, events) =
            run_scripted(&[], f32::INFINITY, &Settings { start_safe: true, ..SETTINGS });
        assert_eq!(causes(&events), [(0, Cause::Reset)]);
        assert_eq!((board.written, plant.steps[0] as usize), (0, 0));
    }
}
