//! Snapshots of the image during a render.

use std::time::{Duration, Instant};

use super::Watcher;
use crate::engine::{Engine, EngineError};
use crate::film::Picture;

/// Minimum time between two snapshots.
const EVERY: Duration = Duration::from_millis(500);
/// Snapshots take at most one part in so many of the time.
const SHARE: u32 = 10;

/// Shows the image after the first pass, and then from time to time.
pub struct Snapshots<'a> {
    next: Instant,
    show: &'a mut dyn FnMut(&Picture),
}

impl<'a> Snapshots<'a> {
    /// Calls `show` with the snapshots.
    pub fn new(show: &'a mut dyn FnMut(&Picture)) -> Self {
        Self { next: Instant::now(), show }
    }
}

impl Watcher for Snapshots<'_> {
    fn after_pass(
        &mut self,
        _passes: u32,
        _time: Duration,
        engine: &mut dyn Engine,
    ) -> Result<(), EngineError> {
        let begun = Instant::now();
        if begun >= self.next {
            (self.show)(&engine.picture()?);
            self.next = Instant::now() + EVERY.max(SHARE * begun.elapsed());
        }
        Ok(())
    }
}
