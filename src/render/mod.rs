//! The loop over passes: stop conditions, progress, and what is kept of a render for the case that
//! its device fails.

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

/// Why a render ended.
#[derive(Debug)]
pub enum Ending {
    /// All passes are made.
    Passes,
    /// The time is up.
    Time,
    /// The stated error is no larger than the one aimed at.
    TargetError,
    /// The user asked for it.
    Interrupted,
}

/// A picture, and how it came about.
#[derive(Debug)]
pub struct Outcome {
    /// The estimate.
    pub picture: Picture,
    /// What it says of its own error; none for fewer passes than an estimate needs.
    pub errors: Option<ErrorMap>,
    /// What the film asks for in addition to radiance.
    pub layers: Vec<Channel>,
    /// What was left out of it.
    pub rejections: Rejections,
    /// The state after the picture's last pass.
    pub progress: Progress,
    /// Why there were no more passes.
    pub ending: Ending,
}

/// What was done before a render's last device failed.
#[derive(Debug)]
pub struct Kept {
    /// What the engine held.
    pub state: State,
    /// How far that is.
    pub progress: Progress,
}

/// A render that no device goes on with.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub struct Broken {
    /// Why.
    pub error: EngineError,
    /// What can be gone on from; none where no pass is left of it.
    pub kept: Option<Box<Kept>>,
}

/// Where a render is kept, so that it can be gone on from.
pub struct Saving<'a> {
    /// Time between two calls.
    pub every: Duration,
    /// Keeps what an engine held, and gives it back. Called between passes, at the end, and once
    /// more where the device fails, if there is more by then.
    pub save: &'a mut dyn FnMut(State, &Progress) -> State,
}

/// Makes passes until a stop condition holds or `interrupted` is set, which ends it after the pass
/// in hand; calls `observer` after each.
///
/// # Errors
/// Where the engine fails and cannot [go on](Engine::go_on) elsewhere.
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

/// The same from where `progress` is, with an engine that has made no pass and takes over `state`,
/// saved now and then. Time counts on. With nothing left to do it makes no pass.
///
/// # Errors
/// As above.
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
