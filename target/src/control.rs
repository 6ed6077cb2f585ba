//! The one loop: read inputs, step, write outputs, account time. Every board runs this and nothing else.

use crate::account::{Account, Tick};
use crate::board::Board;
use crate::plant::{Plant, Untrusted};
use crate::schedule::Schedule;
use core::num::NonZeroU32;

/// What the loop is told.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Time between ticks \[µs\].
    pub period_us: NonZeroU32,
    /// Ticks after which the loop ends; `None` on hardware, where it never does.
    pub ticks: Option<u64>,
    /// Ticks that count as start-up in the account.
    pub startup_ticks: u32,
    /// Overruns in a row after which outputs go safe; at least 1.
    pub overruns_to_safe: u32,
    /// Lag of the plant's clock behind the wall's beyond which outputs go safe \[µs\].
    pub lag_to_safe_us: u64,
    /// Whether to start with safe outputs and the plant held, as after a fault.
    pub start_safe: bool,
    /// Ticks between two [`Event::Status`].
    pub status_every: NonZeroU32,
}

/// Why outputs went safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
        /// By how much \[µs\].
        lag_us: u64,
    },
    /// The plant's state can no longer be trusted.
    Plant(Untrusted),
}

/// How many outputs a status carries.
pub const SHOWN_OUTPUTS: usize = 4;

/// What the loop tells about itself. Whoever logs it does so outside of the tick.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The account up to now, at regular intervals.
    Status {
        /// Timing.
        account: Account,
        /// The first outputs; NaN where there are fewer.
        outputs: [f32; SHOWN_OUTPUTS],
        /// Whether outputs are safe.
        safe: bool,
    },
    /// A tick ended after the next release.
    Overrun {
        /// Number of the tick, from 0.
        tick: u64,
        /// Releases skipped.
        skipped: u32,
    },
    /// Outputs went safe and stay so.
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
        /// Whether outputs are safe.
        safe: bool,
    },
}

/// Runs the loop until [`Settings::ticks`] have run; `tell` takes events and must not wait.
///
/// Once safe, outputs stay safe and the plant is held; the loop goes on ticking and feeding the watchdog, so
/// that the board can say what happened.
pub async fn run<B: Board, P: Plant>(
    board: &mut B,
    plant: &mut P,
    settings: &Settings,
    mut tell: impl FnMut(Event),
) {
    let period_us = settings.period_us;
    let first_us = board.now_us() + u64::from(period_us.get());
    let mut schedule = Schedule::new(first_us, period_us);
    let mut account = Account::new(first_us, period_us, settings.startup_ticks);
    let mut safe = None;
    if settings.start_safe {
        safe = Some(Cause::Reset);
        board.safe_outputs();
        tell(Event::Safe { tick: 0, cause: Cause::Reset });
    }
    let mut until_status = settings.status_every.get();
    while settings.ticks.is_none_or(|ticks| account.ticks < ticks) {
        let release_us = schedule.release_us();
        board.sleep_until(release_us).await;
        let begun_us = board.now_us();
        let begun = board.counter();
        board.feed_watchdog();
        board.read_inputs(plant.inputs());
        let stepping = board.counter();
        let trust = if safe.is_none() { plant.step() } else { Ok(()) };
        let stepped = board.counter();
        if safe.is_none() && trust.is_ok() {
            board.write_outputs(plant.outputs());
        }
        let tick_counts = board.counter().wrapping_sub(begun);
        let skipped = schedule.finish(board.now_us());
        let step_counts = stepped.wrapping_sub(stepping);
        let tick = account.ticks;
        account.book(&Tick { release_us, begun_us, tick_counts, step_counts, skipped });
        if skipped > 0 {
            tell(Event::Overrun { tick, skipped });
        }
        if safe.is_none() {
            safe = trust.err().map(Cause::Plant).or_else(|| judge(&account, settings));
            if let Some(cause) = safe {
                board.safe_outputs();
                tell(Event::Safe { tick, cause });
            }
        }
        until_status -= 1;
        if until_status == 0 {
            until_status = settings.status_every.get();
            tell(Event::Status { account, outputs: first(plant.outputs()), safe: safe.is_some() });
        }
    }
    board.safe_outputs();
    tell(Event::Ended {
        account,
        state_hash: plant.state_hash(),
        values_hash: plant.values_hash(),
        safe: safe.is_some(),
    });
}

/// Whether timing alone is reason enough to go safe.
fn judge(account: &Account, settings: &Settings) -> Option<Cause> {
    let in_a_row = account.consecutive_overruns;
    if in_a_row >= settings.overruns_to_safe {
        return Some(Cause::Overruns { in_a_row });
    }
    let lag_us = account.lag_us();
    (lag_us > settings.lag_to_safe_us).then_some(Cause::Lag { lag_us })
}

fn first(outputs: &[f32]) -> [f32; SHOWN_OUTPUTS] {
    core::array::from_fn(|i| outputs.get(i).copied().unwrap_or(f32::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};
    use eclss_core::Place;

    /// A board whose clock moves only as the script says: each tick takes the next duration \[µs\].
    #[derive(Default)]
    struct Scripted {
        clock_us: core::cell::Cell<u64>,
        durations_us: Vec<u64>,
        begun: Vec<u64>,
        written: usize,
        safe_calls: usize,
        fed: usize,
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
        fn read_inputs(&mut self, _inputs: &mut [f32]) {
            self.begun.push(self.clock_us.get());
            let duration = self.durations_us.get(self.begun.len() - 1).copied().unwrap_or(100);
            self.clock_us.set(self.clock_us.get() + duration);
        }
        fn write_outputs(&mut self, outputs: &[f32]) {
            assert_eq!(self.safe_calls, 0, "outputs written after they went safe");
            assert_eq!(outputs.len(), 1);
            self.written += 1;
        }
        fn safe_outputs(&mut self) {
            self.safe_calls += 1;
        }
        fn feed_watchdog(&mut self) {
            self.fed += 1;
        }
    }

    /// Counts its steps and breaks at one of them.
    struct Counting {
        steps: [f32; 1],
        breaks_at: f32,
    }

    impl Plant for Counting {
        fn inputs(&mut self) -> &mut [f32] {
            &mut []
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
        status_every: NonZeroU32::new(5).unwrap(),
    };

    fn run_scripted(
        durations_us: &[u64],
        breaks_at: f32,
        settings: &Settings,
    ) -> (Scripted, Counting, Vec<Event>) {
        let mut board = Scripted { durations_us: durations_us.to_vec(), ..Scripted::default() };
        let mut plant = Counting { steps: [0.0], breaks_at };
        let mut events = Vec::new();
        {
            let looped = pin!(run(&mut board, &mut plant, settings, |event| events.push(event)));
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
        assert_eq!((board.written, board.fed, plant.steps[0] as usize), (10, 10, 10));
        assert_eq!(board.safe_calls, 1, "at the end");
        let states = events.iter().filter(|event| matches!(event, Event::Status { .. })).count();
        assert_eq!(states, 2);
        assert!(matches!(events.last(), Some(Event::Ended { safe: false, .. })));
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
        assert_eq!((board.written, board.fed), (5, 10), "but the loop goes on");
        assert!(matches!(events.last(), Some(Event::Ended { safe: true, .. })));
    }

    #[test]
    fn lag_beyond_its_limit_goes_safe() {
        let settings = Settings { lag_to_safe_us: 2_999, ..SETTINGS };
        let (_, _, events) = run_scripted(&[3_500], f32::INFINITY, &settings);
        assert_eq!(causes(&events), [(1, Cause::Lag { lag_us: 3_000 })]);
    }

    /// What a broken plant computed never reaches the outputs.
    #[test]
    fn an_untrusted_plant_goes_safe_before_its_outputs_are_written() {
        let (board, _, events) = run_scripted(&[], 4.0, &SETTINGS);
        assert_eq!(causes(&events), [(3, Cause::Plant(BROKEN))]);
        assert_eq!(board.written, 3);
    }

    #[test]
    fn after_a_fault_nothing_moves() {
        let (board, plant, events) =
            run_scripted(&[], f32::INFINITY, &Settings { start_safe: true, ..SETTINGS });
        assert_eq!(causes(&events), [(0, Cause::Reset)]);
        assert_eq!((board.written, plant.steps[0] as usize), (0, 0));
    }
}
