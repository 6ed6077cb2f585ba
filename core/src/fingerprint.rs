//! A 64-bit FNV-1a hash over words, for network ids and state hashes.
//!
//! Values whose bits the processor leaves open are made canonical first: −0 counts as +0 and every NaN as the
//! same one, because the sign of a zero and the payload of a NaN differ between processors.

/// Running hash of a sequence of words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Adds the four bytes of `word`, lowest first.
    pub fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds the bits of `value`, with −0 as +0 and every NaN as one.
    pub fn value(&mut self, value: f32) {
        let bits = if value.is_nan() {
            0x7fc0_0000
        } else if value == 0.0 {
            0
        } else {
            value.to_bits()
        };
        self.word(bits);
    }

    /// Adds every value of a slice in order.
    pub fn values(&mut self, values: &[f32]) {
        for &value in values {
            self.value(value);
        }
    }

    /// Adds both halves of `word`, lower first.
    pub fn long(&mut self, word: u64) {
        self.word(word as u32);
        self.word((word >> 32) as u32);
    }

    /// Returns the hash of everything added so far.
    pub fn finish(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_published_test_vector() {
        // FNV-1a 64 of the four bytes "abcd" [Noll's test suite].
        let mut hash = Fingerprint::default();
        hash.word(u32::from_le_bytes(*b"abcd"));
        assert_eq!(hash.finish(), 0xfc17_9f83_ee07_24dd);
    }

    #[test]
    fn one_flipped_bit_is_seen_and_signs_of_zero_are_not() {
        let of = |values: &[f32]| {
            let mut hash = Fingerprint::default();
            hash.values(values);
            hash.finish()
        };
        assert_ne!(of(&[1.0, 2.0]), of(&[1.0, f32::from_bits(2.0f32.to_bits() ^ 1)]));
        assert_eq!(of(&[0.0]), of(&[-0.0]));
        assert_eq!(of(&[f32::NAN]), of(&[-f32::NAN]));
    }
}
