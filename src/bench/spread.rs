//! Statistics of repeated measurements.

use serde::Serialize;

/// Median and extremes of repeated measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Median; for an even number, the mean of the two middle values.
    pub median: f64,
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub most: f64,
    /// Number of measurements.
    pub count: usize,
}

impl Spread {
    /// Statistics of `measured`; all zero if it is empty.
    pub fn of(measured: &[f64]) -> Self {
        let mut sorted = measured.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(least), Some(most)) = (sorted.first(), sorted.last()) else {
            return Self::default();
        };
        let count = sorted.len();
        let median = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
        Self { median, least: *least, most: *most, count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_extremes() {
        assert_eq!(Spread::of(&[]), Spread::default());
        assert_eq!(
            Spread::of(&[3.0, 1.0, 2.0]),
            Spread { median: 2.0, least: 1.0, most: 3.0, count: 3 }
        );
        assert_eq!(Spread::of(&[4.0, 1.0, 2.0, 9.0]).median, 3.0);
    }
}
