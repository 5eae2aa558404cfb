//! The loop over passes: stop conditions, progress, and what is saved when something ends it early.

mod estimates;
mod progress;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::engine::{Engine, EngineError};
use crate::film::estimate::LEAST_PASSES;
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::stage::stage;
use estimates::Estimates;

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
    /// The engine failed after at least one pass.
    Failed(EngineError),
}

/// A picture, and how it came about.
#[derive(Debug)]
pub struct Outcome {
    /// The estimate.
    pub picture: Picture,
    /// What it says of its own error; none for fewer passes than an estimate needs.
    pub errors: Option<ErrorMap>,
    /// What the film asks for beside radiance.
    pub layers: Vec<Channel>,
    /// What was left out of it.
    pub rejections: Rejections,
    /// The state after the picture's last pass.
    pub progress: Progress,
    /// Why there were no more passes.
    pub ending: Ending,
}

/// How often the picture is copied to the host, since a device that is lost takes its buffers along.
#[derive(Clone, Copy)]
struct Keep {
    /// Time between copies.
    every: Duration,
    /// At least so many times the time that a copy takes.
    times_cost: u32,
}

const KEEP: Keep = Keep { every: Duration::from_secs(10), times_cost: 20 };

/// Where a render is kept, so that it can be gone on from.
pub struct Saving<'a> {
    /// Time between two calls.
    pub every: Duration,
    /// Keeps what [`Engine::save`] gives. Called between passes, and at the end unless the engine failed.
    pub save: &'a mut dyn FnMut(&mut dyn Engine, &Progress) -> Result<(), EngineError>,
}

/// Makes passes until a stop condition holds or `interrupted` is set, which ends it after the pass in hand; calls
/// `observer` after each. Fails only where there is no picture to give; an engine that fails later gives the picture
/// of the passes before, or the last one kept of them.
pub fn render(
    engine: &mut dyn Engine,
    stop: Stop,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
) -> Result<Outcome, EngineError> {
    resume(engine, Progress::before(stop), interrupted, observer, None)
}

/// The same from where `progress` is, with an engine that holds its passes, saved now and then. Time counts on. With nothing left
/// to do it makes no pass.
pub fn resume(
    engine: &mut dyn Engine,
    progress: Progress,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
    saving: Option<Saving>,
) -> Result<Outcome, EngineError> {
    render_keeping(engine, progress, interrupted, observer, saving, KEEP)
}

fn render_keeping(
    engine: &mut dyn Engine,
    mut progress: Progress,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
    mut saving: Option<Saving>,
    keep: Keep,
) -> Result<Outcome, EngineError> {
    let _stage = stage("passes");
    let start = Instant::now();
    let (stop, before) = (progress.stop, progress.elapsed);
    let elapsed = || before + start.elapsed();
    let mut kept: Option<Kept> = None;
    let mut next_keep = before + keep.every;
    let mut next_save = saving.as_ref().map(|saving| before.saturating_add(saving.every));
    let mut estimates = Estimates::after(progress.passes);
    if progress.passes == 0 {
        progress.add(&engine.pass()?, elapsed());
    }
    let ending = loop {
        if estimates.due(&progress) {
            let begun = Instant::now();
            match engine.errors() {
                Ok(errors) => progress.error = Some(errors.relative()),
                Err(error) => break Ending::Failed(error),
            }
            estimates.made(&progress, begun.elapsed());
        }
        observer(&progress);
        if interrupted.load(Ordering::Relaxed) {
            break Ending::Interrupted;
        }
        if progress.reached() {
            break Ending::TargetError;
        }
        if progress.passes >= stop.passes {
            break Ending::Passes;
        }
        if stop.time.is_some_and(|time| progress.elapsed >= time) {
            break Ending::Time;
        }
        if progress.elapsed >= next_keep {
            match take(engine, progress) {
                Ok(taken) => kept = Some(taken),
                Err(error) => break Ending::Failed(error),
            }
            let cost = elapsed() - progress.elapsed;
            next_keep = elapsed() + keep.every.max(keep.times_cost * cost);
        }
        if let Some(saving) = &mut saving
            && next_save.is_some_and(|next| progress.elapsed >= next)
        {
            if let Err(error) = (saving.save)(engine, &progress) {
                break Ending::Failed(error);
            }
            next_save = Some(elapsed().saturating_add(saving.every));
        }
        match engine.pass() {
            Ok(report) => progress.add(&report, elapsed()),
            Err(error) => break Ending::Failed(error),
        }
    };
    // what an engine holds that failed in the middle of a pass is no whole number of passes
    let ending = match (ending, saving) {
        (Ending::Failed(error), _) => Ending::Failed(error),
        (ending, None) => ending,
        (ending, Some(saving)) => (saving.save)(engine, &progress).map_or_else(Ending::Failed, |()| ending),
    };
    match (take(engine, progress), ending) {
        (Ok(taken), ending) => Ok(taken.outcome(ending)),
        (Err(_), Ending::Failed(error)) | (Err(error), _) => match kept {
            Some(kept) => Ok(kept.outcome(Ending::Failed(error))),
            None => Err(error),
        },
    }
}

/// A picture with what belongs to it.
struct Kept {
    picture: Picture,
    errors: Option<ErrorMap>,
    layers: Vec<Channel>,
    rejections: Rejections,
    progress: Progress,
}

impl Kept {
    fn outcome(self, ending: Ending) -> Outcome {
        let Self { picture, errors, layers, rejections, progress } = self;
        Outcome { picture, errors, layers, rejections, progress, ending }
    }
}

fn take(engine: &mut dyn Engine, mut progress: Progress) -> Result<Kept, EngineError> {
    let (picture, rejections) = engine.results()?;
    let errors = match progress.passes {
        LEAST_PASSES.. => Some(engine.errors()?),
        _ => None,
    };
    progress.error = errors.as_ref().map(ErrorMap::relative);
    Ok(Kept { picture, errors, layers: engine.layers()?, rejections, progress })
}
