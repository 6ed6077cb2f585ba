//! Which packets have come: tells new ones from duplicates and late ones and counts what is missing.

/// What a sequence number says about its packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// Newer than all before; so many between them are missing.
    New {
        /// Packets missing so far.
        missing: u32,
    },
    /// Older than the newest, and had been missing.
    Late,
    /// Has come before.
    Duplicate,
    /// So old that nobody knows any more whether it had come.
    Ancient,
}

/// The newest sequence number and which of the 64 up to it have come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Window {
    newest: u32,
    /// Bit n stands for `newest − n`.
    came: u64,
}

impl Window {
    /// The newest sequence number; 0 before the first.
    pub fn newest(&self) -> u32 {
        self.newest
    }

    /// Takes note of a packet. Numbers start at 1 and may wrap.
    pub fn arrive(&mut self, sequence: u32) -> Arrival {
        let ahead = sequence.wrapping_sub(self.newest);
        if ahead == 0 {
            return if self.came & 1 == 0 { Arrival::Ancient } else { Arrival::Duplicate };
        }
        // Half of all numbers are ahead, half behind.
        if ahead < 1 << 31 {
            self.came = self.came.checked_shl(ahead).unwrap_or(0) | 1;
            self.newest = sequence;
            return Arrival::New { missing: ahead - 1 };
        }
        let behind = self.newest.wrapping_sub(sequence);
        let Some(bit) = 1_u64.checked_shl(behind) else { return Arrival::Ancient };
        let had = self.came & bit != 0;
        self.came |= bit;
        if had { Arrival::Duplicate } else { Arrival::Late }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_packet_is_one_thing_only() {
        let mut window = Window::default();
        assert_eq!(window.arrive(0), Arrival::Ancient, "numbers start at 1");
        assert_eq!(window.arrive(1), Arrival::New { missing: 0 });
        assert_eq!(window.arrive(1), Arrival::Duplicate);
        assert_eq!(window.arrive(5), Arrival::New { missing: 3 });
        assert_eq!((window.arrive(3), window.arrive(3), window.arrive(1)), {
            (Arrival::Late, Arrival::Duplicate, Arrival::Duplicate)
        });
        assert_eq!(window.arrive(105), Arrival::New { missing: 99 });
        assert_eq!((window.arrive(42), window.arrive(41)), (Arrival::Late, Arrival::Ancient));
    }

    #[test]
    fn numbers_wrap() {
        let mut window = Window { newest: u32::MAX - 1, came: 1 };
        assert_eq!(window.arrive(u32::MAX), Arrival::New { missing: 0 });
        assert_eq!(window.arrive(1), Arrival::New { missing: 1 });
        assert_eq!((window.arrive(0), window.arrive(u32::MAX)), (Arrival::Late, Arrival::Duplicate));
    }
}
