//! The checkpoints of `caustica render`: which files, what is read at the start and written on the
//! way.

use std::path::{Path, PathBuf};

use caustica::low_level::checkpoint::{
    self, Checkpoint, CheckpointError, EXTENSION, Origin, Totals, check_place, read, write,
};
use caustica::low_level::engine::State;
use caustica::low_level::render::Progress;
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::storage::{self, Lock};
use serde_json::json;

use super::Failure;
use super::output::{message, result};
use super::overrides::Passes;
use super::progress::Reporter;

/// What is gone on from, and what is written.
pub struct Files {
    kept: Option<PathBuf>,
    /// Held as long as the render may write to `kept`.
    _lock: Option<Lock>,
    resumed: Option<(PathBuf, Checkpoint)>,
}

impl Files {
    /// Those that are asked for; the one to go on from is read.
    ///
    /// # Errors
    /// Where that is no whole checkpoint, none can be written to the place of the other, or another
    /// render's would be lost there.
    pub fn new(kept: Option<&Path>, resumed: Option<&Path>) -> Result<Self, Failure> {
        let mut lock = None;
        if let Some(file) = kept {
            check_place(file)?;
            // before anything is said of the file: it may be that of a render under way
            lock = checkpoint::lock(file)?;
            if file.is_file() && !resumed.is_some_and(|other| storage::same(other, file)) {
                return Err(Failure::wrong_use(
                    &format!("{}: this file is there already", file.display()),
                    "go on from it with --resume, or move it away",
                ));
            }
        }
        let resumed = match resumed {
            Some(file) => Some((file.to_owned(), read(file)?)),
            None => None,
        };
        Ok(Self { kept: kept.map(Path::to_owned), _lock: lock, resumed })
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

    /// The settings, with the batches of what is gone on from where none are asked for.
    pub fn batched(&self, settings: RenderSettings) -> RenderSettings {
        let batch = settings.batch.or(self.resumed().and_then(|from| from.origin.settings.batch));
        RenderSettings { batch, ..settings }
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

/// Writes checkpoints. One that cannot be written ends no render, but is told, and if it is the
/// last one fails the command.
pub struct Keeper {
    file: Option<PathBuf>,
    origin: Origin,
    json: bool,
    failed: Option<CheckpointError>,
    /// Where it is written for as long as it cannot be written to `file`.
    elsewhere: Option<PathBuf>,
}

impl Keeper {
    /// Writes to the file of `files`.
    pub fn new(files: &Files, origin: Origin, json: bool) -> Self {
        Self { file: files.kept.clone(), origin, json, failed: None, elsewhere: None }
    }

    /// Writes what the engine held at `progress`, and gives it back.
    pub fn save(&mut self, state: State, progress: &Progress) -> State {
        let checkpoint = self.checkpoint(state, progress);
        if let Some(file) = self.file.clone() {
            self.write(&file, &checkpoint);
        }
        checkpoint.state
    }

    /// What is left of a render whose device failed. Where no checkpoint was asked for, it is
    /// written next to the first picture, unless a file is there.
    pub fn rest(&mut self, state: State, progress: &Progress, pictures: &[PathBuf]) -> Checkpoint {
        let rest = self.checkpoint(state, progress);
        let beside = pictures.first().map(|picture| picture.with_extension(EXTENSION));
        if self.file.is_none()
            && let Some(file) = beside.filter(|file| !file.exists())
        {
            self.write(&file, &rest);
            self.file = Some(file);
        }
        rest
    }

    /// Where the last one is, if it could be written.
    pub fn place(&self) -> Option<&Path> {
        self.file.as_deref().filter(|_| self.failed.is_none())
    }

    fn checkpoint(&self, state: State, progress: &Progress) -> Checkpoint {
        Checkpoint {
            origin: self.origin.clone(),
            totals: Totals::of(progress),
            state,
            cuts: Vec::new(),
        }
    }

    fn write(&mut self, file: &Path, checkpoint: &Checkpoint) {
        self.failed = write(file, checkpoint).err();
        match &self.failed {
            Some(error) => {
                message(format_args!("warning: {error}"));
                self.write_elsewhere(file, checkpoint);
            }
            None if self.json => {
                // Standard output that takes nothing fails the results at the end.
                let passes = checkpoint.state.passes;
                let _ = result(json!({ "event": "checkpoint", "file": file, "passes": passes }));
            }
            None => (),
        }
    }

    /// Writes what did not go to `file` into the current folder or that of temporary files, and
    /// says where.
    fn write_elsewhere(&mut self, file: &Path, checkpoint: &Checkpoint) {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        // what the system takes as a name has at most 255 bytes
        let stem: String = stem.chars().take(50).collect();
        let name = format!("{stem}-saved-{}.{EXTENSION}", std::process::id());
        let folders = [PathBuf::from("."), std::env::temp_dir()];
        let new = folders.iter().map(|folder| folder.join(&name)).filter(|place| !place.exists());
        let places: Vec<PathBuf> = self.elsewhere.take().into_iter().chain(new).collect();
        self.elsewhere = places.into_iter().find(|place| write(place, checkpoint).is_ok());
        match &self.elsewhere {
            Some(place) => message(format_args!("the checkpoint is saved in {}", place.display())),
            None => message("the checkpoint could not be saved anywhere else"),
        }
    }

    /// Fails if the last one could not be written.
    pub fn end(self) -> Result<(), Failure> {
        self.failed.map_or(Ok(()), |error| Err(error.into()))
    }
}
