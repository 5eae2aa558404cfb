//! The pass loop: stop conditions, progress, and recovery from device failures.

pub mod calibration;
mod estimates;
pub mod identity;
mod keep;
pub mod observers;
mod progress;
pub mod quality;
mod run;
#[cfg(test)]
mod tests;

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::engine::{Engine, EngineError, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use keep::KEEP;
use run::{Run, Watch};

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

/// Renders passes until a stop condition holds or `interrupted` is set, which ends the render after
/// the current pass. Calls `observer` after each pass.
///
/// # Errors
/// If the engine fails and cannot [continue](Engine::go_on) on another device.
pub fn render(
    engine: &mut dyn Engine,
    stop: Stop,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
) -> Result<Outcome, Broken> {
    let state = State::before(0);
    Run::new(Progress::before(stop), &state, None, KEEP).carry_out(
        engine,
        Watch { interrupted, observer },
        None,
    )
}

/// Resumes a render at `progress` with a new engine, which restores `state`. Elapsed time
/// accumulates. Renders no pass if a stop condition already holds. If `saving` is given, the state
/// is saved periodically.
///
/// # Errors
/// As for [`render`].
pub fn resume<'a>(
    engine: &mut dyn Engine,
    state: &'a State,
    progress: Progress,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
    saving: Option<Saving<'a>>,
) -> Result<Outcome, Broken> {
    let failed = engine.restore(state).err();
    Run::new(progress, state, saving, KEEP).carry_out(
        engine,
        Watch { interrupted, observer },
        failed,
    )
}
