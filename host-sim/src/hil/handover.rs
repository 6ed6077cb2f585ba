//! From the loop to recorder and display: a ring that never makes the loop wait.
//!
//! Every tick is one row of words of a fixed length. Where the ring is full the row is dropped and counted, and the
//! next row that fits carries the count.

use rtrb::{Consumer, Producer, RingBuffer};

/// How many values of each kind a row has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Inputs, each with value and slope.
    pub inputs: usize,
    /// Recorded figures.
    pub figures: usize,
}

const HEAD_WORDS: usize = 12;

impl Layout {
    fn words(self) -> usize {
        HEAD_WORDS + 2 * self.inputs + self.figures
    }
}

/// What is known of a tick beside its values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Head {
    /// Ticks of the loop before this one.
    pub tick: u64,
    /// Steps that the plant has taken, with this tick's.
    pub plant_tick: u64,
    /// Wall time at which the tick began [µs since the loop started].
    pub begun_us: u64,
    /// How long after its release it began [ns].
    pub late_ns: u32,
    /// From reading inputs to having written outputs [ns].
    pub tick_ns: u32,
    /// Releases that it ran over.
    pub skipped: u32,
    /// Mode of the loop, in the order of [`eclss_core::mode::Mode::ALL`].
    pub mode: u8,
    /// Whether the plant took a step.
    pub stepped: bool,
    /// Rows dropped since the start, before this one.
    pub dropped: u32,
}

impl Head {
    fn to_words(self) -> [u32; HEAD_WORDS] {
        let low = |long: u64| long as u32;
        let high = |long: u64| (long >> 32) as u32;
        [
            low(self.tick),
            high(self.tick),
            low(self.plant_tick),
            high(self.plant_tick),
            low(self.begun_us),
            high(self.begun_us),
            self.late_ns,
            self.tick_ns,
            self.skipped,
            u32::from(self.mode),
            u32::from(self.stepped),
            self.dropped,
        ]
    }

    fn of_words(words: &[u32]) -> Self {
        let word = |index: usize| words.get(index).copied().unwrap_or(0);
        let long = |index: usize| u64::from(word(index)) | u64::from(word(index + 1)) << 32;
        Self {
            tick: long(0),
            plant_tick: long(2),
            begun_us: long(4),
            late_ns: word(6),
            tick_ns: word(7),
            skipped: word(8),
            mode: word(9) as u8,
            stepped: word(10) != 0,
            dropped: word(11),
        }
    }
}

/// The loop's end.
#[derive(Debug)]
pub struct Giver {
    ring: Producer<u32>,
    row: Vec<u32>,
    dropped: u32,
}

/// The other end.
#[derive(Debug)]
pub struct Taker {
    ring: Consumer<u32>,
    layout: Layout,
    words: Vec<u32>,
    row: Row,
}

/// One tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// What is known beside the values.
    pub head: Head,
    /// Value and slope [unit/s] of every input, as the step got them.
    pub inputs: Vec<[f32; 2]>,
    /// The recorded figures.
    pub figures: Vec<f32>,
}

/// Makes a ring with room for `rows` ticks.
pub fn ring(layout: Layout, rows: usize) -> (Giver, Taker) {
    let words = layout.words();
    let (producer, consumer) = RingBuffer::new(words * rows.max(1));
    let giver = Giver { ring: producer, row: vec![0; words], dropped: 0 };
    let row = Row {
        head: Head::default(),
        inputs: vec![[0.0; 2]; layout.inputs],
        figures: vec![0.0; layout.figures],
    };
    (giver, Taker { ring: consumer, layout, words: vec![0; words], row })
}

impl Giver {
    /// Hands over one tick; what the layout has no room for is left out, what is missing is NaN. Neither waits nor
    /// allocates. `dropped` of the head is filled in here.
    pub fn give(
        &mut self,
        head: Head,
        inputs: impl Iterator<Item = [f32; 2]>,
        figures: impl Iterator<Item = f32>,
        layout: Layout,
    ) {
        let head = Head { dropped: self.dropped, ..head };
        let inputs = inputs.chain(std::iter::repeat([f32::NAN; 2])).take(layout.inputs).flatten();
        let figures = figures.chain(std::iter::repeat(f32::NAN)).take(layout.figures);
        let values = inputs.chain(figures).map(f32::to_bits);
        for (place, word) in self.row.iter_mut().zip(head.to_words().into_iter().chain(values)) {
            *place = word;
        }
        if self.ring.push_entire_slice(&self.row).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Rows dropped since the start.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }
}

impl Taker {
    /// How many values a row has.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Takes the oldest row, if there is one.
    pub fn take(&mut self) -> Option<&Row> {
        self.ring.pop_entire_slice(&mut self.words).ok()?;
        let (head, values) = self.words.split_at(HEAD_WORDS);
        self.row.head = Head::of_words(head);
        let (inputs, figures) = values.split_at(2 * self.layout.inputs);
        for (place, pair) in self.row.inputs.iter_mut().zip(inputs.chunks_exact(2)) {
            *place = [f32::from_bits(pair[0]), f32::from_bits(pair[1])];
        }
        for (place, word) in self.row.figures.iter_mut().zip(figures) {
            *place = f32::from_bits(*word);
        }
        Some(&self.row)
    }

    /// Whether the other end is gone; what it gave last can still be taken.
    pub fn is_abandoned(&self) -> bool {
        self.ring.is_abandoned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: Layout = Layout { inputs: 1, figures: 2 };

    fn give(giver: &mut Giver, tick: u64) {
        let value = tick as f32;
        let head = Head { tick, plant_tick: tick << 33, stepped: true, mode: 3, ..Head::default() };
        giver.give(head, [[value, -value]].into_iter(), [2.0 * value].into_iter(), LAYOUT);
    }

    #[test]
    fn rows_come_out_as_they_went_in() {
        let (mut giver, mut taker) = ring(LAYOUT, 4);
        for tick in 0..100 {
            give(&mut giver, tick);
            let row = taker.take().expect("there is one");
            assert_eq!((row.head.tick, row.head.plant_tick, row.head.mode), (tick, tick << 33, 3));
            assert_eq!((row.inputs[0], row.figures[0]), ([tick as f32, -(tick as f32)], 2.0 * tick as f32));
            assert!(row.figures[1].is_nan(), "what was not given");
            assert!(taker.take().is_none());
        }
    }

    /// Every row is either taken or counted as dropped, whole rows at a time.
    #[test]
    fn a_full_ring_drops_rows_and_says_so() {
        let (mut giver, mut taker) = ring(LAYOUT, 4);
        (0..10).for_each(|tick| give(&mut giver, tick));
        assert_eq!(giver.dropped(), 6);
        let taken: Vec<u64> = std::iter::from_fn(|| taker.take().map(|row| row.head.tick)).collect();
        assert_eq!(taken, [0, 1, 2, 3]);
        give(&mut giver, 10);
        assert_eq!(taker.take().map(|row| (row.head.tick, row.head.dropped)), Some((10, 6)));
        drop(giver);
        assert!(taker.is_abandoned());
    }

    #[test]
    fn across_threads_nothing_is_lost_or_torn() {
        let (mut giver, mut taker) = ring(LAYOUT, 64);
        let thread = std::thread::spawn(move || {
            (0..50_000).for_each(|tick| give(&mut giver, tick));
            giver.dropped()
        });
        let (mut seen, mut last) = (0u32, None);
        loop {
            let ends = taker.is_abandoned();
            while let Some(row) = taker.take() {
                assert!(last.is_none_or(|last| row.head.tick > last));
                assert_eq!(row.figures[0].to_bits(), (2.0 * row.head.tick as f32).to_bits());
                (seen, last) = (seen + 1, Some(row.head.tick));
            }
            if ends {
                break;
            }
        }
        assert_eq!(seen + thread.join().unwrap(), 50_000);
    }
}
