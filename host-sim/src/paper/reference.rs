//! The stored reference: the valve's closing, solved tightly.

/// Valve flow of the relaxation equations over 10…12 s by an implicit solver at tight tolerance, in `f64`.
/// A test of the `eclss-tests` package makes it anew and compares.
const STORED: &str = include_str!("../../data/paper_reference.csv");

/// Flow over time.
#[derive(Debug, Clone)]
pub struct Reference {
    points: Vec<(u64, f64)>,
}

impl Reference {
    /// Reads the reference that is stored in this program.
    pub fn stored() -> Self {
        Self { points: STORED.lines().filter_map(row).collect() }
    }

    /// Times [s] and flows [g/s].
    pub fn curve_g_s(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|(time_us, flow)| (*time_us as f64 * 1e-6, flow * 1e3)).collect()
    }

    /// Times [s] and `flow − reference` [g/s] at the times that both have; `flow` in [s] and [g/s].
    pub fn errors_g_s(&self, flow: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let error = |(time, value): &(f64, f64)| {
            let time_us = (time * 1e6).round() as u64;
            let place = self.points.binary_search_by_key(&time_us, |point| point.0).ok()?;
            Some((*time, value - self.points[place].1 * 1e3))
        };
        flow.iter().filter_map(error).collect()
    }
}

fn row(line: &str) -> Option<(u64, f64)> {
    let (time, flow) = line.split_once(',')?;
    let time: f64 = time.trim().parse().ok()?;
    Some(((time * 1e6).round() as u64, flow.trim().parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_covers_the_closing_in_order() {
        let reference = Reference::stored();
        let times: Vec<_> = reference.points.iter().map(|point| point.0).collect();
        assert_eq!((times.first(), times.last()), (Some(&10_000_000), Some(&12_000_000)));
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && times.len() > 1_000);
        assert!(reference.points.iter().all(|point| point.1.is_finite()));
    }
}
