//! An engine that continues on the next device if one fails.

use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::telemetry::clock::KernelSeconds;

/// Supplies the next engine, or the error that prevented one; `None` if no device is left. Receives
/// the error of the last engine and the state from which the next one continues.
pub type Next<'a> =
    dyn FnMut(&EngineError, &State) -> Option<Result<Box<dyn Engine>, EngineError>> + 'a;

/// Runs one engine at a time. Its state is lost if it fails; [`Engine::go_on`] hands a saved state
/// to the next one.
pub struct Relay<'a> {
    engine: Option<Box<dyn Engine>>,
    next: &'a mut Next<'a>,
}

impl<'a> Relay<'a> {
    /// Starts with `engine`.
    pub fn new(engine: Box<dyn Engine>, next: &'a mut Next<'a>) -> Self {
        Self { engine: Some(engine), next }
    }

    fn engine(&mut self) -> Result<&mut dyn Engine, EngineError> {
        match &mut self.engine {
            Some(engine) => Ok(engine.as_mut()),
            None => Err(EngineError::DeviceLost("no device is left".to_owned())),
        }
    }
}

impl Engine for Relay<'_> {
    fn device(&self) -> &str {
        self.engine.as_ref().map_or("no device", |engine| engine.device())
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        self.engine()?.pass()
    }

    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        self.engine()?.timed_pass()
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.engine()?.picture()
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        self.engine()?.errors()
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        self.engine()?.rejections()
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        self.engine()?.results()
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.engine()?.layers()
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        self.engine()?.gathered()
    }

    fn can_be_lost(&self) -> bool {
        self.engine.as_ref().is_none_or(|engine| engine.can_be_lost())
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.engine()?.save()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.engine()?.restore(state)
    }

    fn go_on(&mut self, state: &State, mut error: EngineError) -> Result<(), EngineError> {
        loop {
            // free its memory first: the next engine may need it
            self.engine = None;
            match (self.next)(&error, state) {
                None => return Err(error),
                Some(Err(other)) => error = other,
                Some(Ok(mut engine)) => match engine.restore(state) {
                    Ok(()) => {
                        self.engine = Some(engine);
                        return Ok(());
                    }
                    Err(other) => error = other,
                },
            }
        }
    }
}
