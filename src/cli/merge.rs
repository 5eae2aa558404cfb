//! `caustica merge`: merges checkpoints of pass ranges into an image or a checkpoint.

use std::path::{Path, PathBuf};

use caustica::low_level::checkpoint::{self, Checkpoint, EXTENSION, merge};
use caustica::low_level::film::estimate::LEAST_PASSES;
use caustica::low_level::film::file::Format;
use caustica::low_level::film::{self, FileError, RelativeError};
use caustica::low_level::storage;
use serde_json::{Value, json};

use super::output::{message, result};
use super::progress::{count, percent};
use super::rendered::{left_out, write_all};
use super::{Done, Failure};

/// Merge checkpoints of pass ranges into one image
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Checkpoints of consecutive pass ranges, in any order; a single one is developed as it is
    #[arg(required = true, value_name = "CHECKPOINT")]
    checkpoints: Vec<PathBuf>,
    /// Output: .png (tone-mapped), .exr, .pfm, .hdr, or .checkpoint to merge further; repeatable
    #[arg(short, long, required = true, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Print the result as a JSON object
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  caustica render scenes/cornell.toml --passes 0..32 --checkpoint a.checkpoint
  caustica render scenes/cornell.toml --passes 32..64 --checkpoint b.checkpoint
  caustica merge a.checkpoint b.checkpoint -o cornell.exr

The image equals a render of all passes except for rounding (docs/checkpoints.md).";

/// Merges and writes.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let Arguments { checkpoints, output: outputs, json } = arguments;
    let (merged, pictures): (Vec<PathBuf>, Vec<PathBuf>) = outputs
        .iter()
        .cloned()
        .partition(|output| output.extension().is_some_and(|e| e == EXTENSION));
    if let Some(file) = pictures.iter().find(|picture| Format::of(picture).is_none()) {
        return Err(FileError::UnknownFormat {
            file: file.clone(),
            what: "the extension is neither that of an image nor of a checkpoint".to_owned(),
            known: ".png, .exr, .pfm, .hdr or .checkpoint",
        }
        .into());
    }
    film::check_outputs(&pictures)?;
    let mut locks = Vec::new();
    for file in &merged {
        if checkpoints.iter().any(|read| storage::same(read, file)) {
            return Err(Failure::wrong_use(
                &format!("{}: the output is one of the merged checkpoints", file.display()),
                "use another file, so that a failed merge does not destroy its input",
            ));
        }
        checkpoint::check_place(file)?;
        locks.extend(checkpoint::lock(file)?);
    }
    let read = |file: PathBuf| checkpoint::read(&file).map(|checkpoint| (file, checkpoint));
    let all = merge(checkpoints.into_iter().map(read).collect::<Result<_, _>>()?)?;
    // write as many outputs as possible, even if some fail
    let written = merged.iter().map(|file| checkpoint::write(file, &all));
    let mut failures: Vec<Failure> = written.filter_map(Result::err).map(Failure::from).collect();
    let error = write_pictures(&pictures, &all).unwrap_or_else(|failure| {
        failures.push(failure);
        None
    });
    if let Some(last) = failures.pop() {
        for failure in failures {
            failure.tell();
        }
        return Err(last);
    }
    if json {
        result(as_json(&all, error, &outputs))?;
        return Ok(Done::Fully);
    }
    message(as_text(&all, error));
    outputs.iter().try_for_each(|output| result(output.display()))?;
    Ok(Done::Fully)
}

fn write_pictures(
    pictures: &[impl AsRef<Path>],
    all: &Checkpoint,
) -> Result<Option<RelativeError>, Failure> {
    let (picture, errors, rejections) = all.develop();
    if !rejections.is_empty() {
        message(format_args!("warning: {}", left_out(&rejections)));
    }
    let errors = Some(errors).filter(|_| all.state.passes >= LEAST_PASSES);
    let mut layers = errors.as_ref().map_or(Vec::new(), |errors| errors.layers());
    layers.extend(all.layers());
    let (development, made) = (all.development(), all.provenance());
    write_all(pictures, |output| film::write(output, &picture, &layers, &development, &made))?;
    Ok(errors.map(|errors| errors.relative()))
}

fn as_text(all: &Checkpoint, error: Option<RelativeError>) -> String {
    let error = error.map_or(String::new(), |error| {
        let [stated, noise, bias] = [error.stated, error.noise, error.bias].map(percent);
        format!(", error {stated} (noise {noise}, bias {bias})")
    });
    let (passes, photons) = (all.state.passes, count(all.totals.photons as f64));
    format!(
        "{}: passes {}..{}, {passes} in total, {photons} photons{error}",
        all.origin.scene,
        all.state.first_pass,
        all.end()
    )
}

/// Result as a JSON object; errors are null if there are too few passes for an estimate.
fn as_json(all: &Checkpoint, error: Option<RelativeError>, outputs: &[PathBuf]) -> Value {
    json!({
        "event": "merged",
        "scene": all.origin.scene,
        "first_pass": all.state.first_pass,
        "end": all.end(),
        "passes": all.state.passes,
        "photons": all.totals.photons,
        "error": error.map(|error| error.stated),
        "error_noise": error.map(|error| error.noise),
        "error_bias": error.map(|error| error.bias),
        "outputs": outputs,
    })
}
