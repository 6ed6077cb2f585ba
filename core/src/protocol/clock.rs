//! The peer's clock against our own: offset from the exchange that took least time, drift from one to the next.
//!
//! As in NTP: of our packet's departure t1, its arrival t2 and the answer's departure t3 on the peer's clock, and
//! the answer's arrival t4, the round trip is (t4 − t1) − (t3 − t2), and the peer is ahead by half of
//! (t2 − t1) + (t3 − t4), wrong by at most half of the round trip. Queues only ever add time, so that of many
//! exchanges the shortest says most. Source: RFC 5905.

/// One exchange.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Estimate {
    /// When it ended on our clock \[µs\].
    pub at_us: u64,
    /// Time that both ways took together \[µs\].
    pub round_trip_us: u64,
    /// The peer's clock minus ours \[µs\], within half of the round trip.
    pub offset_us: i64,
}

/// By how much the peer's clock runs faster than ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drift {
    /// The drift \[10⁻⁹\].
    pub ppb: i64,
    /// Bound of its error \[10⁻⁹\]: both offsets are known within half of their round trip, and no better.
    pub error_ppb: i64,
}

/// Exchanges among which the shortest is chosen.
const EXCHANGES: u32 = 256;

/// Running estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Clock {
    first: Option<Estimate>,
    latest: Option<Estimate>,
    best: Option<Estimate>,
    exchanges: u32,
}

impl Clock {
    /// Takes one exchange: our packet of `sent_us` came back at `now_us` in one of `peer_us`, after it had waited
    /// there for `age_us`. Impossible ones are left out.
    pub fn exchange(&mut self, sent_us: u64, peer_us: u64, age_us: u32, now_us: u64) {
        let round_trip = now_us.checked_sub(sent_us).and_then(|away| away.checked_sub(u64::from(age_us)));
        let Some(round_trip_us) = round_trip else { return };
        // The peer's clock stood at `peer_us` half of a round trip ago.
        let then_us = now_us.saturating_sub(round_trip_us / 2);
        let offset_us = peer_us.wrapping_sub(then_us).cast_signed();
        let estimate = Estimate { at_us: now_us, round_trip_us, offset_us };
        if self.best.is_none_or(|best| round_trip_us < best.round_trip_us) {
            self.best = Some(estimate);
        }
        self.exchanges += 1;
        if self.exchanges == EXCHANGES {
            self.exchanges = 0;
            self.latest = self.best.take();
            self.first = self.first.or(self.latest);
        }
    }

    /// The best exchange of the latest 256, or of those there are.
    pub fn estimate(&self) -> Option<Estimate> {
        self.latest.or(self.best)
    }

    /// By how much the peer's clock runs faster than ours; `None` until there are two estimates a second apart.
    pub fn drift(&self) -> Option<Drift> {
        let (first, latest) = (self.first?, self.latest?);
        let span_us = i64::try_from(latest.at_us.checked_sub(first.at_us)?).ok()?;
        let grown_us = latest.offset_us.checked_sub(first.offset_us)?;
        // Half of both round trips, and a microsecond for each of the four stamps.
        let wrong_us = i64::try_from((first.round_trip_us + latest.round_trip_us).div_ceil(2) + 4).ok()?;
        let part = |us: i64| us.saturating_mul(1_000_000_000) / span_us;
        (span_us >= 1_000_000).then(|| Drift { ppb: part(grown_us), error_ppb: part(wrong_us) + 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that is 5 s ahead and 40 ppm fast, over ways that take 100 µs and sometimes up to 3 ms more.
    #[test]
    fn offset_and_drift_come_out_of_jittery_exchanges() {
        let mut clock = Clock::default();
        let peer = |us: u64| 5_000_000 + us + us * 40 / 1_000_000;
        let mut dice = 1_u64;
        for tick in 0..20_000_u64 {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (there, back) = (100 + (dice >> 40) % 3_000, 100 + (dice >> 20) % 3_000);
            let sent = tick * 1_000;
            let answered = sent + there + 500;
            clock.exchange(sent, peer(answered), 500, answered + back);
        }
        let estimate = clock.estimate().unwrap();
        let true_offset = (peer(estimate.at_us) - estimate.at_us).cast_signed();
        assert!((estimate.offset_us - true_offset).abs() < 150, "{estimate:?}, not {true_offset}");
        let drift = clock.drift().unwrap();
        assert!((drift.ppb - 40_000).abs() < 10_000, "{drift:?}");
    }

    /// Ways whose asymmetry changes look like a drift: the bound of the error holds, and is reached.
    #[test]
    fn a_drift_is_known_within_its_error() {
        for (there_us, back_us) in [(100, 100), (100, 4_000), (4_000, 100)] {
            for true_ppm in [-200, 0, 40] {
                let mut clock = Clock::default();
                let peer = |us: i64| (5_000_000 + us + us * true_ppm / 1_000_000).cast_unsigned();
                for tick in 0..8_000_i64 {
                    let sent = 1_000_000 + tick * 1_000;
                    let (there, back) = if tick < 4_000 { (500, 500) } else { (there_us, back_us) };
                    let answered = sent + there;
                    clock.exchange(
                        sent.cast_unsigned(),
                        peer(answered),
                        0,
                        (answered + back).cast_unsigned(),
                    );
                }
                let Drift { ppb, error_ppb } = clock.drift().unwrap();
                let wrong = (ppb - 1_000 * true_ppm).abs();
                assert!(wrong <= error_ppb, "{ppb} ± {error_ppb}, truly {true_ppm} ppm");
                assert!(
                    there_us == back_us || 2 * wrong > error_ppb,
                    "{wrong} of {error_ppb}: a bound, no guess"
                );
            }
        }
    }

    #[test]
    fn exchanges_that_cannot_be_are_left_out() {
        let mut clock = Clock::default();
        clock.exchange(2_000, 0, 0, 1_000);
        clock.exchange(0, 0, 2_000, 1_000);
        assert_eq!(clock.estimate(), None);
    }
}
