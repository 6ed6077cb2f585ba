//! The one loop with hardware on its link: starts without a bump, goes to SAFE when the link is cut, stays there until
//! somebody acknowledges it.

use crate::bench::{Operator, Peer, Told, run, run_from};
use eclss_core::mode::{Cause, Mode};
use eclss_target::control::Event;
use std::rc::Rc;

/// Ranges of the outputs of `networks/hil.toml`.
const RANGES: [f32; 2] = [0.14, 1_000.0];
/// Ticks of silence that it allows.
const SAFE_AFTER: u64 = 20;

fn told() -> Told {
    Rc::new(std::cell::Cell::new((0, Mode::PowerUp)))
}

/// Looks at the outputs around the start of RUN.
struct Bumpless {
    operator: Operator,
    told: Told,
    before: Vec<f32>,
    worst: f32,
    ticks_in_run: u32,
}

impl Peer for Bumpless {
    fn tick(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8> {
        let was = self.operator.mode;
        let bytes = self.operator.exchange(tick, bytes);
        if self.operator.mode == Mode::Run {
            if was != Mode::Run {
                self.before = self.operator.outputs.clone();
            }
            self.ticks_in_run += 1;
            for ((now, before), range) in self.operator.outputs.iter().zip(&self.before).zip(RANGES) {
                self.worst = self.worst.max((now - before).abs() / range);
            }
        }
        bytes
    }
}

/// From INIT over READY to RUN with inputs as the plant has them: outputs reach their values at their rates, and from
/// then on none moves by a ten-thousandth of its range.
#[test]
fn run_starts_without_a_bump() {
    let told = told();
    let operator = Operator::new(&[1.0, 1.0]);
    let peer = Bumpless { operator, told: told.clone(), before: Vec::new(), worst: 0.0, ticks_in_run: 0 };
    let (peer, events) = run(peer, 30_000, &told);
    let modes: Vec<Mode> = events
        .iter()
        .filter_map(|event| if let Event::Mode { to, .. } = event { Some(*to) } else { None })
        .collect();
    assert_eq!(modes, [Mode::Init, Mode::Ready, Mode::Run]);
    println!("{} ticks of RUN, largest move {:.2e} of the range", peer.ticks_in_run, peer.worst);
    assert!(peer.ticks_in_run > 10_000 && peer.worst < 1e-4, "{}", peer.worst);
    assert!((peer.operator.outputs[0] - 0.086_477_6).abs() < 1e-5);
    assert_eq!(peer.told.get().1, Mode::Run);
}

impl Peer for Operator {
    fn tick(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8> {
        self.exchange(tick, bytes)
    }
}

/// A watchdog's reset boots into SAFE. An acknowledgement is not enough there, because no INIT has brought the plant to
/// its start: it is restarted, and only then armed.
#[test]
fn after_a_reset_the_plant_is_restarted_before_it_is_armed() {
    let told = told();
    let (operator, events) = run_from(Operator::new(&[1.0, 1.0]), 20_000, &told, true);
    let modes: Vec<Mode> = events
        .iter()
        .filter_map(|event| if let Event::Mode { to, .. } = event { Some(*to) } else { None })
        .collect();
    assert!(matches!(events.first(), Some(Event::Safe { tick: 0, cause: Cause::Reset })));
    assert_eq!(modes, [Mode::Init, Mode::Ready, Mode::Run]);
    assert!(operator.refused >= 1 && operator.mode == Mode::Run);
}

/// Cuts the link at random times, for random times.
struct Cuts {
    operator: Operator,
    told: Told,
    dice: u64,
    until: u64,
    cut_at: u64,
    number: u32,
    long: u32,
    slowest: u64,
    armed_ticks: u64,
}

impl Cuts {
    fn roll(&mut self, most: u64) -> u64 {
        self.dice = self.dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.dice >> 33) % most
    }
}

impl Peer for Cuts {
    fn tick(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8> {
        let (since, mode) = self.told.get();
        self.armed_ticks += u64::from(mode == Mode::Run);
        if self.operator.cut {
            let silent = tick - self.cut_at;
            // What was on its way when the wire broke is one tick, and ticks are told when they are over.
            assert!(
                silent <= SAFE_AFTER + 3 || mode == Mode::Safe,
                "{mode:?} after {silent} ticks of silence"
            );
            if mode == Mode::Safe && since >= self.cut_at {
                self.slowest = self.slowest.max(since.saturating_sub(self.cut_at));
            }
            if tick >= self.until {
                self.long += u32::from(mode == Mode::Safe);
                // After every other long cut nobody acknowledges for a while: then nothing may move.
                self.operator.willing = self.number.is_multiple_of(2);
                self.operator.cut = false;
                self.until = tick + 30;
            }
        } else if !self.operator.willing {
            assert!(mode != Mode::Run || since < self.cut_at, "armed without an acknowledgement");
            self.operator.willing = tick >= self.until;
        } else if mode == Mode::Run && tick >= self.until {
            self.operator.cut = true;
            self.cut_at = tick;
            self.number += 1;
            // Every eighth cut is so long that the session ends.
            let long = if self.roll(8) == 0 { 250 } else { 0 };
            self.until = tick + 1 + self.roll(60) + long;
        } else if mode != Mode::Run {
            self.until = tick + self.roll(100);
        }
        self.operator.exchange(tick, bytes)
    }
}

/// A link that is cut at random: always SAFE within the stated ticks, reconnected by itself, armed by an
/// acknowledgement only.
#[test]
fn a_cut_link_is_safe_in_time_and_stays_so_until_it_is_acknowledged() {
    let wanted = 10_000;
    let told = told();
    let peer = Cuts {
        operator: Operator::new(&[0.9, 1.0]),
        told: told.clone(),
        dice: 3,
        until: 0,
        cut_at: 0,
        number: 0,
        long: 0,
        slowest: 0,
        armed_ticks: 0,
    };
    let (peer, events) = run(peer, 15_000 + u64::from(wanted) * 170, &told);
    let silences = events
        .iter()
        .filter(|event| matches!(event, Event::Safe { cause: Cause::Silence { .. }, .. }))
        .count();
    let others = events.iter().filter(|event| matches!(event, Event::Safe { .. })).count() - silences;
    let sessions = peer.operator.link.counters().sessions;
    println!(
        "{} cuts, {} of them long, SAFE {} ticks after the cut at the latest, {silences} silences, {sessions} sessions",
        peer.number, peer.long, peer.slowest
    );
    assert!(peer.number >= wanted, "{} cuts", peer.number);
    assert!(peer.long > wanted / 4 && peer.slowest <= SAFE_AFTER + 2);
    // The last cut may not be over.
    assert!(
        silences.abs_diff(peer.long as usize) <= 1 && others == 0,
        "{silences} silences, {others} others"
    );
    assert!(sessions > wanted / 20, "it reconnects by itself");
    assert!(peer.armed_ticks > 0);
}
