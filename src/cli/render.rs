//! `caustica render`: a scene in, pictures out.

use std::path::{Path, PathBuf};
use std::time::Duration;

use caustica::device::{self, Opened};
use caustica::engine::EngineError;
use caustica::film::{self, Development, Provenance, Rejections, check_outputs};
use caustica::limits;
use caustica::render::{Ending, Outcome, Stop, render};
use caustica::scene::{self, Loaded, Scene};
use caustica::settings::RenderSettings;
use clap::builder::NonEmptyStringValueParser;
use miette::{Report, miette};
use serde_json::json;

use super::output::{message, result};
use super::overrides::{Overrides, duration};
use super::progress::{Reporter, count, event, time};
use super::{Done, Failure, interrupt};

/// Render a scene into pictures
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Picture to write, by its extension: .png (tone-mapped), .exr, .pfm, .hdr; may be given several times
    /// [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Device to render on: auto, gpu, software, cpu, cpu-f64, or a part of a device's name
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto")]
    device: String,
    /// Begin no pass after this time, as in 30s or 5m; without --passes, the only limit
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Fail, with the pictures written, if a sample had to be left out because it was not finite
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    voice: Voice,
    #[command(flatten)]
    overrides: Overrides,
}

const HELP: &str = "\
Examples:
  caustica render scenes/caustics.toml
  caustica render scenes/cornell.toml -o cornell.exr -o cornell.png --time 30s --device cpu";

/// How much is told, and in which form.
#[derive(clap::Args)]
pub struct Voice {
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
    /// Print progress and results as one JSON object per line on standard output
    #[arg(long)]
    pub json: bool,
}

/// Renders and writes.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let outputs = match arguments.output.as_slice() {
        [] => vec![default_output(&arguments.scene)],
        named => named.to_vec(),
    };
    check_outputs(&outputs)?;
    let (scene, settings) = load(&arguments.scene, &arguments.overrides)?;
    let opened = device::open(&device::parse(&arguments.device), &scene, &settings)?;
    let mut reporter = begin(&arguments.voice, &scene, &settings, &opened)?;
    let passes = match (arguments.time, arguments.overrides.passes) {
        (Some(_), None) => u32::MAX,
        _ => settings.passes,
    };
    let stop = Stop { passes, time: arguments.time };
    let mut engine = opened.engine;
    let outcome = render(engine.as_mut(), stop, interrupt::flag(), &mut |progress| reporter.show(progress));
    reporter.finish();
    let outcome = outcome?;

    let provenance = Provenance {
        scene: scene.name.clone(),
        scene_text: std::fs::read_to_string(&arguments.scene).unwrap_or_default(),
        settings,
        device: opened.name,
        passes_done: outcome.progress.passes,
    };
    write(&outputs, &outcome, &scene, &provenance)?;
    tell(arguments.voice.json, &reporter, &outputs, &outcome)?;
    if arguments.strict && !outcome.rejections.is_empty() {
        return Err(Failure::failed(miette!("--strict: {}", left_out(&outcome.rejections))));
    }
    match outcome.ending {
        Ending::Passes | Ending::Time => Ok(Done::Fully),
        Ending::Interrupted => Ok(Done::Interrupted),
        Ending::Failed(error) => {
            message(format_args!(
                "the picture holds the first {} passes only: {error}",
                outcome.progress.passes
            ));
            match error {
                EngineError::DeviceLost(_) => Ok(Done::DeviceLost),
                _ => Err(error.into()),
            }
        }
    }
}

/// Says what is rendered where, before it is.
pub fn begin(
    voice: &Voice,
    scene: &Scene,
    settings: &RenderSettings,
    opened: &Opened,
) -> Result<Reporter, Failure> {
    let reporter = Reporter::new(voice.quiet, voice.json);
    reporter.note(&format!("{}: {} ({})", scene.name, opened.name, opened.why));
    if voice.json {
        result(json!({
            "event": "start",
            "scene": scene.name,
            "device": opened.name,
            "why": opened.why,
            "width": scene.film.width,
            "height": scene.film.height,
            "settings": settings,
        }))?;
    }
    Ok(reporter)
}

/// Reads the scene, puts the options in force, and prints the warnings.
pub fn load(file: &Path, overrides: &Overrides) -> Result<(Scene, RenderSettings), Failure> {
    in_force(scene::load(file)?, overrides)
}

/// Puts the options in force and prints the warnings.
pub fn in_force(mut loaded: Loaded, overrides: &Overrides) -> Result<(Scene, RenderSettings), Failure> {
    overrides.apply(&mut loaded.scene, &mut loaded.settings);
    let limits = limits::warnings(&loaded.scene, &loaded.settings, &loaded.places);
    for warning in loaded.warnings.into_iter().chain(limits) {
        message(format_args!("{:?}", Report::new(warning)));
    }
    Ok((loaded.scene, loaded.settings))
}

fn default_output(scene: &Path) -> PathBuf {
    Path::new(scene.file_stem().unwrap_or(scene.as_os_str())).with_extension("png")
}

fn write(outputs: &[PathBuf], outcome: &Outcome, scene: &Scene, made: &Provenance) -> Result<(), Failure> {
    if !outcome.rejections.is_empty() {
        message(format_args!("warning: {}", left_out(&outcome.rejections)));
    }
    let development = Development { exposure: scene.film.exposure, tonemap: scene.film.tonemap };
    for output in outputs {
        film::write(output, &outcome.picture, &development, made)?;
    }
    Ok(())
}

/// What was left out of the picture and why.
fn left_out(rejections: &Rejections) -> String {
    let causes: Vec<_> =
        rejections.causes().iter().map(|(count, cause)| format!("{count} {cause}")).collect();
    format!("left out of the picture: {}", causes.join(", "))
}

fn tell(json: bool, reporter: &Reporter, outputs: &[PathBuf], outcome: &Outcome) -> Result<(), Failure> {
    let progress = &outcome.progress;
    if json {
        let mut done = event("done", progress);
        done["ended"] = match &outcome.ending {
            Ending::Passes => "passes",
            Ending::Time => "time",
            Ending::Interrupted => "interrupted",
            Ending::Failed(_) => "failed",
        }
        .into();
        done["outputs"] = json!(outputs);
        done["rejected"] = json!(outcome.rejections);
        return result(done);
    }
    reporter.note(&format!(
        "{} passes, {} photons, {} rays in {}",
        progress.passes,
        count(progress.photons as f64),
        count(progress.rays as f64),
        time(progress.elapsed)
    ));
    outputs.iter().try_for_each(|output| result(output.display()))
}
