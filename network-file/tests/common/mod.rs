//! What the tests share: a small random generator and the files that they start from.

/// Random numbers that are the same in every run (xorshift64*).
pub struct Dice(u64);

impl Dice {
    /// Starts a sequence of its own for every seed.
    pub fn new(seed: u64) -> Self {
        let mut dice = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..8 {
            dice.roll();
        }
        dice
    }

    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 16
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.roll() % end.max(1) as u64) as usize
    }

    /// One of a list.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// The shipped network of the paper.
pub const PAPER: &str = include_str!("../../../networks/paper.toml");

/// One of everything that the format knows.
pub const ZOO: &str = include_str!("../generated/zoo.toml");
