//! How much work goes into one submission: desktop drivers kill what runs for about two seconds, so each submission
//! is to take about 50 ms, by the time that earlier ones took.

use crate::plan::Kernel;
use std::collections::BTreeMap;

/// Seconds that a submission is to take.
const SLICE: f64 = 0.05;
/// Items of a kernel's first submission, when nothing is known of it.
const FIRST_ITEMS: u32 = 1 << 14;
/// Factor by which one measurement can change an estimate.
const STEP: f64 = 8.0;

/// Estimated seconds per item of each kernel, and what the submission under way holds.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    seconds_per_item: BTreeMap<Kernel, f64>,
    recorded: Vec<(Kernel, u32)>,
}

impl Pace {
    /// How many of `items` items of `kernel` still fit; 0 when the submission is full. A kernel of which nothing is
    /// known gets a submission of its own.
    pub fn fit(&self, kernel: Kernel, items: u32) -> u32 {
        let Some(seconds) = self.seconds_per_item.get(&kernel) else {
            return if self.recorded.is_empty() { items.min(FIRST_ITEMS) } else { 0 };
        };
        let spent = self.estimate();
        let unknown = self.recorded.iter().any(|(k, _)| !self.seconds_per_item.contains_key(k));
        if unknown || !self.recorded.is_empty() && spent + 0.1 * SLICE > SLICE {
            return 0;
        }
        ((SLICE - spent) / seconds).clamp(1.0, items as f64) as u32
    }

    /// Notes that `items` items of `kernel` were put into the submission.
    pub fn record(&mut self, kernel: Kernel, items: u32) {
        self.recorded.push((kernel, items));
    }

    /// Learns from the time that the submission took, and begins a new one.
    pub fn learn(&mut self, seconds: f64) {
        let estimate = self.estimate();
        for (kernel, items) in std::mem::take(&mut self.recorded) {
            let measured = seconds.max(1e-7) / items.max(1) as f64;
            self.seconds_per_item
                .entry(kernel)
                .and_modify(|old| *old *= (seconds / estimate).clamp(1.0 / STEP, STEP))
                .or_insert(measured);
        }
    }

    fn estimate(&self) -> f64 {
        let cost = |(kernel, items): &(Kernel, u32)| {
            self.seconds_per_item.get(kernel).map_or(0.0, |seconds| seconds * *items as f64)
        };
        self.recorded.iter().map(cost).sum::<f64>().max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device with fixed costs: after a few submissions each takes about a slice, none ten times as long, and no
    /// item is lost.
    #[test]
    fn slices_settle() {
        let cost = |kernel| if kernel == Kernel::Gather { 3e-6 } else { 2e-8 };
        let mut pace = Pace::default();
        let mut times = Vec::new();
        let mut time = 0.0;
        for kernel in [Kernel::EyeTrace, Kernel::Gather].repeat(4) {
            let mut left = 1_000_000;
            while left > 0 {
                let items = pace.fit(kernel, left);
                if items == 0 {
                    times.push(time);
                    pace.learn(time);
                    time = 0.0;
                    continue;
                }
                assert!(items <= left);
                pace.record(kernel, items);
                time += cost(kernel) * items as f64 + 1e-4;
                left -= items;
            }
        }
        assert!(times.iter().all(|t| *t < 10.0 * SLICE), "{times:?}");
        let late = &times[times.len() / 2..];
        assert!(late.iter().all(|t| *t < 2.0 * SLICE), "{late:?}");
        assert!(late.len() as f64 * SLICE < 2.0 * late.iter().sum::<f64>() + SLICE, "{late:?}");
    }
}
