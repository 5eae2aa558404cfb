//! Writing and reporting of a rendered image.

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

/// A rendered image with its metadata.
pub struct Made {
    /// Radiance estimate.
    pub picture: Picture,
    /// Denoised image: content of PNG files, and a layer of EXR files.
    pub denoised: Option<Picture>,
    /// Error estimate; `None` if there are too few passes for one.
    pub errors: Option<ErrorMap>,
    /// Layers requested by the film in addition to radiance.
    pub layers: Vec<Channel>,
    /// Counts of rejected samples.
    pub rejections: Rejections,
    /// Progress at the end of the render.
    pub progress: Progress,
    /// Reason why the render ended, as in JSON events.
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
    /// Develops the checkpoint of a render whose device failed.
    pub fn of_rest(rest: &Checkpoint, progress: Progress) -> Self {
        let (picture, errors, rejections) = rest.develop();
        let errors = Some(errors).filter(|_| progress.passes >= LEAST_PASSES);
        let progress = Progress { error: errors.as_ref().map(ErrorMap::relative), ..progress };
        let layers = rest.layers();
        Self { picture, denoised: None, errors, layers, rejections, progress, ended: "failed" }
    }

    /// Writes the image to all outputs.
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

    /// Reports totals, error and files.
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
            reporter.note(&format!("the target error of {} was not reached", percent(target)));
        }
        if self.denoised.is_some() {
            reporter.note(&format!(
                "denoised by {}; the stated error is that of the render before denoising",
                denoise::NAME
            ));
        }
        outputs.iter().try_for_each(|output| result(output.display()))
    }
}

/// Saves an image whose outputs could not be written as an EXR file, in the first writable one of
/// these folders: those of the outputs, the current one, the temporary one.
fn save_elsewhere(outputs: &[PathBuf], write: impl Fn(&Path) -> Result<(), FileError>) {
    let folders = outputs.iter().filter_map(|output| Some(output.parent()?.to_owned()));
    let folders = folders.chain([PathBuf::from("."), std::env::temp_dir()]);
    let stem = outputs.first().and_then(|output| output.file_stem()).unwrap_or_default();
    // file names are limited to 255 bytes
    let stem: String = stem.to_string_lossy().chars().take(50).collect();
    for folder in folders {
        let name = format!("{stem}-saved-{}.exr", std::process::id());
        let file = folder.join(name);
        if !file.exists() && write(&file).is_ok() {
            message(format_args!("image saved in {}", file.display()));
            return;
        }
    }
    message("the image could not be saved elsewhere");
}

/// Writes all outputs, even if some fail. Prints all failures except the last, which is returned.
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

/// Describes the rejected samples.
pub fn left_out(rejections: &Rejections) -> String {
    let causes: Vec<_> =
        rejections.causes().iter().map(|(count, cause)| format!("{count} {cause}")).collect();
    format!("rejected: {}", causes.join(", "))
}
