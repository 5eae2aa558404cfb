//! Host-memory copies of the engine state, since the buffers of a lost device are lost with it.

use std::borrow::Cow;
use std::time::Duration;

use super::Kept;
use super::progress::Progress;
use crate::engine::State;

/// Interval between copies of the engine state.
#[derive(Clone, Copy)]
pub struct Keep {
    /// Minimum time between copies.
    pub every: Duration,
    /// Minimum time between copies as a multiple of the time that a copy takes.
    pub times_cost: u32,
}

/// Default: at most ten seconds of work are lost, or one pass if it takes longer, and copies take
/// at most 5 % of the time.
pub const KEEP: Keep = Keep { every: Duration::from_secs(10), times_cost: 20 };

/// The most recent copy.
pub struct Keeping<'a> {
    /// Engine state.
    pub state: Cow<'a, State>,
    /// Progress at the time of the copy.
    pub progress: Progress,
    keep: Keep,
    next: Duration,
}

impl<'a> Keeping<'a> {
    /// Starts with the initial state of a render.
    pub fn new(state: &'a State, progress: Progress, keep: Keep) -> Self {
        Self { state: Cow::Borrowed(state), progress, keep, next: progress.elapsed + keep.every }
    }

    /// Returns true if another copy is due.
    pub fn due(&self, progress: &Progress) -> bool {
        progress.elapsed >= self.next
    }

    /// Stores a copy that took `cost` and was complete at `now`.
    pub fn take(&mut self, state: State, progress: Progress, cost: Duration, now: Duration) {
        (self.state, self.progress) = (Cow::Owned(state), progress);
        self.next = now + self.keep.every.max(self.keep.times_cost * cost);
    }

    /// Returns the copy, from which the render can be resumed, if it contains at least one pass.
    pub fn end(self) -> Option<Box<Kept>> {
        let Self { state, progress, .. } = self;
        (progress.passes > 0).then(|| Box::new(Kept { state: state.into_owned(), progress }))
    }
}
