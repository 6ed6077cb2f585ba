//! Durations as people write them: `1ms`, `26s`, `1.5h`.

/// Units and their length [µs].
const UNITS: [(&str, u64); 6] = [
    ("us", 1),
    ("ms", 1_000),
    ("s", 1_000_000),
    ("min", 60_000_000),
    ("h", 3_600_000_000),
    ("d", 86_400_000_000),
];

/// Longest duration [µs]: 1e9 s, more than 31 years.
const LONGEST_US: u64 = 1_000_000_000_000_000;

/// Why a text is not a duration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DurationError {
    /// Not a decimal number followed by a unit.
    Form,
    /// The unit is none of us, ms, s, min, h and d.
    Unit,
    /// More digits than whole microseconds.
    Fraction,
    /// Longer than 1e9 s.
    TooLong,
}

impl std::fmt::Display for DurationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Form => "a duration is a number and a unit, as in 1ms or 26s",
            Self::Unit => "the unit of a duration is us, ms, s, min, h or d",
            Self::Fraction => "a duration must be a whole number of microseconds",
            Self::TooLong => "a duration is at most 1e9 s",
        })
    }
}

impl std::error::Error for DurationError {}

/// Returns the duration in microseconds, exactly.
///
/// ```
/// use eclss_network_file::duration_us;
/// assert_eq!(duration_us("0.5ms"), Ok(500));
/// assert_eq!(duration_us("26s"), Ok(26_000_000));
/// assert!(duration_us("26").is_err());
/// ```
pub fn duration_us(text: &str) -> Result<u64, DurationError> {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or(DurationError::Form)?;
    let (number, unit) = text.split_at(end);
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if whole.is_empty() || (number.contains('.') && fraction.is_empty()) || fraction.contains('.') {
        return Err(DurationError::Form);
    }
    let unit_us = UNITS.iter().find(|(name, _)| *name == unit.trim_start()).ok_or(DurationError::Unit)?.1;
    let fraction = fraction.trim_end_matches('0');
    if fraction.len() > 12 {
        return Err(DurationError::Fraction);
    }
    let whole: u64 = whole.parse().map_err(|_| DurationError::TooLong)?;
    let scale = 10u128.pow(fraction.len() as u32);
    let part: u128 =
        if fraction.is_empty() { 0 } else { fraction.parse().map_err(|_| DurationError::Form)? };
    let scaled = (u128::from(whole) * scale + part) * u128::from(unit_us);
    if !scaled.is_multiple_of(scale) {
        return Err(DurationError::Fraction);
    }
    let us = u64::try_from(scaled / scale).map_err(|_| DurationError::TooLong)?;
    if us > LONGEST_US { Err(DurationError::TooLong) } else { Ok(us) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_is_exact() {
        for (text, us) in [
            ("1us", 1),
            ("0.1ms", 100),
            ("1.000001s", 1_000_001),
            ("1.5min", 90_000_000),
            ("24h", 86_400_000_000),
            ("1d", 86_400_000_000),
            ("26 s", 26_000_000),
            ("0s", 0),
        ] {
            assert_eq!(duration_us(text), Ok(us), "{text}");
        }
    }

    #[test]
    fn what_is_not_a_duration_is_named() {
        for (text, error) in [
            ("", DurationError::Form),
            ("26", DurationError::Form),
            ("s", DurationError::Form),
            (".5s", DurationError::Form),
            ("5.s", DurationError::Form),
            ("1.2.3s", DurationError::Form),
            ("-1s", DurationError::Form),
            ("1 fortnight", DurationError::Unit),
            ("1e3s", DurationError::Unit),
            ("0.1us", DurationError::Fraction),
            ("1.0000001s", DurationError::Fraction),
            ("20000000000s", DurationError::TooLong),
            ("99999999999999999999999s", DurationError::TooLong),
        ] {
            assert_eq!(duration_us(text), Err(error), "{text}");
        }
    }
}
