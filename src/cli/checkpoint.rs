//! Checkpoints of `caustica render`: read at the start, written during the render.

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

/// Checkpoint files of a render.
pub struct Files {
    /// File to write.
    kept: Option<PathBuf>,
    /// Lock on `kept`, held while the render may write to it.
    _lock: Option<Lock>,
    resumed: Option<(PathBuf, Checkpoint)>,
}

impl Files {
    /// Locks the file `kept` to write, and reads the file `resumed`.
    ///
    /// # Errors
    /// If `resumed` is not a valid checkpoint, `kept` cannot be written, or `kept` exists and is
    /// not the resumed file.
    pub fn new(kept: Option<&Path>, resumed: Option<&Path>) -> Result<Self, Failure> {
        let mut lock = None;
        if let Some(file) = kept {
            check_place(file)?;
            // lock first: another render may be writing the file
            lock = checkpoint::lock(file)?;
            if file.is_file() && !resumed.is_some_and(|other| storage::same(other, file)) {
                return Err(Failure::wrong_use(
                    &format!("{}: the file already exists", file.display()),
                    "continue from it with --resume, or move it away",
                ));
            }
        }
        let resumed = match resumed {
            Some(file) => Some((file.to_owned(), read(file)?)),
            None => None,
        };
        Ok(Self { kept: kept.map(Path::to_owned), _lock: lock, resumed })
    }

    /// Returns true if checkpoints are written.
    pub fn keeps(&self) -> bool {
        self.kept.is_some()
    }

    /// Checkpoint to resume, if any.
    pub fn resumed(&self) -> Option<&Checkpoint> {
        self.resumed.as_ref().map(|(_, checkpoint)| checkpoint)
    }

    /// Fails if the resumed checkpoint does not match the render; see
    /// [`Checkpoint::check_resumes`].
    pub fn check(&self, origin: &Origin, bits: u32, passes: Passes) -> Result<(), Failure> {
        if let Some((file, checkpoint)) = &self.resumed {
            checkpoint.check_resumes(file, origin, bits, passes.first, passes.end)?;
        }
        Ok(())
    }

    /// Returns the settings with the batch size of the resumed checkpoint, unless they set one.
    pub fn batched(&self, settings: RenderSettings) -> RenderSettings {
        let batch = settings.batch.or(self.resumed().and_then(|from| from.origin.settings.batch));
        RenderSettings { batch, ..settings }
    }

    /// Reports the resumed checkpoint, if any.
    pub fn tell(&self, json: bool, reporter: &Reporter) -> Result<(), Failure> {
        let Some((file, checkpoint)) = &self.resumed else {
            return Ok(());
        };
        let passes = checkpoint.state.passes;
        if json {
            return result(json!({ "event": "resume", "file": file, "passes": passes }));
        }
        reporter.note(&format!("{}: resuming after {passes} passes", file.display()));
        Ok(())
    }
}

/// Checkpoint writer. A failure to write is reported and does not end the render; a failure to
/// write the last checkpoint fails the command.
pub struct Keeper {
    file: Option<PathBuf>,
    origin: Origin,
    json: bool,
    failed: Option<CheckpointError>,
    /// Fallback location while `file` cannot be written.
    elsewhere: Option<PathBuf>,
}

impl Keeper {
    /// Creates a writer for the checkpoint file of `files`.
    pub fn new(files: &Files, origin: Origin, json: bool) -> Self {
        Self { file: files.kept.clone(), origin, json, failed: None, elsewhere: None }
    }

    /// Writes the engine state at `progress`, and returns it.
    pub fn save(&mut self, state: State, progress: &Progress) -> State {
        let checkpoint = self.checkpoint(state, progress);
        if let Some(file) = self.file.clone() {
            self.write(&file, &checkpoint);
        }
        checkpoint.state
    }

    /// Checkpoint of a render whose device failed. If no checkpoint file was given, it is written
    /// next to the first image, unless that file exists.
    pub fn rest(&mut self, state: State, progress: &Progress, pictures: &[PathBuf]) -> Checkpoint {
        let rest = self.checkpoint(state, progress);
        let neighbor = pictures.first().map(|picture| picture.with_extension(EXTENSION));
        if self.file.is_none()
            && let Some(file) = neighbor.filter(|file| !file.exists())
        {
            self.write(&file, &rest);
            self.file = Some(file);
        }
        rest
    }

    /// File of the last checkpoint, if it was written successfully.
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
                // a failure of standard output is reported with the results at the end
                let passes = checkpoint.state.passes;
                let _ = result(json!({ "event": "checkpoint", "file": file, "passes": passes }));
            }
            None => (),
        }
    }

    /// Writes a checkpoint that could not be written to `file` to the current folder or the
    /// temporary folder, and reports its location.
    fn write_elsewhere(&mut self, file: &Path, checkpoint: &Checkpoint) {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        // file names are limited to 255 bytes
        let stem: String = stem.chars().take(50).collect();
        let name = format!("{stem}-saved-{}.{EXTENSION}", std::process::id());
        let folders = [PathBuf::from("."), std::env::temp_dir()];
        let new = folders.iter().map(|folder| folder.join(&name)).filter(|place| !place.exists());
        let places: Vec<PathBuf> = self.elsewhere.take().into_iter().chain(new).collect();
        self.elsewhere = places.into_iter().find(|place| write(place, checkpoint).is_ok());
        match &self.elsewhere {
            Some(place) => message(format_args!("checkpoint saved in {}", place.display())),
            None => message("the checkpoint could not be saved elsewhere"),
        }
    }

    /// Fails if the last checkpoint could not be written.
    pub fn end(self) -> Result<(), Failure> {
        self.failed.map_or(Ok(()), |error| Err(error.into()))
    }
}
