//! Cycles of a Cortex-M4F instruction, from its bits.
//!
//! Source: Arm DDI 0439 (Cortex-M4 TRM), tables 3-1 and 7-1. Where the table gives a range the upper end is taken:
//! a taken branch refills the pipeline in 3 cycles, a division of integers takes 12, no load overlaps with
//! another instruction, no `IT` is folded, and a floating-point result that the next instruction consumes costs
//! one cycle more. Memory answers without wait states.

/// Cycles to refill the pipeline behind a taken branch, P.
const REFILL: u32 = 3;

/// What an instruction costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cost {
    /// Bytes of the instruction.
    pub(crate) length: u32,
    /// Cycles when the next instruction is the one behind it.
    pub(crate) cycles: u32,
    /// Cycles more when it is not.
    pub(crate) when_taken: u32,
    /// The single-precision register that an arithmetic instruction writes.
    pub(crate) writes: Option<u8>,
    /// Single-precision registers that it reads.
    pub(crate) reads: [Option<u8>; 3],
}

/// Returns what the instruction that starts with these half words costs.
pub(crate) fn cost(first: u16, second: u16) -> Cost {
    if first >> 11 < 0b11101 {
        let cycles = narrow(first);
        return Cost { length: 2, cycles, when_taken: REFILL, writes: None, reads: [None; 3] };
    }
    let cost = Cost { length: 4, cycles: 1, when_taken: REFILL, writes: None, reads: [None; 3] };
    let floating = first >> 10 == 0b11_1011 && matches!(second >> 8 & 0xf, 0xa | 0xb);
    if floating { float(first, second, cost) } else { Cost { cycles: wide(first, second), ..cost } }
}

/// A 16-bit instruction.
fn narrow(bits: u16) -> u32 {
    let listed = u32::from(bits & 0xff).count_ones();
    let load = bits & 0x0800 != 0;
    match bits >> 12 {
        4 if bits & 0x0800 != 0 => 2,
        5 => access(bits >> 9 & 7 >= 3),
        6..=9 => access(load),
        0xb if bits & 0xf600 == 0xb400 => 1 + listed + u32::from(bits >> 8 & 1),
        0xc => 1 + listed,
        _ => 1,
    }
}

/// A load waits for its data, a store leaves it to the write buffer.
fn access(load: bool) -> u32 {
    if load { 2 } else { 1 }
}

/// A 32-bit instruction that is not floating-point.
fn wide(first: u16, second: u16) -> u32 {
    let load = first & 0x10 != 0;
    match first >> 8 {
        0xe8 | 0xe9 if first & 0x40 == 0 => 1 + second.count_ones(),
        // Table branches, two words at once, exclusive accesses.
        0xe8 | 0xe9 => {
            if first & 0xfff0 == 0xe8d0 {
                2
            } else {
                3
            }
        }
        0xf8 | 0xf9 => access(load),
        0xfb if first & 0xffd0 == 0xfb90 => 12,
        0xfb if first & 0xff80 == 0xfb00 && second >> 12 != 0xf => 2,
        _ => 1,
    }
}

/// A floating-point instruction.
fn float(first: u16, second: u16, cost: Cost) -> Cost {
    let register = |field: u16, low: u16| Some((field & 0xf) as u8 * 2 + (low & 1) as u8);
    let d = register(second >> 12, first >> 6);
    let n = register(first, second >> 7);
    let m = register(second, second >> 5);
    if first & 0x0200 == 0 {
        let stored = if first & 0x10 == 0 { d } else { None };
        let cycles = match () {
            () if first & 0xffe0 == 0xec40 => 2,
            // One register, else as many as the last byte says.
            () if first & 0x0120 == 0x0100 => 2,
            () => 1 + u32::from(second & 0xff),
        };
        return Cost { cycles, reads: [stored, None, None], ..cost };
    }
    if second & 0x10 != 0 {
        // Between a core register and a floating-point one.
        let read = if first & 0x10 != 0 { n } else { None };
        return Cost { reads: [read, None, None], ..cost };
    }
    match first >> 4 & 0xb {
        0x0 | 0x1 | 0x9 | 0xa => Cost { cycles: 3, writes: d, reads: [d, n, m], ..cost },
        0x2 | 0x3 => Cost { writes: d, reads: [n, m, None], ..cost },
        0x8 => Cost { cycles: 14, writes: d, reads: [n, m, None], ..cost },
        _ => one_operand(first, second, cost, d, m),
    }
}

/// Moves, signs, roots, comparisons and conversions.
fn one_operand(first: u16, second: u16, cost: Cost, d: Option<u8>, m: Option<u8>) -> Cost {
    let immediate = second & 0x40 == 0;
    match first & 0xf {
        _ if immediate => Cost { writes: d, ..cost },
        0x1 if second & 0x80 != 0 => Cost { cycles: 14, writes: d, reads: [m, None, None], ..cost },
        0x4 | 0x5 => Cost { reads: [d, m, None], ..cost },
        _ => Cost { writes: d, reads: [m, None, None], ..cost },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Encodings as an assembler writes them, with the manual's cycles.
    #[test]
    fn cycles_of_the_manual() {
        for (first, second, cycles, what) in [
            (0x1840, 0, 1, "adds r0, r0, r1"),
            (0x6808, 0, 2, "ldr r0, [r1]"),
            (0x6008, 0, 1, "str r0, [r1]"),
            (0x4800, 0, 2, "ldr r0, [pc]"),
            (0xb5f0, 0, 6, "push {r4-r7, lr}"),
            (0xbdf0, 0, 6, "pop {r4-r7, pc}"),
            (0xc80e, 0, 4, "ldm r0!, {r1-r3}"),
            (0x4770, 0, 1, "bx lr"),
            (0xe8bd, 0x87f0, 9, "pop.w {r4-r10, pc}"),
            (0xe9d0, 0x1200, 3, "ldrd r1, r2, [r0]"),
            (0xf8d0, 0x1004, 2, "ldr.w r1, [r0, #4]"),
            (0xf8c0, 0x1004, 1, "str.w r1, [r0, #4]"),
            (0xfb90, 0xf0f1, 12, "sdiv r0, r0, r1"),
            (0xfbb0, 0xf0f1, 12, "udiv r0, r0, r1"),
            (0xfb00, 0xf001, 1, "mul r0, r0, r1"),
            (0xfb00, 0x2001, 2, "mla r0, r0, r1, r2"),
            (0xfba0, 0x0101, 1, "umull r0, r1, r0, r1"),
            (0xee30, 0x0a20, 1, "vadd.f32 s0, s0, s1"),
            (0xee20, 0x0a20, 1, "vmul.f32 s0, s0, s1"),
            (0xee80, 0x0a20, 14, "vdiv.f32 s0, s0, s1"),
            (0xeeb1, 0x0ac0, 14, "vsqrt.f32 s0, s0"),
            (0xee00, 0x0a20, 3, "vmla.f32 s0, s0, s1"),
            (0xeeb0, 0x0ac0, 1, "vabs.f32 s0, s0"),
            (0xeef1, 0xfa10, 1, "vmrs apsr_nzcv, fpscr"),
            (0xed90, 0x0a00, 2, "vldr s0, [r0]"),
            (0xed80, 0x0a00, 2, "vstr s0, [r0]"),
            (0xec90, 0x0a04, 5, "vldmia r0, {s0-s3}"),
            (0xed2d, 0x8b04, 5, "vpush {d8-d9}"),
            (0xec51, 0x0a10, 2, "vmov r0, r1, s0, s1"),
            (0xee10, 0x0a10, 1, "vmov r0, s0"),
        ] {
            assert_eq!(cost(first, second).cycles, cycles, "{what}");
        }
        assert_eq!((cost(0x1840, 0).length, cost(0xee30, 0x0a20).length), (2, 4));
    }

    #[test]
    fn registers_of_floating_point_arithmetic() {
        // vadd.f32 s3, s5, s7; vmul.f32 s4, s3, s0
        let (sum, product) = (cost(0xee72, 0x1aa3), cost(0xee21, 0x2a80));
        assert_eq!((sum.writes, sum.reads), (Some(3), [Some(5), Some(7), None]));
        assert_eq!((product.writes, product.reads), (Some(4), [Some(3), Some(0), None]));
        // vcmp.f32 s0, s1 reads both and writes none.
        let compare = cost(0xeeb4, 0x0a60);
        assert_eq!((compare.writes, compare.reads), (None, [Some(0), Some(1), None]));
    }
}
