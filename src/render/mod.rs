//! The pass loop: stop conditions, progress, and recovery from device failures.

pub mod calibration;
mod estimates;
pub mod failover;
pub mod identity;
mod keep;
mod progress;
pub mod quality;
mod run;
pub mod snapshots;
#[cfg(test)]
mod tests;

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::engine::{Engine, EngineError, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use keep::KEEP;
use run::Run;

pub use progress::{Progress, Stop};

/// Reason why a render ended.
#[derive(Debug)]
pub enum Ending {
    /// All passes are complete.
    Passes,
    /// The time limit was reached.
    Time,
    /// The stated error reached the target.
    TargetError,
    /// The user interrupted the render.
    Interrupted,
}

/// Result of a render.
#[derive(Debug)]
pub struct Outcome {
    /// Radiance estimate.
    pub picture: Picture,
    /// Error estimate; `None` if there are too few passes for one.
    pub errors: Option<ErrorMap>,
    /// Layers requested by the film in addition to radiance.
    pub layers: Vec<Channel>,
    /// Counts of rejected samples.
    pub rejections: Rejections,
    /// Progress after the last pass of the image.
    pub progress: Progress,
    /// Reason why the render ended.
    pub ending: Ending,
}

/// State recovered from a render whose last device failed.
#[derive(Debug)]
pub struct Kept {
    /// Engine state.
    pub state: State,
    /// Progress of that state.
    pub progress: Progress,
}

/// A render that failed and that no other device could continue.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub struct Broken {
    /// Error of the last device.
    pub error: EngineError,
    /// State from which the render can be resumed; `None` if no pass was recovered.
    pub kept: Option<Box<Kept>>,
}

/// Periodic saving of the engine state, e.g. to a checkpoint.
pub struct Saving<'a> {
    /// Time between two calls.
    pub every: Duration,
    /// Saves the state and returns it. Called between passes, at the end, and after a device
    /// failure if passes were recovered that are not saved yet.
    pub save: &'a mut dyn FnMut(State, &Progress) -> State,
}

/// Looks at the engine between passes.
pub trait Watcher {
    /// Called after each pass of this session, which took `time` and was number `passes` of the
    /// render.
    ///
    /// # Errors
    /// Those of the engine.
    fn after_pass(
        &mut self,
        passes: u32,
        time: Duration,
        engine: &mut dyn Engine,
    ) -> Result<(), EngineError>;
}

/// Engines that render one after another.
pub trait Engines {
    /// The current engine.
    ///
    /// # Errors
    /// If no engine is left.
    fn current(&mut self) -> Result<&mut dyn Engine, EngineError>;
    /// Replaces the current engine, which failed with `error`, by one that continues from `state`.
    ///
    /// # Errors
    /// The error of the last engine, if no other one can continue.
    fn replace(&mut self, state: &State, error: EngineError) -> Result<(), EngineError>;
}

/// An engine without a substitute.
pub struct Single<'a>(pub &'a mut dyn Engine);

impl Engines for Single<'_> {
    fn current(&mut self) -> Result<&mut dyn Engine, EngineError> {
        Ok(self.0)
    }

    fn replace(&mut self, _state: &State, error: EngineError) -> Result<(), EngineError> {
        Err(error)
    }
}

/// Session of a render: where it starts, when it ends, and who follows it.
pub struct Session<'a> {
    /// State that the engine restores.
    pub state: &'a State,
    /// Progress of that state; elapsed time accumulates.
    pub progress: Progress,
    /// If set, the render ends after the current pass.
    pub interrupted: &'a AtomicBool,
    /// Called with the progress after each pass.
    pub observer: &'a mut dyn FnMut(&Progress),
    /// Called with the engine after each pass.
    pub watchers: &'a mut [&'a mut dyn Watcher],
    /// Periodic saving, if wanted.
    pub saving: Option<Saving<'a>>,
}

/// Renders passes until a stop condition holds or `interrupted` is set, which ends the render after
/// the current pass. Calls `observer` after each pass.
///
/// # Errors
/// If the engine fails.
pub fn render(
    engine: &mut dyn Engine,
    stop: Stop,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
) -> Result<Outcome, Broken> {
    let state = State::before(0);
    let progress = Progress::before(stop);
    let session =
        Session { state: &state, progress, interrupted, observer, watchers: &mut [], saving: None };
    Run::new(session, KEEP).execute(&mut Single(engine), None)
}

/// Resumes a render. Renders no pass if a stop condition already holds.
///
/// # Errors
/// As for [`render`].
pub fn resume(engines: &mut dyn Engines, session: Session) -> Result<Outcome, Broken> {
    let failed = engines.current().and_then(|engine| engine.restore(session.state)).err();
    Run::new(session, KEEP).execute(engines, failed)
}
