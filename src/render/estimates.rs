//! After which passes the error is estimated.

use std::time::Duration;

use super::progress::Progress;
use crate::film::estimate::LEAST_PASSES;

/// Which passes are followed by an estimate of the error. Each reads the film and takes about as
/// long as a picture.
pub struct Estimates {
    next: u32,
    spent: Duration,
}

/// Estimates take at most this share of the time.
const ESTIMATES_SHARE: u32 = 50;

impl Estimates {
    /// Those still to come after so many passes; also the one after the last of them, which may not
    /// have been made.
    pub fn after(passes: u32) -> Self {
        let places = std::iter::successors(Some(LEAST_PASSES), |place| Some(following(*place)));
        let next = places.into_iter().find(|place| *place >= passes || *place == u32::MAX);
        Self { next: next.unwrap_or(u32::MAX), spent: Duration::ZERO }
    }

    /// With a target the passes depend on their number alone, since the picture's bits may not
    /// depend on a clock.
    pub fn due(&self, progress: &Progress) -> bool {
        let cheap = || self.spent * ESTIMATES_SHARE <= progress.elapsed;
        progress.passes >= self.next && (progress.stop.target_error.is_some() || cheap())
    }

    pub fn made(&mut self, progress: &Progress, cost: Duration) {
        self.next = following(progress.passes);
        self.spent += cost;
    }
}

/// Passes at the estimate after the one at `passes`.
fn following(passes: u32) -> u32 {
    passes.saturating_add((passes / 8).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Estimates come after the passes after which they would have come without a stop.
    #[test]
    fn estimates_keep_their_places() {
        let places: Vec<u32> =
            std::iter::successors(Some(LEAST_PASSES), |p| Some(following(*p))).take(60).collect();
        for passes in 0..places[50] {
            let next = places.iter().find(|place| **place >= passes);
            assert_eq!(Some(&Estimates::after(passes).next), next, "{passes}");
        }
        assert_eq!(Estimates::after(u32::MAX).next, u32::MAX);
    }
}
