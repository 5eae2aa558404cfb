//! A rendered picture: written, and told about.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use caustica::low_level::checkpoint::Checkpoint;
use caustica::low_level::film::denoise;
use caustica::low_level::film::estimate::LEAST_PASSES;
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::file::Format;
use caustica::low_level::film::{
    self, Development, ErrorMap, FileError, Picture, Provenance, Rejections,
};
use caustica::low_level::render::{Ending, Outcome, Progress};
use serde_json::json;

use super::Failure;
use super::output::{message, result};
use super::progress::{Reporter, count, event, percent, time};

/// A picture with what belongs to it.
pub struct Made {
    /// The estimate.
    pub picture: Picture,
    /// The same to be looked at: what PNG files show, and a layer in EXR files.
    pub denoised: Option<Picture>,
    /// What it says of its own error; none for fewer passes than an estimate needs.
    pub errors: Option<ErrorMap>,
    /// What the film asks for in addition to radiance.
    pub layers: Vec<Channel>,
    /// What was left out of it.
    pub rejections: Rejections,
    /// How far it is.
    pub progress: Progress,
    /// Why it is no further, in the word of the events.
    pub ended: &'static str,
}

impl From<Outcome> for Made {
    fn from(outcome: Outcome) -> Self {
        let Outcome { picture, errors, layers, rejections, progress, ending } = outcome;
        let ended = match ending {
            Ending::Passes => "passes",
            Ending::Time => "time",
            Ending::TargetError => "target_error",
            Ending::Interrupted => "interrupted",
        };
        Self { picture, denoised: None, errors, layers, rejections, progress, ended }
    }
}

impl Made {
    /// The picture of what is left of a render whose device failed.
    pub fn of_rest(rest: &Checkpoint, progress: Progress) -> Self {
        let (picture, errors, rejections) = rest.develop();
        let errors = Some(errors).filter(|_| progress.passes >= LEAST_PASSES);
        let progress = Progress { error: errors.as_ref().map(ErrorMap::relative), ..progress };
        let layers = rest.layers();
        Self { picture, denoised: None, errors, layers, rejections, progress, ended: "failed" }
    }

    /// Writes it into files.
    pub fn write(
        &self,
        outputs: &[PathBuf],
        development: &Development,
        made: &Provenance,
    ) -> Result<(), Failure> {
        if !self.rejections.is_empty() {
            message(format_args!("warning: {}", left_out(&self.rejections)));
        }
        let mut layers = self.errors.as_ref().map_or(Vec::new(), ErrorMap::layers);
        layers.extend_from_slice(&self.layers);
        layers.extend(self.denoised.iter().flat_map(denoise::layer));
        let write = |output: &Path| {
            let denoised =
                self.denoised.as_ref().filter(|_| Format::of(output) == Some(Format::Png));
            film::write(output, denoised.unwrap_or(&self.picture), &layers, development, made)
        };
        let saved = Cell::new(false);
        let written = write_all(outputs, |output| {
            write(output)?;
            saved.set(saved.get() || Format::of(output) != Some(Format::Png));
            Ok(())
        });
        if written.is_err() && !saved.get() {
            save_elsewhere(outputs, write);
        }
        written
    }

    /// Tells how it came about, and the files.
    pub fn tell(
        &self,
        json: bool,
        reporter: &Reporter,
        outputs: &[PathBuf],
    ) -> Result<(), Failure> {
        let progress = &self.progress;
        if json {
            let mut done = event("done", progress);
            done["ended"] = self.ended.into();
            done["outputs"] = json!(outputs);
            done["rejected"] = json!(self.rejections);
            return result(done);
        }
        let error = progress.error.map_or(String::new(), |e| {
            let [stated, noise, bias] = [e.stated, e.noise, e.bias].map(percent);
            format!(", error {stated} (noise {noise}, bias {bias})")
        });
        reporter.note(&format!(
            "{} passes, {} photons, {} rays in {}{error}",
            progress.passes,
            count(progress.photons as f64),
            count(progress.rays as f64),
            time(progress.elapsed)
        ));
        if let (Some(target), "passes" | "time") = (progress.stop.target_error, self.ended) {
            reporter.note(&format!("the error aimed at, {}, is not reached", percent(target)));
        }
        if self.denoised.is_some() {
            reporter.note(&format!(
                "denoised by {}; the error is that of the render before it",
                denoise::NAME
            ));
        }
        outputs.iter().try_for_each(|output| result(output.display()))
    }
}

/// Saves a picture that could not be written where it should go, with its radiance, in the first of
/// these places that takes it: the folder of another output, the current one, that of temporary
/// files.
fn save_elsewhere(outputs: &[PathBuf], write: impl Fn(&Path) -> Result<(), FileError>) {
    let folders = outputs.iter().filter_map(|output| Some(output.parent()?.to_owned()));
    let folders = folders.chain([PathBuf::from("."), std::env::temp_dir()]);
    let stem = outputs.first().and_then(|output| output.file_stem()).unwrap_or_default();
    // what the system takes as a name has at most 255 bytes
    let stem: String = stem.to_string_lossy().chars().take(50).collect();
    for folder in folders {
        let name = format!("{stem}-saved-{}.exr", std::process::id());
        let file = folder.join(name);
        if !file.exists() && write(&file).is_ok() {
            message(format_args!("the picture is saved in {}", file.display()));
            return;
        }
    }
    message("the picture could not be saved anywhere else");
}

/// Writes each output; one that fails keeps no other from being written. All failures but the last
/// are printed, and that one is returned.
pub fn write_all(
    outputs: &[impl AsRef<Path>],
    write: impl Fn(&Path) -> Result<(), FileError>,
) -> Result<(), Failure> {
    let mut failed: Option<Failure> = None;
    for output in outputs {
        if let Err(error) = write(output.as_ref())
            && let Some(before) = failed.replace(error.into())
        {
            before.tell();
        }
    }
    failed.map_or(Ok(()), Err)
}

/// What was left out of the picture and why.
pub fn left_out(rejections: &Rejections) -> String {
    let causes: Vec<_> =
        rejections.causes().iter().map(|(count, cause)| format!("{count} {cause}")).collect();
    format!("left out of the picture: {}", causes.join(", "))
}
