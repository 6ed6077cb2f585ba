//! Square root of an `f32` by the processor's own instruction.
//!
//! IEEE 754 square root is correctly rounded, so every route below gives the same bits. On Cortex-M with an
//! FPU `libm::sqrtf` is 57 instructions of software because stable Rust's `core` does not offer the
//! instruction; one line of assembly does. On x86-64 the intrinsic keeps loops vectorisable. Everywhere else
//! `libm` is used. This is a crate of its own because `eclss-core` forbids unsafe code.
#![no_std]

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod arm {
    // Hard-float ABI: argument and result both travel in s0.
    core::arch::global_asm!(
        // The assembler does not take the FPU from the target: name the smallest one that all our cores have.
        ".fpu fpv4-sp-d16",
        ".section .text.eclss_vsqrt_f32,\"ax\",%progbits",
        ".global eclss_vsqrt_f32",
        ".type eclss_vsqrt_f32,%function",
        ".thumb_func",
        "eclss_vsqrt_f32:",
        "vsqrt.f32 s0, s0",
        "bx lr",
    );
    unsafe extern "C" {
        pub(crate) safe fn eclss_vsqrt_f32(x: f32) -> f32;
    }
}

/// Returns √x, correctly rounded; NaN for negative `x`, −0 for −0.
#[must_use]
#[inline(always)]
#[allow(clippy::inline_always, reason = "one instruction; a call would cost more than the work")]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return arm::eclss_vsqrt_f32(x);
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_mm_cvtss_f32, _mm_set_ss, _mm_sqrt_ss};
        // SAFETY: SSE is part of x86-64's baseline, every such processor has the instruction.
        unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))) }
    }
    #[cfg(not(any(all(target_arch = "arm", target_abi = "eabihf"), target_arch = "x86_64")))]
    return libm::sqrtf(x);
}

#[cfg(test)]
mod tests {
    /// Every 997th bit pattern, all exponents and signs: the instruction agrees with `libm` to the bit.
    #[test]
    fn same_bits_as_libm() {
        for bits in (0..=u32::MAX).step_by(997) {
            let x = f32::from_bits(bits);
            let (ours, theirs) = (super::sqrt(x), libm::sqrtf(x));
            assert!(ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()), "{x:e}");
        }
    }
}
