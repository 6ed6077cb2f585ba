//! When outputs are given out: `latched` a constant tick after their inputs were read, `immediate` as soon as the step is
//! done, which is one tick earlier on the wire. Measured by loopback, over the bytes of the link.

use crate::bench::{HIL, Operator, Peer, run_on};
use eclss_core::mode::Mode;
use eclss_network_file::{Loaded, parse};
use eclss_target::loopback::{Loopback, Passed};
use std::cell::Cell;
use std::rc::Rc;

/// From reading to writing, tick by tick [µs].
const TAKES_US: [u64; 4] = [120, 900, 350, 10];
/// Period of the loop [µs].
const TICK_US: u32 = 1_000;

/// A loopback through the valve: what is sent as its opening comes back as an output.
struct Prober {
    operator: Operator,
    loopback: Loopback,
    passed: Vec<Passed>,
    /// Ticks from handing a sample over to finding it in what was written.
    on_the_wire: Vec<u64>,
    sent_at: u64,
}

impl Peer for Prober {
    fn tick(&mut self, tick: u64, bytes: &[u8]) -> Vec<u8> {
        self.operator.values[0] = self.loopback.sample();
        let sequence = self.operator.link.newest().sequence;
        let bytes = self.operator.exchange(tick, bytes);
        let newest = self.operator.link.newest();
        if newest.sequence != sequence
            && let Some(passed) = self.loopback.came(newest)
        {
            self.passed.push(passed);
            self.on_the_wire.push(tick - self.sent_at);
        }
        let carries = self.operator.values[0].to_bits() == self.loopback.sample().to_bits();
        if carries && self.operator.link.is_connected() && self.loopback.is_fresh() {
            self.sent_at = tick;
            self.loopback.sent(self.operator.link.sent_packets());
        }
        bytes
    }
}

/// `networks/hil.toml` with the valve's opening as an output and a channel that only passes it on.
fn network(order: &str) -> Loaded {
    let text = HIL
        .replace("order = \"latched\"", &format!("order = \"{order}\""))
        .replace("hold = \"linear\"\nevent_step = 0.01\n", "hold = \"zero\"\n")
        .replace(
            "safe_rate_per_s = 0.5\n\n[[channel]]\nbind = \"fan.speed\"",
            "safe_rate_per_s = 1e9\n\n[[channel]]\nbind = \"fan.speed\"",
        );
    let back = "\n[[channel]]\nbind = \"valve.opening\"\ndirection = \"out\"\nmin = 0.0\nmax = 1.0\n\
                safe_value = 1.0\nsafe_rate_per_s = 1e9\n";
    parse(&(text + back), "orders.toml").expect("a sound network")
}

/// What samples took [µs, ticks], and ticks until they were found on the wire.
fn measure(order: &str) -> (Vec<Passed>, Vec<u64>) {
    let loaded = network(order);
    let told = Rc::new(Cell::new((0, Mode::PowerUp)));
    let peer = Prober {
        operator: Operator::of(&loaded, &[1.0, 1.0]),
        loopback: Loopback::new(2, 1.0, 0.99),
        passed: Vec::new(),
        on_the_wire: Vec::new(),
        sent_at: 0,
    };
    let (peer, _) = run_on(&loaded, peer, 20_000, &told, false, &TAKES_US);
    (peer.passed, peer.on_the_wire)
}

#[test]
fn latched_outputs_are_one_tick_late_and_never_more_or_less() {
    let (passed, _) = measure("latched");
    assert!(passed.len() > 1_000, "{} samples", passed.len());
    assert!(passed.iter().all(|passed| *passed == Passed { us: TICK_US, ticks: 1 }), "{:?}", passed.last());
}

#[test]
fn immediate_outputs_are_as_late_as_their_tick_takes() {
    let (passed, _) = measure("immediate");
    assert!(passed.len() > 1_000, "{} samples", passed.len());
    for Passed { us, ticks } in passed {
        assert!(ticks == 0 && TAKES_US.contains(&u64::from(us)), "{us} µs, {ticks} ticks");
    }
}

#[test]
fn immediate_outputs_reach_the_wire_one_tick_earlier() {
    let (latched, immediate) = (measure("latched").1, measure("immediate").1);
    let all = |ticks: &[u64]| {
        let first = ticks[0];
        let others = ticks.iter().filter(|other| **other != first).count();
        assert_eq!(others, 0, "they differ");
        first
    };
    assert_eq!(all(&latched), all(&immediate) + 1);
}
