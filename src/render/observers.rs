//! Display of intermediate images during a render.

use std::time::{Duration, Instant};

use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};

/// Minimum time between two images.
const EVERY: Duration = Duration::from_millis(500);
/// Minimum time between two images as a multiple of the time to show one.
const SHARE: u32 = 10;

/// Engine wrapper that shows the image after the first pass, and periodically afterwards.
pub struct Showing<'a> {
    inner: &'a mut dyn Engine,
    next: Instant,
    show: &'a mut dyn FnMut(&Picture),
}

impl<'a> Showing<'a> {
    /// Wraps an engine; `show` is called with each image.
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
