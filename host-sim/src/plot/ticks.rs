//! Where the ticks of an axis stand and how they are written.

/// Ticks at round numbers within `low…high`, about `wanted` of them, with their labels.
pub(super) fn linear(low: f64, high: f64, wanted: usize) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return Vec::new();
    }
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powi(raw.log10().floor() as i32);
    let step = [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= raw * 0.999)
        .unwrap_or(10.0 * power);
    let digits = (0..12).find(|d| is_whole(step * 10f64.powi(*d))).unwrap_or(12) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).map(|value| (value, number(value, digits))).collect()
}

/// Ticks at powers of ten for an axis that shows log10 of its values, thinned to at most `wanted`.
pub(super) fn decades(low: f64, high: f64, wanted: usize) -> Vec<(f64, String)> {
    let (first, last) = ((low - 1e-9).ceil() as i32, (high + 1e-9).floor() as i32);
    let every = (last - first) / i32::try_from(wanted.max(1)).unwrap_or(1) + 1;
    (first..=last)
        .filter(|k| k.rem_euclid(every) == 0)
        .map(|k| {
            let label = match k {
                -3..=-1 => number(10f64.powi(k), -k as usize),
                0..=4 => number(10f64.powi(k), 0),
                _ => format!("1e{}", signed(k)),
            };
            (f64::from(k), label)
        })
        .collect()
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs().max(1.0)
}

fn signed(k: i32) -> String {
    if k < 0 { format!("−{}", -k) } else { k.to_string() }
}

/// `value` with `digits` decimals and a true minus sign; large and small values with an exponent.
fn number(value: f64, digits: usize) -> String {
    let text = if value != 0.0 && (value.abs() >= 1e6 || digits > 6) {
        format!("{value:.1e}")
    } else {
        format!("{value:.digits$}")
    };
    let text = if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        let labels =
            |low, high, wanted| linear(low, high, wanted).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(labels(0.0, 100.0, 5), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(labels(10.0, 12.0, 4), ["10.0", "10.5", "11.0", "11.5", "12.0"]);
        assert_eq!(labels(-1.1, 1.1, 4), ["−1", "0", "1"]);
        assert!(linear(1.0, 1.0, 5).is_empty() && linear(0.0, f64::NAN, 5).is_empty());
    }

    #[test]
    fn decades_are_written_plainly_near_one() {
        let labels: Vec<_> = decades(-2.0, 3.0, 10).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10", "100", "1000"]);
    }
}
