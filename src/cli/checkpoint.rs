//! The checkpoints of `caustica render`: which files, what is read at the start and written on the way.

use std::path::{Path, PathBuf};

use caustica::checkpoint::{Checkpoint, CheckpointError, Origin, Totals, check_place, read, write};
use caustica::engine::{Engine, EngineError};
use caustica::render::Progress;
use serde_json::json;

use super::Failure;
use super::output::{message, result};
use super::overrides::Passes;
use super::progress::Reporter;

/// What is gone on from, and what is written.
pub struct Files {
    kept: Option<PathBuf>,
    resumed: Option<(PathBuf, Checkpoint)>,
}

impl Files {
    /// Those that are asked for; the one to go on from is read.
    ///
    /// # Errors
    /// Where that is no whole checkpoint, none can be written to the place of the other, or another render's would be lost there.
    pub fn new(kept: Option<&Path>, resumed: Option<&Path>) -> Result<Self, Failure> {
        if let Some(file) = kept {
            let same = |other: &Path| file.canonicalize().ok() == other.canonicalize().ok();
            if file.is_file() && !resumed.is_some_and(same) {
                return Err(Failure::wrong_use(
                    &format!("{}: this file is there already", file.display()),
                    "go on from it with --resume, or move it away",
                ));
            }
            check_place(file)?;
        }
        let resumed = match resumed {
            Some(file) => Some((file.to_owned(), read(file)?)),
            None => None,
        };
        Ok(Self { kept: kept.map(Path::to_owned), resumed })
    }

    /// Whether any is to be written.
    pub fn keeps(&self) -> bool {
        self.kept.is_some()
    }

    /// The one to go on from, if any.
    pub fn resumed(&self) -> Option<&Checkpoint> {
        self.resumed.as_ref().map(|(_, checkpoint)| checkpoint)
    }

    /// Fails unless it fits; see [`Checkpoint::check_resumes`].
    pub fn check(&self, origin: &Origin, bits: u32, passes: Passes) -> Result<(), Failure> {
        if let Some((file, checkpoint)) = &self.resumed {
            checkpoint.check_resumes(file, origin, bits, passes.first, passes.end)?;
        }
        Ok(())
    }

    /// Tells what is gone on from, if anything is.
    pub fn tell(&self, json: bool, reporter: &Reporter) -> Result<(), Failure> {
        let Some((file, checkpoint)) = &self.resumed else {
            return Ok(());
        };
        let passes = checkpoint.state.passes;
        if json {
            return result(json!({ "event": "resume", "file": file, "passes": passes }));
        }
        reporter.note(&format!("{}: goes on after {passes} passes", file.display()));
        Ok(())
    }
}

/// Writes checkpoints. One that cannot be written ends no render, but is told, and if it is the last one fails the command.
pub struct Keeper {
    file: Option<PathBuf>,
    origin: Origin,
    json: bool,
    failed: Option<CheckpointError>,
}

impl Keeper {
    /// Writes to the file of `files`.
    pub fn new(files: &Files, origin: Origin, json: bool) -> Self {
        Self { file: files.kept.clone(), origin, json, failed: None }
    }

    /// Writes what the engine holds now.
    pub fn save(&mut self, engine: &mut dyn Engine, progress: &Progress) -> Result<(), EngineError> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let checkpoint = Checkpoint {
            origin: self.origin.clone(),
            totals: Totals::of(progress),
            state: engine.save()?,
            cuts: Vec::new(),
        };
        self.failed = write(file, &checkpoint).err();
        match &self.failed {
            Some(error) => message(format_args!("warning: {error}")),
            None if self.json => {
                // Standard output that takes nothing fails the results at the end.
                let _ = result(json!({ "event": "checkpoint", "file": file, "passes": progress.passes }));
            }
            None => (),
        }
        Ok(())
    }

    /// Fails if the last one could not be written.
    pub fn end(self) -> Result<(), Failure> {
        self.failed.map_or(Ok(()), |error| Err(error.into()))
    }
}
