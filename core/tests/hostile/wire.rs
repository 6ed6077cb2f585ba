//! A wire that loses, repeats, holds back and damages packets at random, and knows what it did.

use eclss_core::mode::Mode;
use eclss_core::protocol::{Config, Link, Outgoing, Role};

use super::bytes::Dice;

/// What the wire did and the receiver found.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Report {
    pub(crate) sent: u32,
    pub(crate) accepted: u32,
    pub(crate) lost: u32,
    pub(crate) late: u32,
    pub(crate) duplicate: u32,
    pub(crate) spoiled: u32,
}

/// Sends so many packets of process data to a controller and checks every one of them.
pub(crate) fn run(packets: u32, seed: u64) -> Report {
    let config = |role| Config { role, silent_ticks: 1_000_000, ..Config::default() };
    let (mut plant, mut controller) =
        (Link::new(config(Role::Plant), 3), Link::new(config(Role::Controller), 4));
    for tick in 0..4 {
        for plant_sends in [true, false] {
            let (from, to) =
                if plant_sends { (&mut plant, &mut controller) } else { (&mut controller, &mut plant) };
            from.send_tick(tick, tick, &Outgoing::default());
            let bytes = from.outgoing().to_vec();
            from.sent(bytes.len());
            to.feed(&bytes, tick);
        }
    }
    controller.take_data();
    assert!(plant.is_connected() && controller.is_connected());
    let mut dice = Dice(seed);
    let mut report = Report::default();
    let before = *controller.counters();
    let mut held: Vec<(u32, Vec<u8>)> = Vec::new();
    let mut came = vec![false; packets as usize + 2];
    // What both ends said to find each other has come.
    let mut newest = plant.sent_packets();
    came[..=newest as usize].fill(true);
    let mut last = 0.0;
    while plant.sent_packets() < packets {
        let number = plant.sent_packets() + 1;
        let value = number as f32;
        plant.send_tick(0, 0, &Outgoing { mode: Mode::Run, values: &[value, -value], ..Outgoing::default() });
        let frame = plant.outgoing().to_vec();
        plant.sent(frame.len());
        let mut arrivals: Vec<(u32, Vec<u8>)> = Vec::new();
        match dice.roll(16) {
            0 => {}
            1 => arrivals.extend([(number, frame.clone()), (number, frame)]),
            2 => held.push((number, frame)),
            3 => {
                // One to three flipped bits, none of which makes a zero or spoils the last one: one frame stays one.
                let mut spoiled = frame.clone();
                for _ in 0..=dice.roll(3) {
                    let place = dice.roll(spoiled.len() - 1);
                    let flipped = spoiled[place] ^ 1 << dice.roll(8);
                    spoiled[place] = if flipped == 0 { spoiled[place] } else { flipped };
                }
                report.spoiled += u32::from(spoiled != frame);
                arrivals.push((if spoiled == frame { number } else { 0 }, spoiled));
            }
            _ => arrivals.push((number, frame)),
        }
        // What was held back comes later, in any order, up to forty packets after.
        if held.len() > 1 && dice.roll(8) == 0 {
            arrivals.push(held.swap_remove(dice.roll(held.len())));
        }
        held.retain(|(late, _)| number - late < 40);
        for (number, bytes) in arrivals {
            controller.feed(&bytes, 0);
            let fresh = number > newest;
            if number > 0 {
                report.duplicate += u32::from(came[number as usize]);
                report.late += u32::from(!fresh && !came[number as usize]);
                report.accepted += u32::from(fresh);
                came[number as usize] = true;
                newest = newest.max(number);
            }
            match controller.take_data() {
                Some(data) => {
                    assert!(fresh, "an old packet was taken");
                    assert!((data.values[0] - number as f32).abs() < 0.5 && data.values[0] > last);
                    last = data.values[0];
                }
                None => assert!(!fresh, "packet {number} was not taken"),
            }
        }
    }
    report.sent = plant.sent_packets();
    report.lost = newest - came.iter().skip(1).filter(|came| **came).count() as u32;
    let after = controller.counters();
    let counted = [after.accepted, after.late, after.duplicate, after.lost, after.damaged()];
    let earlier = [before.accepted, before.late, before.duplicate, before.lost, before.damaged()];
    let found: Vec<u32> = counted.iter().zip(earlier).map(|(after, before)| after - before).collect();
    assert_eq!(found, [report.accepted, report.late, report.duplicate, report.lost, report.spoiled]);
    report
}
