//! The few functions that a step needs, each a fixed sequence of `f32` operations.
//!
//! No fused multiply-add, no reassociation, no library whose path depends on the value: the same bits come
//! out on a microcontroller and on a host, at a cost that does not depend on the argument.

pub use eclss_sqrt::sqrt;

/// Adds `increment` to `sum` with a compensated (Kahan) sum whose running error stands in `carry`.
///
/// An increment far below one unit in the last place of `sum` is kept instead of being lost, which is what
/// makes a smaller step no less accurate than a larger one.
#[inline(always)]
#[allow(clippy::inline_always, reason = "four additions inside every row of every method")]
pub fn compensated_add(sum: &mut f32, carry: &mut f32, increment: f32) {
    let y = increment - *carry;
    let t = *sum + y;
    *carry = (t - *sum) - y;
    *sum = t;
}

/// Adds `increment` to `sum` and what that rounds off to `lost`, exactly whichever of the two is larger (Knuth's
/// two-sum): `sum − lost` is the true sum.
#[inline(always)]
#[allow(clippy::inline_always, reason = "seven additions inside every line and volume")]
pub fn exact_add(sum: &mut f32, lost: &mut f32, increment: f32) {
    let t = *sum + increment;
    let b = t - *sum;
    *lost -= (*sum - (t - b)) + (increment - b);
    *sum = t;
}

/// Whether the processor works on several numbers at once: a whole row then costs no more than a part of it, and is
/// written by operation instead of by number. The operations are the same either way.
pub const VECTORS: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

/// [`exact_add`] for a whole row.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
pub fn exact_add_row<const N: usize>(sum: &mut [f32; N], lost: &mut [f32; N], increment: &[f32; N]) {
    if !VECTORS {
        for place in 0..N {
            exact_add(&mut sum[place], &mut lost[place], increment[place]);
        }
        return;
    }
    let (s, l, y) = (*sum, *lost, *increment);
    let t = each(&s, &y, |s, y| s + y);
    let b = each(&t, &s, |t, s| t - s);
    let of_sum = each(&s, &each(&t, &b, |t, b| t - b), |s, a| s - a);
    let of_increment = each(&y, &b, |y, b| y - b);
    let error = each(&of_sum, &of_increment, |a, b| a + b);
    *lost = each(&l, &error, |l, error| l - error);
    *sum = t;
}

/// [`compensated_add`] for a whole row.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over volumes")]
pub fn compensated_add_row<const N: usize>(sum: &mut [f32; N], carry: &mut [f32; N], increment: &[f32; N]) {
    if !VECTORS {
        for place in 0..N {
            compensated_add(&mut sum[place], &mut carry[place], increment[place]);
        }
        return;
    }
    let (s, c, x) = (*sum, *carry, *increment);
    let y = each(&x, &c, |x, c| x - c);
    let t = each(&s, &y, |s, y| s + y);
    *carry = each(&each(&t, &s, |t, s| t - s), &y, |a, y| a - y);
    *sum = t;
}

/// One operation on every pair of two rows.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one operation")]
pub fn each<const N: usize>(a: &[f32; N], b: &[f32; N], operation: impl Fn(f32, f32) -> f32) -> [f32; N] {
    let mut result = [0.0; N];
    let mut place = 0;
    while place < N {
        result[place] = operation(a[place], b[place]);
        place += 1;
    }
    result
}

/// Returns the larger of two numbers, `b` where `a` is NaN; one compare and one select.
///
/// `f32::max` would do the same but leaves the sign of a zero to the platform.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one compare and one select")]
pub fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Returns the smaller of two numbers, `b` where `a` is NaN; one compare and one select.
#[inline(always)]
#[allow(clippy::inline_always, reason = "one compare and one select")]
pub fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns whether `value` is outside ±`limit` or is NaN.
#[inline]
#[allow(clippy::neg_cmp_op_on_partial_ord, reason = "one comparison that is also true for NaN")]
pub fn beyond(value: f32, limit: f32) -> bool {
    !(value.abs() <= limit)
}

/// 1.5·2²³: adding and subtracting it rounds an `f32` of magnitude below 2²² to the nearest integer.
const ROUND: f32 = 12_582_912.0;
/// Coefficients of `log2(m)/s` in z = s², s = (m−1)/(m+1): 2/(ln 2·(2k+1)) (artanh series).
const LOG2: [f32; 5] = [2.885_39, 0.961_796_7, 0.577_078_04, 0.412_198_58, 0.320_598_9];
/// Coefficients of 2^x: (ln 2)^k/k! (exponential series).
const EXP2: [f32; 8] = [
    1.0,
    core::f32::consts::LN_2,
    0.240_226_5,
    0.055_504_11,
    0.009_618_129,
    0.001_333_355_8,
    0.000_154_035_3,
    0.000_015_252_734,
];

/// Returns `x^exponent` for `x` normal and > 0, |exponent·log2 x| < 126, within 4e-7 relative.
///
/// Always the same operations. The exponent of two of `x` and the logarithm of its mantissa are kept apart
/// and the product with `exponent` is split, so that a large power does not cost digits.
#[inline(always)]
#[allow(clippy::inline_always, reason = "half as dear where the exponent is known to the compiler")]
pub fn pow(x: f32, exponent: f32) -> f32 {
    // x = 2^e·m with m in [√½, √2)
    let bits = x.to_bits();
    let above_sqrt2 = (bits & 0x007f_ffff) > 0x0035_04f3;
    let e = (bits >> 23).cast_signed() - 127 + i32::from(above_sqrt2);
    let m = f32::from_bits((bits & 0x007f_ffff) | if above_sqrt2 { 0x3f00_0000 } else { 0x3f80_0000 });
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let log2_m = s * (LOG2[0] + z * (LOG2[1] + z * (LOG2[2] + z * (LOG2[3] + z * LOG2[4]))));

    // exponent·(e + log2 m) = k + fraction; the leading half of `exponent` times the small integer e is exact
    let whole = e as f32;
    let high = f32::from_bits(exponent.to_bits() & 0xffff_f000);
    let k = (exponent * (whole + log2_m) + ROUND) - ROUND;
    let fraction = (high * whole - k) + ((exponent - high) * whole + exponent * log2_m);
    let mut power = EXP2[7];
    for coefficient in [EXP2[6], EXP2[5], EXP2[4], EXP2[3], EXP2[2], EXP2[1], EXP2[0]] {
        power = power * fraction + coefficient;
    }
    // k within −126…127 by the range above; outside it the power saturates instead of wrapping.
    let scale = if k < -126.0 { -126.0 } else { k };
    let scale = if scale > 127.0 { 127.0 } else { scale };
    power * f32::from_bits(((scale as i32 + 127) as u32) << 23)
}

/// ln 2 in two parts, the first with few enough bits that its product with a small integer is exact.
const LN2_HIGH: f32 = 0.693_359_4;
const LN2_LOW: f32 = -2.121_944_4e-4;

/// Returns e^`x` for |x| < 87, within 3e-7 relative; beyond that it saturates instead of overflowing.
///
/// Always the same operations: x = k·ln 2 + r with |r| ≤ ½·ln 2, and the exponential series in r.
#[inline]
pub fn exp(x: f32) -> f32 {
    let k = (x * core::f32::consts::LOG2_E + ROUND) - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    let mut power = 1.0 / 5_040.0;
    for coefficient in [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        power = power * r + coefficient;
    }
    let scale = if k < -126.0 { -126.0 } else { k };
    let scale = if scale > 127.0 { 127.0 } else { scale };
    power * f32::from_bits(((scale as i32 + 127) as u32) << 23)
}

/// Returns ln `x` for `x` normal and > 0, within 2e-7 of the larger of 1 and |ln x|.
///
/// Always the same operations: the exponent of two and the logarithm of the mantissa, kept apart until the end.
#[inline]
pub fn ln(x: f32) -> f32 {
    let bits = x.to_bits();
    let above_sqrt2 = (bits & 0x007f_ffff) > 0x0035_04f3;
    let e = ((bits >> 23).cast_signed() - 127 + i32::from(above_sqrt2)) as f32;
    let m = f32::from_bits((bits & 0x007f_ffff) | if above_sqrt2 { 0x3f00_0000 } else { 0x3f80_0000 });
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let log2_m = s * (LOG2[0] + z * (LOG2[1] + z * (LOG2[2] + z * (LOG2[3] + z * LOG2[4]))));
    e * LN2_HIGH + (e * LN2_LOW + log2_m * core::f32::consts::LN_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_and_ln_are_within_their_documented_errors() {
        let (mut of_exp, mut of_ln) = (0.0f64, 0.0f64);
        for step in 0..=200_000 {
            let x = -86.0 + 172.0 * step as f32 / 200_000.0;
            of_exp = of_exp.max((f64::from(exp(x)) / f64::from(x).exp() - 1.0).abs());
            let y = f64::from(x * 0.4).exp() as f32;
            let exact = f64::from(y).ln();
            of_ln = of_ln.max((f64::from(ln(y)) - exact).abs() / exact.abs().max(1.0));
        }
        std::println!("exp: largest relative error {of_exp:.2e}; ln: {of_ln:.2e}");
        assert!(of_exp < 3e-7 && of_ln < 2e-7, "{of_exp:e} {of_ln:e}");
        assert!(exp(-1e3) < 1e-37 && exp(1e3) > 1e37);
    }

    #[test]
    fn pow_is_within_its_documented_error() {
        // Openings from the leakage limit to fully open and the exponents of valves and reference data.
        let mut worst = 0.0f64;
        for step in 0..20_000 {
            let x = 1e-3 * 1000f32.powf(step as f32 / 19_999.0);
            for exponent in [-5.0f32, -3.134_165, -2.0, -1.0, -0.25, 0.0, 0.5, 1.75, 2.0, 3.0] {
                let exact = f64::from(x).powf(f64::from(exponent));
                worst = worst.max((f64::from(pow(x, exponent)) / exact - 1.0).abs());
            }
        }
        std::println!("pow: largest relative error {worst:.2e}");
        assert!(worst < 4e-7, "{worst:e}");
    }

    #[test]
    fn pow_saturates_instead_of_wrapping() {
        assert!(pow(1e-30, 10.0) < 1e-37);
        assert!(pow(1e-30, -10.0) > 1e37);
    }

    #[test]
    fn compensated_sum_keeps_what_a_plain_sum_loses() {
        let (mut sum, mut carry, mut plain) = (101_325.0f32, 0.0, 101_325.0f32);
        for _ in 0..1_000_000 {
            compensated_add(&mut sum, &mut carry, 1e-4);
            plain += 1e-4;
        }
        assert_eq!(plain.to_bits(), 101_325.0f32.to_bits());
        assert!((sum - 101_425.0).abs() < 0.01, "{sum}");
    }
}
