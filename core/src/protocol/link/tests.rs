use super::*;
use crate::mode::Request;
use std::vec;
use std::vec::Vec;

const CONFIG: Config = Config {
    role: Role::Plant,
    network_id: 0x1122_3344_5566_7788,
    process_id: 42,
    step_us: 1_000,
    inputs: 1,
    outputs: 2,
    hello_ticks: 5,
    silent_ticks: 20,
    resend_ticks: 4,
    stale_us: u64::MAX,
};

/// Two ends and what is under way between them.
struct Wire {
    ends: [Link; 2],
    tick: u64,
    /// What each end got, by tick.
    got: [Vec<(u64, f32)>; 2],
}

impl Wire {
    fn new() -> Self {
        let controller = Config { role: Role::Controller, ..CONFIG };
        Self { ends: [Link::new(CONFIG, 1), Link::new(controller, 1)], tick: 0, got: [vec![], vec![]] }
    }

    /// One tick: both ends send, `spoil` may change what is under way to each end, both ends read.
    fn tick(&mut self, mut spoil: impl FnMut(usize, &mut Vec<u8>)) {
        self.tick += 1;
        let now_us = 1_000 * self.tick;
        let values = [self.tick as f32, 0.5];
        let mut bytes = self.ends.each_mut().map(|end| {
            end.send_tick(
                self.tick,
                now_us,
                &Outgoing { mode: Mode::Ready, values: &values, ..Outgoing::default() },
            );
            let bytes = end.outgoing().to_vec();
            end.sent(bytes.len());
            bytes
        });
        bytes.reverse();
        for (index, (end, mut bytes)) in self.ends.iter_mut().zip(bytes).enumerate() {
            spoil(index, &mut bytes);
            end.feed(&bytes, now_us + 300);
            self.got[index].extend(end.take_data().map(|data| (self.tick, data.values[0])));
        }
    }

    fn run(&mut self, ticks: u64) {
        (0..ticks).for_each(|_| self.tick(|_, _| ()));
    }

    fn connected(&self) -> bool {
        self.ends.iter().all(Link::is_connected)
    }
}

#[test]
fn two_ends_find_each_other_and_exchange_data_every_tick() {
    let mut wire = Wire::new();
    wire.run(50);
    assert!(wire.connected());
    for (end, got) in wire.ends.iter().zip(&wire.got) {
        assert!(got.len() >= 48, "{}", got.len());
        assert!(got.iter().all(|(tick, value)| *value as u64 == *tick));
        let counters = end.counters();
        assert_eq!((counters.damaged(), counters.foreign(), counters.lost, counters.sessions), (0, 0, 0, 1));
        assert_eq!(end.silence_ticks(), 0);
        assert_eq!(end.clock().estimate().unwrap().offset_us, 0);
        assert_eq!(end.clock().estimate().unwrap().round_trip_us, 600);
    }
}

/// A controller that sends values for nothing but values: whoever hears first, both ends connect, and a frame that is
/// lost on the way delays that by a hello.
#[test]
fn an_end_that_only_answers_connects() {
    for lost_of_plants in 0..4 {
        for lost_of_controllers in 0..4 {
            let mut wire = Wire::new();
            let [plant, controller] = &mut wire.ends;
            let mut drops = [lost_of_plants, lost_of_controllers];
            let mut arrives = |end: usize| {
                let lost = drops[end] > 0;
                drops[end] -= i32::from(lost);
                !lost
            };
            let mut asked = false;
            for tick in 0..40 {
                plant.send_tick(tick, 1_000 * tick, &Outgoing::default());
                if !plant.outgoing().is_empty() && arrives(0) {
                    controller.feed(plant.outgoing(), 0);
                }
                plant.sent(usize::MAX);
                asked |= controller.take_data().is_some();
                if core::mem::take(&mut asked) {
                    controller.send_tick(tick, 1_000 * tick, &Outgoing::default());
                } else {
                    controller.send_quiet_tick(tick, 1_000 * tick);
                }
                if !controller.outgoing().is_empty() && arrives(1) {
                    plant.feed(controller.outgoing(), 0);
                }
                controller.sent(usize::MAX);
            }
            let lost = (lost_of_plants, lost_of_controllers);
            assert!(plant.is_connected() && controller.is_connected(), "lost {lost:?}");
            assert_eq!((plant.silence_ticks(), plant.counters().sessions), (0, 1), "lost {lost:?}");
        }
    }
}

/// Frames that wait longer and longer in a queue, as those of a controller that sends faster than the plant reads: none
/// is used that answers what the plant sent too long ago, and the plant knows it as silence.
#[test]
fn data_that_are_too_old_are_silence() {
    let mut wire = Wire::new();
    wire.ends[0].config.stale_us = 10_000;
    wire.run(20);
    assert_eq!(wire.ends[0].silence_ticks(), 0);
    let before = wire.ends[0].counters().stale;
    assert!(before <= 2, "only what was sent before anything had come: {before}");
    let mut queue = std::collections::VecDeque::new();
    for tick in 1..=60_u32 {
        wire.tick(|end, bytes| {
            if end == 0 {
                // Twice as many come as are taken.
                queue.push_back(core::mem::take(bytes));
                if tick % 2 == 0 {
                    *bytes = queue.pop_front().unwrap();
                }
            }
        });
    }
    let plant = &wire.ends[0];
    let [age, used] = [plant.silence_ticks(), plant.newest().data.echo.time_us as u32 / 1_000];
    // A frame received in tick 20 + n was sent in tick 20 + n/2.
    assert!((26..=30).contains(&used), "echo of tick {used}");
    assert!((40..=44).contains(&age), "{age} ticks of silence");
    assert!(plant.counters().stale - before >= 18 && plant.is_connected());
}

#[test]
fn another_network_image_step_or_role_is_refused_and_says_why() {
    let controller = Config { role: Role::Controller, ..CONFIG };
    let others = [
        (RefusedReason::Role, CONFIG),
        (RefusedReason::Network, Config { network_id: 1, ..controller }),
        (RefusedReason::Process, Config { process_id: 1, ..controller }),
        (RefusedReason::Process, Config { inputs: 2, ..controller }),
        (RefusedReason::Step, Config { step_us: 999, ..controller }),
    ];
    for (reason, config) in others {
        let mut wire = Wire::new();
        wire.ends[1] = Link::new(config, 77);
        wire.run(50);
        assert!(!wire.connected() && wire.got.iter().all(Vec::is_empty));
        assert_eq!(wire.ends.each_ref().map(Link::refused), [Some(reason); 2]);
        assert!(wire.ends[0].counters().foreign_id > 0);
    }
}

/// A cut link ends, a new session begins by itself, and nothing of the old one is ever taken.
#[test]
fn a_cut_link_reconnects_and_takes_nothing_old() {
    let mut wire = Wire::new();
    wire.run(10);
    let mut old = Vec::new();
    wire.tick(|index, bytes| {
        if index == 0 {
            old = bytes.clone();
        }
    });
    for _ in 0..30 {
        wire.tick(|_, bytes| bytes.clear());
    }
    assert!(!wire.connected() && wire.ends[0].silence_ticks() == 30);
    wire.run(10);
    assert!(wire.connected() && wire.ends[0].counters().sessions == 2);
    let (before, taken) = (*wire.ends[0].counters(), wire.got[0].len());
    wire.ends[0].feed(&old, 0);
    assert!(wire.ends[0].take_data().is_none() && wire.got[0].len() == taken);
    assert_eq!(wire.ends[0].counters().foreign_session, before.foreign_session + 1);
}

/// One end starts anew: the other drops the dead session and joins the new one.
#[test]
fn an_end_that_started_anew_is_found_again() {
    for restarted in [0, 1] {
        let mut wire = Wire::new();
        wire.run(20);
        let config = wire.ends[restarted].config;
        wire.ends[restarted] = Link::new(config, 999);
        wire.run(60);
        assert!(wire.connected());
        let newest = wire.got.each_ref().map(|got| got.last().unwrap().0);
        assert_eq!(newest, [80, 80]);
    }
}

/// An end that started anew with the number that it had before, as boards without a noise source do: the dead session
/// runs dry first, so that neither its numbers nor its commands come through to the new run.
#[test]
fn an_end_that_started_anew_with_the_same_number_is_not_joined_to_the_old_session() {
    for restarted in [0, 1] {
        let mut wire = Wire::new();
        wire.run(20);
        let other = 1 - restarted;
        // Its command is on its way and never gets an answer of the old run.
        wire.ends[other].command(Command::Mode(Request::Arm));
        let config = wire.ends[restarted].config;
        wire.ends[restarted] = Link::new(config, 1);
        for _ in 0..60 {
            wire.tick(|_, _| ());
            assert_eq!(wire.ends[restarted].take_command(), None, "a command of the old session");
        }
        assert!(wire.connected());
        assert_eq!(wire.ends.each_ref().map(|end| end.counters().lost), [0, 0]);
        let newest = wire.got.each_ref().map(|got| got.last().unwrap().0);
        assert_eq!(newest, [80, 80]);
    }
}

/// A peer whose clock began anew: offset and drift are those of the session, not of two clocks.
#[test]
fn the_clock_of_a_peer_that_started_anew_is_another_one() {
    let mut wire = Wire::new();
    wire.run(3_000);
    assert_eq!(wire.ends[0].clock().drift().map(|drift| drift.ppb), Some(0));
    wire.ends[1] = Link::new(wire.ends[1].config, 999);
    // The peer's clock is now an hour behind.
    let now = |tick: u64| 3_600_000_000 + 1_000 * tick;
    for tick in 3_000..6_000 {
        let values = Outgoing { mode: Mode::Ready, ..Outgoing::default() };
        wire.ends[0].send_tick(tick, now(tick), &values);
        wire.ends[1].send_tick(tick, 1_000 * tick, &values);
        let bytes = wire.ends.each_mut().map(|end| {
            let bytes = end.outgoing().to_vec();
            end.sent(bytes.len());
            bytes
        });
        wire.ends[0].feed(&bytes[1], now(tick) + 300);
        wire.ends[1].feed(&bytes[0], 1_000 * tick + 300);
    }
    assert!(wire.connected());
    let clock = wire.ends[0].clock();
    assert_eq!(clock.estimate().map(|estimate| estimate.offset_us), Some(-3_600_000_000));
    assert_eq!(clock.drift().map(|drift| drift.ppb), Some(0));
}

/// Right after a link has come back nothing of the old session counts as under way.
#[test]
fn what_is_under_way_begins_anew_with_the_session() {
    let mut wire = Wire::new();
    wire.run(500);
    assert!(wire.ends[1].under_way() <= 2, "{}", wire.ends[1].under_way());
    for _ in 0..30 {
        wire.tick(|_, bytes| bytes.clear());
    }
    for _ in 0..10 {
        wire.tick(|_, _| ());
        for end in wire.ends.iter().filter(|end| end.is_connected()) {
            assert!(end.under_way() <= 4, "{}", end.under_way());
        }
    }
    assert!(wire.connected());
}

/// A command that gets no answer is sent again after just so many ticks.
#[test]
fn a_command_is_repeated_at_its_interval() {
    let mut wire = Wire::new();
    wire.run(10);
    wire.ends[1].command(Command::Mode(Request::Arm));
    let before = wire.ends[1].sent_packets();
    for _ in 0..=4 * CONFIG.resend_ticks {
        wire.tick(|index, bytes| {
            if index == 1 {
                bytes.clear();
            }
        });
    }
    // One packet of data a tick, and five times the command.
    assert_eq!(wire.ends[1].sent_packets() - before, 4 * CONFIG.resend_ticks + 1 + 5);
}

/// Every way to lose, repeat, hold back or damage a packet has its own count, and the sums come out.
#[test]
fn every_packet_is_accounted_for() {
    let mut wire = Wire::new();
    wire.run(10);
    let before = *wire.ends[0].counters();
    let mut held = Vec::new();
    let mut dice = 7_u64;
    let (mut damaged, mut duplicated) = (0, 0);
    for _ in 0..4_000 {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        wire.tick(|index, bytes| {
            if index == 1 {
                return;
            }
            match (dice >> 40) % 20 {
                0 => bytes.clear(),
                1 => {
                    duplicated += 1;
                    bytes.extend_from_within(..);
                }
                2 if held.is_empty() => held = std::mem::take(bytes),
                3 if !held.is_empty() => bytes.append(&mut held),
                4 => {
                    // The byte never becomes zero, so that one bad frame stays one.
                    let place = (dice >> 8) as usize % (bytes.len() - 1);
                    bytes[place] = if bytes[place] == 255 { 254 } else { bytes[place] + 1 };
                    damaged += 1;
                }
                _ => {}
            }
        });
    }
    let got = wire.got[0].iter().map(|(_, value)| *value).collect::<Vec<_>>();
    assert!(got.is_sorted_by(|a, b| a < b), "never back in time");
    let counters = *wire.ends[0].counters();
    assert_eq!(counters.damaged() - before.damaged(), damaged);
    assert_eq!(counters.duplicate, duplicated);
    assert!(counters.late > 20 && counters.lost > 20);
    let newest = wire.ends[0].window.newest();
    assert_eq!(counters.accepted + counters.late + counters.lost, newest);
}

#[test]
fn a_command_is_done_once_and_answered_however_often_it_is_sent() {
    let mut wire = Wire::new();
    wire.run(10);
    assert_eq!(wire.ends[1].command(Command::Mode(Request::Arm)), Some(1));
    assert_eq!(wire.ends[1].command(Command::Mode(Request::Stop)), None, "one at a time");
    let mut done = 0;
    for round in 0..40 {
        // The way back is cut at first, so that the command is sent again and again.
        wire.tick(|index, bytes| {
            if index == 1 && round < 15 {
                bytes.clear();
            }
        });
        if let Some(frame) = wire.ends[0].take_command() {
            assert_eq!(frame.command, Command::Mode(Request::Arm));
            done += 1;
            wire.ends[0].acknowledge(frame.id, Outcome::Mode(Mode::Run));
        }
    }
    assert_eq!(done, 1);
    let answer = wire.ends[1].take_ack();
    assert_eq!(answer, Some(Ack { id: 1, outcome: Outcome::Mode(Mode::Run) }));
    assert_eq!((wire.ends[1].take_ack(), wire.ends[1].is_commanding()), (None, false));
}

/// A command that was held back until after a later one is not done.
#[test]
fn a_late_command_is_not_done() {
    let mut wire = Wire::new();
    wire.run(10);
    wire.ends[1].command(Command::Mode(Request::Arm));
    let mut held = Vec::new();
    wire.tick(|index, bytes| {
        if index == 0 {
            held = std::mem::take(bytes);
        }
    });
    wire.tick(|_, _| ());
    wire.ends[0].feed(&held, 0);
    assert_eq!(wire.ends[0].take_command(), None);
    assert_eq!(wire.ends[0].counters().late, 2, "the command and the data of its tick");
}

/// What nobody takes from the buffer is not sent, and the peer sees no gap where nothing was sent.
#[test]
fn a_full_buffer_leaves_whole_packets_out() {
    let mut wire = Wire::new();
    wire.run(10);
    for _ in 0..15 {
        wire.ends[0].send_tick(0, 0, &Outgoing { values: &[1.0; 64], ..Outgoing::default() });
    }
    assert!(wire.ends[0].outgoing().len() <= OUTGOING_BYTES);
    assert!(wire.ends[0].counters().unsent >= 10);
    let bytes = wire.ends[0].outgoing().to_vec();
    wire.ends[0].sent(bytes.len());
    wire.ends[1].feed(&bytes, 0);
    assert_eq!((wire.ends[1].counters().lost, wire.ends[1].counters().damaged()), (0, 0));
}

/// A plant with a key does what those ask for who have it, and nothing else: not a command without a tag, not one of
/// another key, and not a recorded one in another session or once more in its own.
#[cfg(feature = "keyed")]
#[test]
fn a_plant_with_a_key_obeys_nobody_else() {
    let arm = Command::Mode(Request::Arm);
    let keys = [None, Some(Key::new([1; 32])), Some(Key::new([2; 32]))];
    for plants in keys {
        for controllers in keys {
            let mut wire = Wire::new();
            let [plant, controller] = wire.ends.clone();
            wire.ends = [plant.with_key(plants), controller.with_key(controllers)];
            wire.run(10);
            wire.ends[1].command(arm);
            let mut tape = Vec::new();
            let (mut done, mut answer) = (None, None);
            for _ in 0..4 {
                wire.tick(|end, bytes| {
                    if end == 0 {
                        tape.extend_from_slice(bytes);
                    }
                });
                if let Some(CommandFrame { id, command }) = wire.ends[0].take_command() {
                    done = Some(command);
                    wire.ends[0].acknowledge(id, Outcome::Mode(Mode::Run));
                }
                answer = wire.ends[1].take_ack().map(|ack| ack.outcome).or(answer);
            }
            let obeys = plants.is_none() || plants == controllers;
            assert_eq!(done, obeys.then_some(arm), "{plants:?} {controllers:?}");
            let refused = Outcome::Refused(crate::mode::Refusal::Key);
            assert_eq!(answer, Some(if obeys { Outcome::Mode(Mode::Run) } else { refused }));
            assert_eq!(wire.ends[0].counters().unproven > 0, !obeys);
            // The tape, once more in its session and in the next one of a plant that has another nonce.
            wire.ends[0].feed(&tape, 0);
            assert_eq!(wire.ends[0].take_command(), None);
            wire.ends[0] = Link::new(CONFIG, 99).with_key(plants);
            wire.run(60);
            assert!(wire.connected());
            wire.ends[0].feed(&tape, 0);
            assert_eq!(wire.ends[0].take_command(), None);
        }
    }
}
