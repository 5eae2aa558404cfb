//! Schedule of error estimates.

use std::time::Duration;

use super::progress::Progress;
use crate::film::estimate::LEAST_PASSES;

/// Decides after which passes the error is estimated. An estimate reads the film and takes about as
/// long as reading back the image.
pub struct Estimates {
    next: u32,
    spent: Duration,
}

/// Reciprocal of the maximum fraction of render time spent on estimates.
const ESTIMATES_SHARE: u32 = 50;

impl Estimates {
    /// Remaining estimates after `passes` passes. Includes one that is due after exactly that many
    /// passes, since it may not have been made.
    pub fn after(passes: u32) -> Self {
        let places = std::iter::successors(Some(LEAST_PASSES), |place| Some(following(*place)));
        let next = places.into_iter().find(|place| *place >= passes || *place == u32::MAX);
        Self { next: next.unwrap_or(u32::MAX), spent: Duration::ZERO }
    }

    /// Returns true if an estimate is due. With a target error, this depends on the pass count
    /// only, because the image must not depend on timing.
    pub fn due(&self, progress: &Progress) -> bool {
        let cheap = || self.spent * ESTIMATES_SHARE <= progress.elapsed;
        progress.passes >= self.next && (progress.stop.target_error.is_some() || cheap())
    }

    pub fn made(&mut self, progress: &Progress, cost: Duration) {
        self.next = following(progress.passes);
        self.spent += cost;
    }
}

/// Pass count of the next estimate after the one at `passes`.
fn following(passes: u32) -> u32 {
    passes.saturating_add((passes / 8).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A resumed render estimates after the same passes as an uninterrupted one.
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
