//! `caustica render`: renders a scene to images.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Duration;

use caustica::low_level::checkpoint::Origin;
use caustica::low_level::device::{self, Candidates, DeviceError, Opened, Wanted};
use caustica::low_level::engine::{EngineError, State};
use caustica::low_level::film::denoise::NAME;
use caustica::low_level::film::tev::ADDRESS;
use caustica::low_level::film::{Development, Picture, Provenance, check_outputs};
use caustica::low_level::memory;
use caustica::low_level::prepare::limits;
use caustica::low_level::render::calibration::{Calibrating, Calibration};
use caustica::low_level::render::failover::Failover;
use caustica::low_level::render::quality::{Expected, Quality, expected};
use caustica::low_level::render::snapshots::Snapshots;
use caustica::low_level::render::{Broken, Kept, Progress, Saving, Session, Stop, Watcher, resume};
use caustica::low_level::scene::settings::{Method, RadiusRule, RenderSettings};
use caustica::low_level::scene::{Aovs, Film, Loaded, Scene};
use caustica::low_level::storage;
use clap::builder::NonEmptyStringValueParser;
use miette::miette;
use serde_json::json;

use super::budget::Budget;
use super::checkpoint::Keeper;
use super::device_fallback::Succession;
use super::extent::Extent;
use super::output::{message, paragraph, report, result};
use super::overrides::{Overrides, Passes, duration, target_error};
use super::progress::{Reporter, count, time};
use super::rendered::{Made, left_out};
use super::reproduce::Like;
use super::tev::Viewer;
use super::{Done, Failure, checkpoint, compiling, denoise, hidden, interrupt};

/// Render a scene to images
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file
    #[arg(required_unless_present = "like")]
    scene: Option<PathBuf>,
    /// Image to write: .png (tone-mapped), .exr, .pfm, .hdr; repeatable [default: the scene name
    /// with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Device to render on: auto, gpu, software, cpu, cpu-f64, or part of a device name
    /// [default: auto]
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new())]
    device: Option<String>,
    /// Repeat the render of an .exr file with its scene, settings, size, passes and device, which
    /// other options override [default output: the file name with -again.exr, in the current
    /// folder]
    #[arg(long, value_name = "FILE")]
    like: Option<PathBuf>,
    /// Send the image to the viewer tev during the render [address if omitted: 127.0.0.1:14158]
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true, default_missing_value = ADDRESS)]
    tev: Option<String>,
    /// Start no pass after this time, e.g. 30s or 5m; without --passes, the pass limit of the scene
    /// does not apply
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Stop at this stated relative error, e.g. 2% or 0.02; without --passes, the pass limit of the
    /// scene does not apply
    #[arg(long, value_name = "E", value_parser = target_error, allow_hyphen_values = true)]
    target_error: Option<f64>,
    /// File for checkpoints, written periodically and at the end; --resume continues from it
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Time between checkpoints, e.g. 30s or 5m
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "30s", requires = "checkpoint")]
    checkpoint_every: Duration,
    /// Resume from this checkpoint; the image is that of an uninterrupted render
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Write a denoised image to .png files, and as layer `denoised` to .exr files; the error
    /// estimate does not cover it (needs the cargo feature denoise)
    #[arg(long)]
    denoise: bool,
    /// Fail, after writing the images, if a sample was rejected because it was not finite
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    budget: Budget,
    #[command(flatten)]
    extent: Extent,
    #[command(flatten)]
    voice: OutputArgs,
    #[command(flatten)]
    overrides: Overrides,
}

impl Arguments {
    /// Requested device, if it is known before any file is read.
    pub fn device(&self) -> Option<&str> {
        self.device.as_deref()
    }
}

const HELP: &str = "\
Examples:
  caustica render scenes/caustics.toml
  caustica render scenes/cornell.toml -o cornell.exr -o cornell.png --time 30s --device cpu
  caustica render scenes/cornell.toml --target-error 2%
  caustica render scenes/cornell.toml --checkpoint cornell.checkpoint
  caustica render scenes/cornell.toml --resume cornell.checkpoint --checkpoint cornell.checkpoint
  caustica render scenes/cornell.toml -o layers.exr --aov albedo,normal,depth --crop 0,0,256,256
  caustica render --like layers.exr -o again.exr

Layers for --aov: albedo, normal (both seen through mirrors and glass), depth, position, object, \
material, radius, photons, variance, and the components of the image: emission, direct, caustic, \
indirect. See docs/pictures.md.

The error is the square root of relMSE and includes noise and bias: in nine of ten renders, the \
true error is at most the stated one. The estimate is available from pass 4; .exr files contain \
the variance and bias of each pixel (docs/error-estimate.md).

To resume a checkpoint, use the same scene and settings; --device may differ, and --passes may be \
higher (docs/checkpoints.md).";

/// Verbosity and format of the output.
#[derive(clap::Args)]
pub struct OutputArgs {
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
    /// Print progress and results as one JSON object per line on standard output
    #[arg(long)]
    pub json: bool,
}

/// Finds the devices that match a request.
type Find<'a> = dyn Fn(&Wanted, &RenderSettings) -> Result<Candidates, DeviceError> + 'a;

/// Renders the scene and writes the images.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    run_on(arguments, &|wanted, settings| {
        let candidates = Candidates::of(wanted, settings)?;
        if !Candidates::is_path_on_cpu(wanted, settings) {
            hidden::warn(wanted);
        }
        Ok(candidates)
    })
}

/// Runs the command on devices found by `find`.
fn run_on(arguments: Arguments, find: &Find) -> Result<Done, Failure> {
    compiling::begin(arguments.voice.quiet, arguments.voice.json);
    let like = arguments.like.as_deref().map(Like::read).transpose()?;
    let file = arguments.scene.clone().or(like.as_ref().map(Like::scene)).unwrap_or_default();
    let outputs = match arguments.output.as_slice() {
        [] => vec![like.as_ref().map_or_else(|| default_output(&file), Like::output)],
        named => named.to_vec(),
    };
    check_outputs(&outputs)?;
    let files =
        checkpoint::Files::new(arguments.checkpoint.as_deref(), arguments.resume.as_deref())?;
    let loaded = match &like {
        Some(like) => {
            let mut loaded = like.load(&file, &arguments.overrides.allowed)?;
            like.apply(&mut loaded);
            loaded
        }
        None => arguments.overrides.allowed.load(&file)?,
    };
    let asked = loaded.scene.film.aovs;
    let (mut scene, settings) = put_in_force(loaded, &arguments.overrides);
    scene.film.aovs = asked;
    arguments.extent.apply(&mut scene.film, &outputs)?;
    let asked = scene.film.aovs;
    let denoiser =
        arguments.denoise.then(|| denoise::begin(&mut scene.film, &outputs)).transpose()?;
    let passes = arguments.overrides.passes();
    let first_pass =
        passes.map_or(like.as_ref().map_or(0, Like::first_pass), |passes| passes.first);
    check_range(first_pass, &settings)?;
    let device = arguments.device.as_deref().or(like.as_ref().map(Like::device)).unwrap_or("auto");
    let json = arguments.voice.json;
    let settings = files.batched(settings);
    let candidates = find(&device::parse(device), &settings)?;
    let memory = arguments.budget.memory(&files);
    let mut succession = Succession::new(candidates, &scene, &settings, memory, json);
    let opened = succession.first()?;
    let mut viewer = Viewer::connect(arguments.tev.as_deref(), &scene)?;
    let scene_text = storage::read_text(&file, memory::readable()).unwrap_or_default();
    let origin = Origin::of(&opened, &scene, &scene_text);
    let digest = origin.identity.digest();
    let Arguments { time, target_error, .. } = arguments;
    let limited = time.is_none() && target_error.is_none() || passes.is_some();
    let end = if limited { settings.passes } else { u32::MAX };
    if target_error.is_some() && end == u32::MAX && time.is_none() {
        check_target(&settings)?;
    }
    let stop = Stop { passes: end - first_pass, time, target_error };
    files.check(&origin, opened.kind.bits(), Passes { first: first_pass, end })?;
    let from = files.resumed();
    let reporter = begin(&arguments.voice, &scene, &opened)?;
    let mut next = |error: &EngineError, state: &State| succession.next(error, state);
    let mut engines = Failover::new(opened.engine, &mut next);
    let nothing = State::before(first_pass);
    let state = from.map_or(&nothing, |from| &from.state);
    let progress = from.map_or(Progress::before(stop), |from| from.progress(stop));
    files.tell(json, &reporter)?;
    let reporter = RefCell::new(reporter);
    let mut show = |progress: &Progress| reporter.borrow_mut().show(progress);
    let mut keeper = Keeper::new(&files, origin, json);
    let mut save = |state: State, progress: &Progress| keeper.save(state, progress);
    let every = arguments.checkpoint_every;
    let saving = files.keeps().then_some(Saving { every, save: &mut save });
    // calibration needs the first passes, which a resumed render lacks
    let quality = arguments.overrides.quality.filter(|_| from.is_none());
    let promise =
        quality.map(|quality| Promise { quality, stop, settings: &opened.settings, json });
    let mut tell = |calibration: &Calibration| {
        if let Some(promise) = &promise {
            promise.tell(calibration, &reporter.borrow());
        }
    };
    let mut calibrating = promise.is_some().then(|| Calibrating::new(&mut tell));
    let mut send = |picture: &Picture| viewer.show(picture);
    let mut snapshots = arguments.tev.is_some().then(|| Snapshots::new(&mut send));
    let mut watchers: Vec<&mut dyn Watcher> = Vec::new();
    watchers.extend(calibrating.iter_mut().map(|watcher| watcher as &mut dyn Watcher));
    watchers.extend(snapshots.iter_mut().map(|watcher| watcher as &mut dyn Watcher));
    let session = Session {
        state,
        progress,
        interrupted: interrupt::flag(),
        observer: &mut show,
        watchers: &mut watchers,
        saving,
    };
    let outcome = resume(&mut engines, session);
    let mut reporter = reporter.into_inner();
    reporter.finish();
    let (mut made, error) = match outcome {
        Ok(outcome) => (Made::from(outcome), None),
        Err(Broken { error, kept: None }) => return Err(error.into()),
        Err(Broken { error, kept: Some(kept) }) => {
            let Kept { state, progress } = *kept;
            let rest = keeper.rest(state, &progress, &outputs);
            (Made::of_rest(&rest, progress), Some(error))
        }
    };
    viewer.show(&made.picture);
    let denoised = denoiser.map_or(Ok(()), |denoiser| denoise::end(&denoiser, &mut made, asked));

    let provenance = Provenance {
        scene: scene.name.clone(),
        scene_file: file.display().to_string(),
        scene_text,
        digest: Some(digest),
        film: Some(Film { aovs: asked, ..scene.film }),
        materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
        asked: Some(succession.asked().clone()),
        settings: opened.settings,
        device: succession.device(),
        first_pass,
        passes_done: made.progress.passes,
        denoised: made.denoised.as_ref().map(|_| NAME.to_owned()),
    };
    let film = &scene.film;
    let development =
        Development { exposure: film.exposure, tonemap: film.tonemap, bits: arguments.extent.bits };
    let written = made.write(&outputs, &development, &provenance);
    if written.is_ok() {
        made.tell(json, &reporter, &outputs)?;
    }
    if let Some(error) = error {
        if let Err(failure) = written {
            failure.tell();
        }
        if let Err(why) = denoised {
            message(format_args!("warning: --denoise: {why}"));
        }
        return broken_off(error, made.progress.passes, &keeper);
    }
    written?;
    keeper.end()?;
    denoised?;
    if arguments.strict && !made.rejections.is_empty() {
        return Err(Failure::failed(miette!("--strict: {}", left_out(&made.rejections))));
    }
    Ok(if made.ended == "interrupted" { Done::Interrupted } else { Done::Fully })
}

/// Reports why a render ended early, and how to continue it.
fn broken_off(error: EngineError, passes: u32, keeper: &Keeper) -> Result<Done, Failure> {
    paragraph(format_args!("the image contains only the first {passes} passes: {error}"));
    match keeper.place() {
        Some(file) => message(format_args!(
            "checkpoint saved in {}; to continue, run the same command with --resume {}, on any \
             --device",
            file.display(),
            file.display()
        )),
        None => message("no checkpoint was written"),
    }
    if error.is_of_device() { Ok(Done::DeviceLost) } else { Err(error.into()) }
}

/// Fails if a range does not start at pass 0, but its passes depend on earlier ones.
fn check_range(first_pass: u32, settings: &RenderSettings) -> Result<(), Failure> {
    if first_pass > 0
        && settings.radius_rule == RadiusRule::Local
        && settings.method != Method::Path
    {
        return Err(Failure::wrong_use(
            &format!(
                "the local radius rule cannot start at pass {first_pass}, since each pass needs \
                 the photon counts of all earlier passes"
            ),
            "start with pass 0 and continue with --resume, or use --radius-rule global",
        ));
    }
    Ok(())
}

/// Fails if the error does not converge to zero, so that the render might never reach the target.
fn check_target(settings: &RenderSettings) -> Result<(), Failure> {
    let (what, instead) = match settings {
        RenderSettings { method: Method::Ppm, .. } => ("ppm has fixed eye paths", "--method sppm"),
        RenderSettings { method: Method::Sppm, radius_rule: RadiusRule::Fixed, .. } => {
            ("the fixed rule has a constant radius", "--radius-rule global")
        }
        _ => return Ok(()),
    };
    Err(Failure::wrong_use(
        &format!(
            "{what}, whose error remains with any number of passes: the render may never reach the \
             target error"
        ),
        &format!("add --passes or --time to --target-error, or use {instead}"),
    ))
}

/// Reports the scene, the device and the settings before the render.
pub fn begin(voice: &OutputArgs, scene: &Scene, opened: &Opened) -> Result<Reporter, Failure> {
    let reporter = Reporter::new(voice.quiet, voice.json);
    reporter.note(&format!("{}: {} ({})", scene.name, opened.name, opened.why));
    if let Some(radius) = &opened.radius {
        reporter.note(&format!("start radius {radius}"));
    }
    if let Some(cut) = &opened.cut {
        reporter.note(cut);
    }
    for warning in &opened.warnings {
        message(format_args!("warning: {warning}"));
    }
    if voice.json {
        result(json!({
            "event": "start",
            "scene": scene.name,
            "device": opened.name,
            "why": opened.why,
            "width": scene.film.width,
            "height": scene.film.height,
            "settings": opened.settings,
            "cut": opened.cut,
            "radius_why": opened.radius.map(|radius| radius.to_string()),
        }))?;
    }
    Ok(reporter)
}

/// Prediction of time and error of a preset from its first passes.
struct Promise<'a> {
    quality: Quality,
    stop: Stop,
    settings: &'a RenderSettings,
    json: bool,
}

impl Promise<'_> {
    /// Reports the expected error and time of the whole render.
    fn tell(&self, calibration: &Calibration, reporter: &Reporter) {
        let Calibration { seconds_per_pass, one_pass } = *calibration;
        let in_time =
            self.stop.time.map_or(f64::MAX, |time| time.as_secs_f64() / seconds_per_pass.max(1e-9));
        let passes = f64::from(self.stop.passes).min(in_time.max(2.0)) as u32;
        let seconds = seconds_per_pass * f64::from(passes);
        let expected = expected(one_pass, passes, self.settings.method);
        if self.json {
            // a failure of standard output is reported with the results at the end
            let _ = result(json!({
                "event": "calibration",
                "quality": self.quality,
                "passes": passes,
                "seconds_per_pass": seconds_per_pass,
                "one_pass_relMSE": one_pass,
                "expected_relMSE": expected,
                "expected_seconds": seconds,
            }));
            return;
        }
        let Expected { rel_mse, low, high } = expected;
        let percent = |rel_mse: f64| 100.0 * rel_mse.sqrt();
        reporter.note(&format!(
            "{}: {passes} passes of {} photons; expected after two passes: total time {}, error \
             {:.1} % ({:.1} to {:.1} %, relMSE {rel_mse:.1e})",
            self.quality.word(),
            count(f64::from(self.settings.photons)),
            time(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)),
            percent(rel_mse),
            percent(low),
            percent(high),
        ));
    }
}

/// Reads the scene, applies the options, and prints the warnings.
pub fn load(file: &Path, overrides: &Overrides) -> Result<(Scene, RenderSettings), Failure> {
    in_force(overrides.allowed.load(file)?, overrides)
}

/// Applies the options and prints the warnings, for commands that start at pass 0. Layers of the
/// film are dropped.
pub fn in_force(loaded: Loaded, overrides: &Overrides) -> Result<(Scene, RenderSettings), Failure> {
    if overrides.begins_later() {
        return Err(Failure::wrong_use(
            "this command starts at pass 0",
            "give --passes a number; only `render` accepts ranges",
        ));
    }
    Ok(put_in_force(loaded, overrides))
}

fn put_in_force(mut loaded: Loaded, overrides: &Overrides) -> (Scene, RenderSettings) {
    overrides.apply(&mut loaded.scene, &mut loaded.settings);
    loaded.scene.film.aovs = Aovs::default();
    let limits = limits::warnings(&loaded.scene, &loaded.settings, &loaded.places);
    for warning in loaded.warnings.into_iter().chain(limits) {
        report(&warning);
    }
    (loaded.scene, loaded.settings)
}

/// Default output file.
pub fn default_output(scene: &Path) -> PathBuf {
    Path::new(scene.file_stem().unwrap_or(scene.as_os_str())).with_extension("png")
}

#[cfg(test)]
#[path = "../../tests/engines/faults/engine.rs"]
mod engine;
#[cfg(test)]
#[path = "render_faults.rs"]
mod faults;
