//! What the firmware notes before it stops itself, in a form that survives a reset.
//!
//! The record lies in RAM that start-up code does not touch. After power-on that RAM holds anything, so a
//! check word tells a record from noise.

/// Why the firmware stopped itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A Rust panic, at this source line.
    Panic {
        /// Line number in its source file.
        line: u32,
    },
    /// The stack was too small.
    StackOverflow {
        /// Stack pointer at that moment.
        sp: u32,
    },
    /// The processor trapped: a bad address, an undefined instruction.
    HardFault {
        /// Address of the instruction.
        pc: u32,
    },
    /// An interrupt came for which there is no handler.
    UnexpectedInterrupt {
        /// Its number; negative for processor exceptions.
        number: i32,
    },
}

/// Three words: what, detail, check.
pub type Record = [u32; 3];

/// A record that says nothing.
pub const NO_RECORD: Record = [0; 3];

const PANIC: u32 = 0x5041_4E43;
const STACK_OVERFLOW: u32 = 0x5354_4143;
const HARD_FAULT: u32 = 0x4841_5244;
const UNEXPECTED_INTERRUPT: u32 = 0x4952_5155;
/// Neither zeroed nor all-ones RAM satisfies the check.
const CHECK: u32 = 0xA5C3_1E96;

/// Puts a fault into words.
pub fn encode(fault: Fault) -> Record {
    let (kind, detail) = match fault {
        Fault::Panic { line } => (PANIC, line),
        Fault::StackOverflow { sp } => (STACK_OVERFLOW, sp),
        Fault::HardFault { pc } => (HARD_FAULT, pc),
        Fault::UnexpectedInterrupt { number } => (UNEXPECTED_INTERRUPT, number.cast_unsigned()),
    };
    [kind, detail, check(kind, detail)]
}

/// Reads a fault back; `None` when the words are no record.
pub fn decode([kind, detail, word]: Record) -> Option<Fault> {
    if word != check(kind, detail) {
        return None;
    }
    match kind {
        PANIC => Some(Fault::Panic { line: detail }),
        STACK_OVERFLOW => Some(Fault::StackOverflow { sp: detail }),
        HARD_FAULT => Some(Fault::HardFault { pc: detail }),
        UNEXPECTED_INTERRUPT => Some(Fault::UnexpectedInterrupt { number: detail.cast_signed() }),
        _ => None,
    }
}

fn check(kind: u32, detail: u32) -> u32 {
    CHECK ^ kind.rotate_left(11) ^ detail.rotate_left(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAULTS: [Fault; 4] = [
        Fault::StackOverflow { sp: 0x1FFF_FFF8 },
        Fault::Panic { line: 42 },
        Fault::HardFault { pc: 0x0800_1234 },
        Fault::UnexpectedInterrupt { number: -12 },
    ];

    #[test]
    fn every_fault_survives_the_round_trip() {
        for fault in FAULTS {
            assert_eq!(decode(encode(fault)), Some(fault));
        }
    }

    #[test]
    fn noise_is_no_record() {
        assert_eq!(decode(NO_RECORD), None);
        assert_eq!(decode([u32::MAX; 3]), None);
        for fault in FAULTS {
            for bit in 0..96 {
                let mut record = encode(fault);
                record[bit / 32] ^= 1 << (bit % 32);
                assert_eq!(decode(record), None, "bit {bit}");
            }
        }
    }
}
