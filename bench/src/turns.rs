//! Measures several things in turns, so that whatever else the machine does falls on all of them alike.

use std::time::Instant;

/// Shortest batch that is timed [ns]: a hundred times what reading the clock costs.
const BATCH_NS: f64 = 20_000.0;

/// One thing to be measured.
pub struct Contender<'c> {
    run: Box<dyn FnMut(u32) + 'c>,
    /// Calls per batch.
    batch: u32,
    /// Time per call of every batch [ns].
    batches_ns: Vec<f64>,
}

impl<'c> Contender<'c> {
    /// Takes a closure that does the thing as often as it is told.
    pub fn new(run: impl FnMut(u32) + 'c) -> Self {
        Self { run: Box::new(run), batch: 1, batches_ns: Vec::new() }
    }

    fn time(&mut self, calls: u32) -> f64 {
        let start = Instant::now();
        (self.run)(calls);
        start.elapsed().as_secs_f64() * 1e9
    }

    /// Finds how many calls make a batch.
    fn calibrate(&mut self) {
        self.time(1);
        while self.time(self.batch) < BATCH_NS && self.batch < 1 << 20 {
            self.batch *= 2;
        }
    }

    fn turn(&mut self) {
        // Brings the arrays back that the others have pushed out of the cache: what is asked for is the cost of one of
        // many calls in a row.
        (self.run)(1);
        let batch = self.batch;
        let nanoseconds = self.time(batch);
        self.batches_ns.push(nanoseconds / f64::from(batch));
    }

    /// Median time per call [ns].
    pub fn median_ns(&self) -> f64 {
        median(self.batches_ns.clone())
    }

    /// Median over the turns of this time per call over that of `other` in the same turn.
    pub fn ratio_to(&self, other: &Self) -> f64 {
        median(self.batches_ns.iter().zip(&other.batches_ns).map(|(own, other)| own / other).collect())
    }
}

/// Gives every contender `turns` turns, one after the other.
pub fn take(contenders: &mut [Contender<'_>], turns: usize) {
    for contender in &mut *contenders {
        contender.calibrate();
    }
    for _ in 0..turns {
        for contender in &mut *contenders {
            contender.turn();
        }
    }
}

/// Frames of a run that was repeated [ns].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// Mean over frames, every frame with the fastest of its repeats.
    pub mean_ns: f64,
    /// Longest frame that came back: every frame with the fastest of its repeats, because an interruption by the
    /// operating system hits another frame each time and what the method costs does not.
    pub repeated_ns: f64,
    /// Longest frame of all repeats, whatever made it long.
    pub worst_ns: f64,
}

/// Times the frames of a run and of its repeats.
pub fn frames<E>(
    repeats: usize,
    mut run: impl FnMut(&mut dyn FnMut(f64)) -> Result<(), E>,
) -> Result<Frames, E> {
    let mut fastest: Vec<f64> = Vec::new();
    let mut worst_ns = 0.0f64;
    for repeat in 0..repeats {
        let mut frame = 0;
        run(&mut |nanoseconds| {
            worst_ns = worst_ns.max(nanoseconds);
            match fastest.get_mut(frame) {
                Some(known) => *known = known.min(nanoseconds),
                None if repeat == 0 => fastest.push(nanoseconds),
                None => {}
            }
            frame += 1;
        })?;
    }
    let mean_ns = fastest.iter().sum::<f64>() / fastest.len().max(1) as f64;
    Ok(Frames { mean_ns, repeated_ns: fastest.iter().copied().fold(0.0, f64::max), worst_ns })
}

/// The middle of the values; NaN for none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interruption_of_one_repeat_counts_as_the_worst_frame_only() {
        let mut repeat = 0;
        let frames = frames::<()>(2, |frame| {
            repeat += 1;
            let disturbed = if repeat == 1 { 900.0 } else { 10.0 };
            [10.0, disturbed, 13.0].into_iter().for_each(frame);
            Ok(())
        })
        .unwrap();
        assert!((frames.mean_ns - 11.0).abs() < 1e-9 && (frames.repeated_ns - 13.0).abs() < 1e-9);
        assert!((frames.worst_ns - 900.0).abs() < 1e-9);
    }

    #[test]
    fn twice_the_work_is_twice_the_ratio() {
        let work = |calls: u32| {
            for index in 0..calls * 2_000 {
                std::hint::black_box(index);
            }
        };
        let mut both = [Contender::new(work), Contender::new(move |calls| work(2 * calls))];
        take(&mut both, 21);
        let ratio = both[1].ratio_to(&both[0]);
        assert!((1.5..2.7).contains(&ratio), "{ratio}");
    }
}
