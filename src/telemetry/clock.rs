//! Where a pass's time goes: seconds by kernel, for those who ask.

use std::collections::BTreeMap;
use std::time::Instant;

/// Seconds by the kernels' stems.
pub type KernelSeconds = BTreeMap<&'static str, f64>;

/// Adds up the seconds of kernels that run one after another. Costs nothing until it is wound.
#[derive(Debug, Default)]
pub struct Clock {
    seconds: Option<KernelSeconds>,
    running: Option<(&'static str, Instant)>,
}

impl Clock {
    /// Begins to count, from zero.
    pub fn enable(&mut self) {
        *self = Self { seconds: Some(KernelSeconds::new()), running: None };
    }

    /// Whether it counts.
    pub fn is_enabled(&self) -> bool {
        self.seconds.is_some()
    }

    /// A kernel begins, and the one before ends.
    pub fn begin(&mut self, kernel: &'static str) {
        if self.is_enabled() {
            let now = Instant::now();
            self.end_at(now);
            self.running = Some((kernel, now));
        }
    }

    /// The last kernel ends.
    pub fn end(&mut self) {
        if self.is_enabled() {
            self.end_at(Instant::now());
        }
    }

    fn end_at(&mut self, now: Instant) {
        if let Some((kernel, begun)) = self.running.take() {
            self.add(kernel, (now - begun).as_secs_f64());
        }
    }

    /// Adds seconds that were measured otherwise.
    pub fn add(&mut self, kernel: &'static str, seconds: f64) {
        if let Some(sums) = &mut self.seconds {
            *sums.entry(kernel).or_default() += seconds;
        }
    }

    /// Stops counting; what was counted.
    pub fn take(&mut self) -> KernelSeconds {
        self.running = None;
        self.seconds.take().unwrap_or_default()
    }
}

/// Theory: the kernels' seconds are the parts of one stretch of time, and a clock that is not wound
/// tells none.
#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::sleep;
    use std::time::Duration;

    #[test]
    fn laps_add_up_to_the_whole() {
        let mut clock = Clock::default();
        clock.begin("gather");
        clock.end();
        assert!(clock.take().is_empty());
        let begun = Instant::now();
        clock.enable();
        for kernel in ["eye_trace", "gather", "eye_trace"] {
            clock.begin(kernel);
            sleep(Duration::from_millis(2));
        }
        clock.end();
        let whole = begun.elapsed().as_secs_f64();
        clock.add("gather", 1.0);
        let seconds = clock.take();
        assert_eq!(seconds.keys().copied().collect::<Vec<_>>(), ["eye_trace", "gather"]);
        assert!(seconds["eye_trace"] >= 0.004 && seconds["gather"] >= 1.002, "{seconds:?}");
        assert!(seconds.values().sum::<f64>() - 1.0 <= whole, "{seconds:?} in {whole}");
        assert!(!clock.is_enabled());
    }
}
