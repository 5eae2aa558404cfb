//! Failover: continues a render on the next device if one fails.

use super::Engines;
use crate::engine::{Engine, EngineError, State};

/// Opens the next engine; `None` if there is none left. Its arguments are the error of the last
/// engine, and the state from which the next one continues.
pub type Next<'a> =
    dyn FnMut(&EngineError, &State) -> Option<Result<Box<dyn Engine>, EngineError>> + 'a;

/// Engines of a list of devices. The state of an engine is lost with its device, so the next one
/// restores a copy.
pub struct Failover<'a> {
    engine: Option<Box<dyn Engine>>,
    next: &'a mut Next<'a>,
}

impl<'a> Failover<'a> {
    /// Starts with `engine`.
    pub fn new(engine: Box<dyn Engine>, next: &'a mut Next<'a>) -> Self {
        Self { engine: Some(engine), next }
    }
}

impl Engines for Failover<'_> {
    fn current(&mut self) -> Result<&mut dyn Engine, EngineError> {
        match &mut self.engine {
            Some(engine) => Ok(engine.as_mut()),
            None => Err(EngineError::DeviceLost("no device is left".to_owned())),
        }
    }

    fn replace(&mut self, state: &State, mut error: EngineError) -> Result<(), EngineError> {
        loop {
            // the next engine may need the memory of this one
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
