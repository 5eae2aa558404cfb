//! An engine whose picture is shown while it comes about.

use std::time::{Duration, Instant};

use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};

/// Pictures are shown no more often than this.
const EVERY: Duration = Duration::from_millis(500);
/// Showing takes at most one part in so many of the time.
const SHARE: u32 = 10;

/// Carries out passes with another engine and shows the picture after the first, and now and then.
pub struct Showing<'a> {
    inner: &'a mut dyn Engine,
    next: Instant,
    show: &'a mut dyn FnMut(&Picture),
}

impl<'a> Showing<'a> {
    /// Shows what an engine makes.
    pub fn new(inner: &'a mut dyn Engine, show: &'a mut dyn FnMut(&Picture)) -> Self {
        Self { inner, next: Instant::now(), show }
    }
}

impl Engine for Showing<'_> {
    fn device(&self) -> &str {
        self.inner.device()
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let report = self.inner.pass()?;
        let begun = Instant::now();
        if begun >= self.next {
            (self.show)(&self.inner.picture()?);
            self.next = Instant::now() + EVERY.max(SHARE * begun.elapsed());
        }
        Ok(report)
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.inner.picture()
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        self.inner.errors()
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        self.inner.rejections()
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.inner.layers()
    }

    fn can_be_lost(&self) -> bool {
        self.inner.can_be_lost()
    }

    fn go_on(&mut self, state: &State, error: EngineError) -> Result<(), EngineError> {
        self.inner.go_on(state, error)
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.inner.save()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.inner.restore(state)
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        self.inner.results()
    }
}
