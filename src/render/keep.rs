//! What is kept of a render in the program's memory, since a device that is lost takes its buffers
//! along.

use std::borrow::Cow;
use std::time::Duration;

use super::Kept;
use super::progress::Progress;
use crate::engine::State;

/// How often an engine's state is copied.
#[derive(Clone, Copy)]
pub struct Keep {
    /// Time between copies.
    pub every: Duration,
    /// At least so many times the time that a copy takes.
    pub times_cost: u32,
}

/// At most ten seconds of work are lost, or one pass if it takes longer, and copies take at most a
/// twentieth of the time.
pub const KEEP: Keep = Keep { every: Duration::from_secs(10), times_cost: 20 };

/// The newest copy.
pub struct Keeping<'a> {
    /// What the engine held.
    pub state: Cow<'a, State>,
    /// How far that was.
    pub progress: Progress,
    keep: Keep,
    next: Duration,
}

impl<'a> Keeping<'a> {
    /// Nothing but what a render begins with.
    pub fn new(state: &'a State, progress: Progress, keep: Keep) -> Self {
        Self { state: Cow::Borrowed(state), progress, keep, next: progress.elapsed + keep.every }
    }

    /// Whether it is time for another copy.
    pub fn due(&self, progress: &Progress) -> bool {
        progress.elapsed >= self.next
    }

    /// Keeps a copy that took `cost` and was ready at `now`.
    pub fn take(&mut self, state: State, progress: Progress, cost: Duration, now: Duration) {
        (self.state, self.progress) = (Cow::Owned(state), progress);
        self.next = now + self.keep.every.max(self.keep.times_cost * cost);
    }

    /// What can be gone on from, if there is any pass in it.
    pub fn end(self) -> Option<Box<Kept>> {
        let Self { state, progress, .. } = self;
        (progress.passes > 0).then(|| Box::new(Kept { state: state.into_owned(), progress }))
    }
}
