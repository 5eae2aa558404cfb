//! Test engine that returns scripted images.

use super::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};

/// Test engine whose image after a number of passes is that of a function.
pub struct Scripted<P: FnMut(u32) -> Picture> {
    /// Number of completed passes.
    pub passes: u32,
    /// Image after so many passes.
    pub image: P,
    /// Called in each pass.
    pub work: fn(),
}

impl<P: FnMut(u32) -> Picture> Scripted<P> {
    /// Engine whose passes take no time.
    pub fn new(image: P) -> Self {
        Self { passes: 0, image, work: || () }
    }
}

impl<P: FnMut(u32) -> Picture> Engine for Scripted<P> {
    fn device(&self) -> &str {
        "scripted"
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        (self.work)();
        self.passes += 1;
        Ok(PassReport { photons: 5, rays: 3, ..PassReport::default() })
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        Ok((self.image)(self.passes))
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        Ok(ErrorMap { width: 1, ..ErrorMap::default() })
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        Ok(Rejections::default())
    }

    fn can_be_lost(&self) -> bool {
        false
    }

    fn save(&mut self) -> Result<State, EngineError> {
        Ok(State { passes: self.passes, ..State::default() })
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.passes = state.passes;
        Ok(())
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        Ok(Vec::new())
    }
}
