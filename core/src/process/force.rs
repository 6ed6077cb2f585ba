//! Forces: what a test puts in a channel's place, as a fault of the wire or of what hangs on it.

/// Value that a channel carries instead of its signal, in the channel's unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Force {
    /// The signal itself.
    #[default]
    None,
    /// This value, whatever comes.
    Value(f32),
    /// The signal and so much more.
    Offset(f32),
    /// The signal and noise of up to this amplitude, uniform, from a seed that goes on with each sample.
    Noise(f32, u32),
    /// The signal as it was when this began.
    Stuck,
    /// Nothing, as from a wire that has come off.
    OpenWire,
}

impl Force {
    /// The signal with what is added to it, where something is.
    pub(super) fn added(&mut self, signal: f32) -> f32 {
        match self {
            Self::Offset(more) => signal + *more,
            Self::Noise(amplitude, seed) => {
                // Marsaglia's xorshift of 32 bits, which never leaves 0.
                let mut bits = (*seed).max(1);
                bits ^= bits << 13;
                bits ^= bits >> 17;
                bits ^= bits << 5;
                *seed = bits;
                signal + *amplitude * ((bits >> 8) as f32 / 8_388_608.0 - 1.0)
            }
            _ => signal,
        }
    }
}
