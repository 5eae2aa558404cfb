//! A single render with failover between devices.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::estimates::Estimates;
use super::keep::{Keep, Keeping};
use super::progress::Progress;
use super::{Broken, Ending, Engines, Outcome, Saving, Session, Watcher};
use crate::engine::{Engine, EngineError};
use crate::film::ErrorMap;
use crate::film::estimate::LEAST_PASSES;
use crate::telemetry::stage::stage;

/// A render in progress.
pub struct Run<'a> {
    progress: Progress,
    kept: Keeping<'a>,
    interrupted: &'a AtomicBool,
    observer: &'a mut dyn FnMut(&Progress),
    watchers: &'a mut [&'a mut dyn Watcher],
    saving: Option<Saving<'a>>,
    /// Number of passes in the last saved state.
    saved: Option<u32>,
    /// Time of earlier sessions.
    before: Duration,
    start: Instant,
}

impl<'a> Run<'a> {
    /// Starts a session with an engine in its state.
    pub fn new(session: Session<'a>, keep: Keep) -> Self {
        let Session { state, progress, interrupted, observer, watchers, saving } = session;
        let kept = Keeping::new(state, progress, keep);
        Self {
            progress,
            kept,
            interrupted,
            observer,
            watchers,
            saving,
            saved: None,
            before: progress.elapsed,
            start: Instant::now(),
        }
    }

    /// Runs the render to completion. `failed` is an error that the engine has already reported.
    /// After a failure, the engine continues on another device from the most recent copy.
    pub fn execute(
        mut self,
        engines: &mut dyn Engines,
        mut failed: Option<EngineError>,
    ) -> Result<Outcome, Broken> {
        let _stage = stage("passes");
        loop {
            let error = match failed.take() {
                Some(error) => error,
                None => match engines.current().and_then(|engine| self.passes(engine)) {
                    Ok(outcome) => return Ok(outcome),
                    Err(error) => error,
                },
            };
            if let Ok(engine) = engines.current() {
                self.rescue(engine);
            }
            match engines.replace(&self.kept.state, error) {
                Ok(()) => self.progress = self.kept.progress,
                Err(error) => return Err(self.broken(error)),
            }
        }
    }

    fn passes(&mut self, engine: &mut dyn Engine) -> Result<Outcome, EngineError> {
        let stop = self.progress.stop;
        let mut estimates = Estimates::after(self.progress.passes);
        let mut next_save = self.next_save(self.progress.elapsed);
        if self.progress.passes == 0 {
            self.pass(engine)?;
        }
        let ending = loop {
            if estimates.due(&self.progress) {
                let begun = Instant::now();
                self.progress.error = Some(engine.errors()?.relative());
                estimates.made(&self.progress, begun.elapsed());
            }
            (self.observer)(&self.progress);
            if self.interrupted.load(Ordering::Relaxed) {
                break Ending::Interrupted;
            }
            if self.progress.reached() {
                break Ending::TargetError;
            }
            if self.progress.passes >= stop.passes {
                break Ending::Passes;
            }
            if stop.time.is_some_and(|time| self.progress.elapsed >= time) {
                break Ending::Time;
            }
            let save = next_save.is_some_and(|next| self.progress.elapsed >= next);
            if save || engine.can_be_lost() && self.kept.due(&self.progress) {
                self.keep(engine, save)?;
            }
            if save {
                next_save = self.next_save(self.elapsed());
            }
            self.pass(engine)?;
        };
        if self.saving.is_some() {
            self.keep(engine, true)?;
        }
        self.outcome(engine, ending)
    }

    fn pass(&mut self, engine: &mut dyn Engine) -> Result<(), EngineError> {
        let begun = Instant::now();
        let report = engine.pass()?;
        let time = begun.elapsed();
        let elapsed = self.elapsed();
        self.progress.add(&report, elapsed);
        for watcher in self.watchers.iter_mut() {
            watcher.after_pass(self.progress.passes, time, engine)?;
        }
        Ok(())
    }

    /// Copies the engine state, and saves it if `save` is set.
    fn keep(&mut self, engine: &mut dyn Engine, save: bool) -> Result<(), EngineError> {
        let begun = Instant::now();
        let mut state = engine.save()?;
        let cost = begun.elapsed();
        log::debug!(
            "state copied after pass {}: {:.3} s",
            self.progress.passes,
            cost.as_secs_f64()
        );
        if save && let Some(saving) = &mut self.saving {
            state = (saving.save)(state, &self.progress);
            self.saved = Some(self.progress.passes);
        }
        if engine.can_be_lost() {
            let now = self.elapsed();
            self.kept.take(state, self.progress, cost, now);
        }
        Ok(())
    }

    /// Copies the state of a failed engine if it can still be read, is newer than the last copy and
    /// contains exactly the completed passes.
    fn rescue(&mut self, engine: &mut dyn Engine) {
        let passes = self.progress.passes;
        if passes > self.kept.progress.passes
            && let Ok(state) = engine.save()
            && state.passes == passes
        {
            let now = self.elapsed();
            self.kept.take(state, self.progress, Duration::ZERO, now);
        }
    }

    fn outcome(&self, engine: &mut dyn Engine, ending: Ending) -> Result<Outcome, EngineError> {
        let (picture, rejections) = engine.results()?;
        let errors = match self.progress.passes {
            LEAST_PASSES.. => Some(engine.errors()?),
            _ => None,
        };
        let progress = Progress { error: errors.as_ref().map(ErrorMap::relative), ..self.progress };
        Ok(Outcome { picture, errors, layers: engine.layers()?, rejections, progress, ending })
    }

    /// Ends a failed render. Saves the last copy if it is newer than the last saved state.
    fn broken(mut self, error: EngineError) -> Broken {
        let mut kept = self.kept.end();
        if let (Some(kept), Some(saving)) = (&mut kept, &mut self.saving)
            && self.saved.is_none_or(|saved| saved < kept.progress.passes)
        {
            kept.state = (saving.save)(std::mem::take(&mut kept.state), &kept.progress);
        }
        Broken { error, kept }
    }

    fn elapsed(&self) -> Duration {
        self.before + self.start.elapsed()
    }

    fn next_save(&self, now: Duration) -> Option<Duration> {
        self.saving.as_ref().map(|saving| now.saturating_add(saving.every))
    }
}
