//! Optional timing of the kernels of a pass.

use std::collections::BTreeMap;
use std::time::Instant;

/// Seconds by kernel name.
pub type KernelSeconds = BTreeMap<&'static str, f64>;

/// Accumulates the seconds of kernels that run one after another. Has no cost unless enabled.
#[derive(Debug, Default)]
pub struct Clock {
    seconds: Option<KernelSeconds>,
    running: Option<(&'static str, Instant)>,
}

impl Clock {
    /// Enables the clock and resets all sums.
    pub fn enable(&mut self) {
        *self = Self { seconds: Some(KernelSeconds::new()), running: None };
    }

    /// Returns true if the clock is enabled.
    pub fn is_enabled(&self) -> bool {
        self.seconds.is_some()
    }

    /// Starts the time of a kernel, and ends that of the previous one.
    pub fn begin(&mut self, kernel: &'static str) {
        if self.is_enabled() {
            let now = Instant::now();
            self.end_at(now);
            self.running = Some((kernel, now));
        }
    }

    /// Ends the time of the current kernel.
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

    /// Adds seconds that were measured in another way.
    pub fn add(&mut self, kernel: &'static str, seconds: f64) {
        if let Some(sums) = &mut self.seconds {
            *sums.entry(kernel).or_default() += seconds;
        }
    }

    /// Disables the clock and returns the sums.
    pub fn take(&mut self) -> KernelSeconds {
        self.running = None;
        self.seconds.take().unwrap_or_default()
    }
}

/// Theory: the seconds of the kernels add up to at most the total time, and a disabled clock
/// reports none.
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
