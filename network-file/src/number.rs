//! Numbers of a file: finite, in range, and within what single precision holds.

use toml::Spanned;
use toml::de::DeValue;

use crate::limits::Range;
use crate::notes::Notes;

/// A number in range that `f32` can hold.
pub(crate) fn number(
    notes: &mut Notes,
    key: &str,
    value: &Spanned<DeValue<'_>>,
    range: &Range,
) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
        }
        other => {
            notes.refuse(value.span(), format!("`{key}` must be a number, not {}", kind_of(other)));
            return None;
        }
    };
    let reason = match parsed {
        None => format!("`{key}` is a number too large to read"),
        Some(number) if !number.is_finite() => format!("`{key}` must be finite, not {number}"),
        Some(number) if !range.values.contains(&number) => {
            format!("`{key}` must lie in {range}, not at {number:?}")
        }
        Some(number) if single(number).is_none() => {
            format!("`{key}` = {number:e} does not fit single precision")
        }
        Some(number) => return Some(number),
    };
    notes.refuse(value.span(), reason);
    None
}

/// Rounds to `f32`; `None` where that overflows, or turns what is not zero into zero or a subnormal.
pub(crate) fn single(number: f64) -> Option<f32> {
    let rounded = number as f32;
    (rounded.is_normal() || (rounded == 0.0 && number == 0.0)).then_some(rounded)
}

/// What a value is, for a message.
pub(crate) fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_keeps_what_it_can_hold() {
        for number in [0.0, -0.0, 1.0, 101_325.0, 1.2e-38, 3.4e38, -1e-3] {
            let rounded = single(number).map(f64::from).expect("in range");
            assert!((rounded - number).abs() <= number.abs() * 6e-8, "{number}");
        }
        for number in [1e-38, 1e-60, 3.5e38, 1e308, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(single(number), None, "{number}");
        }
    }
}
