//! Logarithmic axes: ranges, ticks and tick labels.

/// Range of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    /// Range of positive values, extended to 1, 2 or 5 times a power of ten and to at least a
    /// factor of four.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) =
            values.fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        if high <= 0.0 {
            return Self { low: 0.1, high: 1.0 };
        }
        let middle = (low * high).sqrt();
        let (low, high) = (low.min(middle / 2.0), high.max(middle * 2.0));
        let step = |value: f64, up: bool| {
            let decade = 10f64.powf(value.log10().floor());
            let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
            match up {
                true => {
                    steps.into_iter().find(|step| *step >= value * 0.999).unwrap_or(10.0 * decade)
                }
                false => {
                    steps.into_iter().rev().find(|step| *step <= value * 1.001).unwrap_or(decade)
                }
            }
        };
        Self { low: step(low, false), high: step(high, true) }
    }

    /// Length in decades.
    pub fn decades(self) -> f64 {
        (self.high / self.low).log10()
    }

    /// Ticks with labels, at most about `room`: 1, 2, 5 times each power of ten, or every n-th
    /// power of ten.
    pub fn ticks(self, room: f64) -> Vec<(f64, String)> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let inside = |value: &f64| (self.low * 0.999..=self.high * 1.001).contains(value);
        let fine: Vec<f64> = (first..=last)
            .flat_map(|decade| [1.0, 2.0, 5.0].map(|step| step * 10f64.powi(decade)))
            .filter(inside)
            .collect();
        let every =
            (1..).find(|every| (last - first) as f64 / f64::from(*every) <= room).unwrap_or(1);
        let coarse = (first..=last)
            .filter(|decade| decade.rem_euclid(every) == 0)
            .map(|decade| 10f64.powi(decade));
        let values = if fine.len() as f64 <= room { fine } else { coarse.filter(inside).collect() };
        values.into_iter().map(|value| (value, number(value))).collect()
    }
}

/// Formats a tick label: a plain number from 0.001 to 20000, otherwise a power of ten.
pub fn number(value: f64) -> String {
    if (0.000_999..=20_000.0).contains(&value) {
        return format!("{:.4}", value).trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    let decade = (value.log10() + 1e-9).floor();
    let digits = format!("{decade:.0}");
    let superscript: String = digits
        .chars()
        .map(|c| match c.to_digit(10) {
            Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
            None => '⁻',
        })
        .collect();
    match (value / 10f64.powf(decade)).round() {
        1.0 => format!("10{superscript}"),
        step => format!("{step:.0}·10{superscript}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_and_ticks_their_room() {
        for values in [vec![0.0123, 0.5], vec![1.0], vec![3e-7, 2e4], vec![0.9, 1.1]] {
            let range = Range::of(values.iter().copied());
            assert!(values.iter().all(|v| (range.low..=range.high).contains(v)), "{range:?}");
            let ticks = range.ticks(6.0);
            assert!((2..=8).contains(&ticks.len()), "{range:?} {ticks:?}");
        }
        assert_eq!(Range::of([0.0123, 0.45].into_iter()), Range { low: 0.01, high: 0.5 });
        let texts = [0.001, 0.02, 5.0, 1e4, 1e-5, 2e-7, 1e6].map(number);
        assert_eq!(texts, ["0.001", "0.02", "5", "10000", "10⁻⁵", "2·10⁻⁷", "10⁶"]);
    }
}
