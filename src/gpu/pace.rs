//! Amount of work per submission. Desktop drivers reset a device that is busy for about two
//! seconds, so each submission targets about 50 ms, estimated from the durations of earlier ones.

use crate::plan::Kernel;
use std::collections::BTreeMap;

/// Default target duration of a submission, seconds.
pub const SLICE: f64 = 0.05;
/// Number of items in a kernel's first submission, before its cost is known.
const FIRST_ITEMS: u32 = 1 << 14;
/// Greatest factor by which one measurement changes an estimate.
const STEP: f64 = 8.0;
/// Exponent of the ratio by which the submissions of a whole step lower an estimate if all are
/// fast. A single fast submission is weak evidence: the cost of items varies over an image, and the
/// next ones may be expensive again.
const LOWERING: f64 = 0.5;

/// Estimated seconds per item of each kernel, and the contents of the current submission.
#[derive(Clone, Debug)]
pub struct Pace {
    slice: f64,
    seconds_per_item: BTreeMap<Kernel, f64>,
    /// Kernel, number of items, and their fraction of the step.
    recorded: Vec<(Kernel, u32, f64)>,
}

impl Default for Pace {
    fn default() -> Self {
        Self { slice: SLICE, seconds_per_item: BTreeMap::new(), recorded: Vec::new() }
    }
}

impl Pace {
    /// Sets the target duration of a submission in seconds; with infinity, nothing is split for
    /// time.
    pub fn set_slice(&mut self, seconds: f64) {
        self.slice = seconds;
    }

    /// Returns true if submissions are split by time.
    fn splits(&self) -> bool {
        self.slice.is_finite()
    }

    /// Returns how many of `items` items of `kernel` still fit; 0 if the submission is full. A
    /// kernel of unknown cost gets a separate submission.
    pub fn fit(&self, kernel: Kernel, items: u32) -> u32 {
        if !self.splits() {
            return items;
        }
        let Some(seconds) = self.seconds_per_item.get(&kernel) else {
            return if self.recorded.is_empty() { items.min(FIRST_ITEMS) } else { 0 };
        };
        let spent = self.estimate();
        let unknown = self.recorded.iter().any(|(k, ..)| !self.seconds_per_item.contains_key(k));
        if unknown || !self.recorded.is_empty() && spent + 0.1 * self.slice > self.slice {
            return 0;
        }
        ((self.slice - spent) / seconds).clamp(1.0, items as f64) as u32
    }

    /// Records that `items` items of `kernel`, of `whole` in its step, were added to the
    /// submission.
    pub fn record(&mut self, kernel: Kernel, items: u32, whole: u32) {
        self.recorded.push((kernel, items, f64::from(items) / f64::from(whole.max(1))));
    }

    /// Kernels of the submission, in order.
    pub fn kernels(&self) -> impl Iterator<Item = Kernel> + '_ {
        self.recorded.iter().map(|(kernel, ..)| *kernel)
    }

    /// Updates the estimates from the duration of the submission, and starts a new one.
    pub fn learn(&mut self, seconds: f64) {
        let estimate = self.estimate();
        let recorded = std::mem::take(&mut self.recorded);
        if !self.splits() {
            // one submission of everything gives no information about individual kernels
            return;
        }
        for (kernel, items, share) in recorded {
            let measured = seconds.max(1e-7) / items.max(1) as f64;
            self.seconds_per_item
                .entry(kernel)
                .and_modify(|old| *old *= correction(seconds / estimate, share))
                .or_insert(measured);
        }
    }

    fn estimate(&self) -> f64 {
        let cost = |(kernel, items, _): &(Kernel, u32, f64)| {
            self.seconds_per_item.get(kernel).map_or(0.0, |seconds| seconds * *items as f64)
        };
        self.recorded.iter().map(cost).sum::<f64>().max(1e-9)
    }
}

/// Factor on an estimate after `share` of a step took `ratio` times the estimated time: it rises at
/// once but falls slowly, since a submission that is too long costs more than one that is too
/// short.
fn correction(ratio: f64, share: f64) -> f64 {
    if ratio > 1.0 { ratio.min(STEP) } else { ratio.powf(LOWERING * share).max(1.0 / STEP) }
}

/// Theory: a device of known cost per item is filled slice by slice, without losing an item.
#[cfg(test)]
mod tests {
    use super::*;

    /// Durations of the submissions for `rounds` rounds of two kernels with a million items each.
    fn submissions(pace: &mut Pace, rounds: usize) -> Vec<f64> {
        let cost = |kernel| if kernel == Kernel::Gather { 3e-6 } else { 2e-8 };
        let (mut times, mut time) = (Vec::new(), 0.0);
        for kernel in [Kernel::EyeTrace, Kernel::Gather].repeat(rounds) {
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
                pace.record(kernel, items, 1_000_000);
                time += cost(kernel) * items as f64 + 1e-4;
                left -= items;
            }
        }
        times.push(time);
        pace.learn(time);
        times
    }

    /// After a few submissions each takes about one slice, and none takes ten times as long.
    #[test]
    fn slices_settle() {
        for slice in [SLICE, 0.2 * SLICE] {
            let mut pace = Pace::default();
            pace.set_slice(slice);
            let times = submissions(&mut pace, 4);
            assert!(times.iter().all(|t| *t < 10.0 * SLICE), "{times:?}");
            let late = &times[times.len() / 2..];
            assert!(late.iter().all(|t| *t < 2.0 * slice), "{late:?}");
            assert!(late.len() as f64 * slice < 2.0 * late.iter().sum::<f64>() + slice, "{late:?}");
        }
    }

    /// If a third of the items cost three times as much, as on the floor of an image, no submission
    /// takes much longer than a slice, and few are much shorter.
    #[test]
    fn dear_items_are_expected() {
        let (mut pace, mut times) = (Pace::default(), Vec::new());
        for _ in 0..6 {
            let mut first = 0;
            times.clear();
            while first < 1_000_000 {
                let items = pace.fit(Kernel::Gather, 1_000_000 - first);
                pace.record(Kernel::Gather, items, 1_000_000);
                let cost = |item| if item >= 666_666 { 6e-7 } else { 2e-7 };
                let time = (first..first + items).map(cost).sum::<f64>();
                times.push(time);
                pace.learn(time);
                first += items;
            }
        }
        assert!(times.iter().all(|time| *time < 1.7 * SLICE), "{times:?}");
        assert!(times.len() as f64 * SLICE < 2.5 * times.iter().sum::<f64>(), "{times:?}");
    }

    /// Without a limit there is a single submission, and earlier estimates remain valid afterwards.
    #[test]
    fn without_a_slice_nothing_is_split() {
        let mut pace = Pace::default();
        let split = submissions(&mut pace, 4).len();
        pace.set_slice(f64::INFINITY);
        assert_eq!(submissions(&mut pace, 4).len(), 1);
        pace.set_slice(SLICE);
        let again = submissions(&mut pace, 4);
        assert!(again.len() <= split && again.iter().all(|t| *t < 2.0 * SLICE), "{again:?}");
    }
}
