//! `caustica study`: measures speed against accuracy.

use std::path::{Path, PathBuf};
use std::time::Duration;

use caustica::low_level::device::{self, DeviceKind};
use caustica::low_level::film::provenance::VERSION;
use caustica::low_level::film::{Region, read};
use caustica::low_level::memory;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::{Method, RenderSettings};
use caustica::low_level::storage;
use caustica::low_level::study::StudyError;
use caustica::low_level::study::conduct::{Event, Study};
use caustica::low_level::study::folder::{About, Folder};
use caustica::low_level::study::grid::{Axis, Config, configs, default_axes};
use caustica::low_level::study::truth::TruthSpec;
use caustica::low_level::study::{report, words};
use clap::builder::NonEmptyStringValueParser;
use miette::miette;
use serde_json::json;

use super::output::{message, result};
use super::overrides::{Overrides, duration, word};
use super::progress::time;
use super::render::{OutputArgs, load};
use super::{Done, Failure, compiling, hidden, interrupt};

/// Measure speed against accuracy over a grid of settings, and write curves and a report
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Folder for the report and the figures; continues an unfinished study in it [default: the
    /// scene name with -study, in the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Total time, e.g. 2m or 1h
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "2m")]
    budget: Duration,
    /// Reference image with radiance; give several independent ones to measure their own error
    #[arg(long, value_name = "FILE", conflicts_with_all = ["truth_time", "truth_method", "truth_seeds"])]
    truth: Vec<PathBuf>,
    /// Time to render the reference [default: a third of the budget, shared by all lamp areas]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    truth_time: Option<Duration>,
    /// Method for the reference [default: a method other than those studied, unless it is much
    /// noisier or misses light]
    #[arg(long, value_name = "sppm|ppm|path", value_parser = word::<Method>)]
    truth_method: Option<Method>,
    /// Number of renders whose mean is the reference
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100), default_value_t = 4)]
    truth_seeds: u32,
    /// Number of renders per configuration
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), default_value_t = 3)]
    seeds: u32,
    /// Setting and its values; several settings are combined to a grid
    #[arg(long, value_name = "NAME=V1,V2", value_parser = axis)]
    grid: Vec<Axis>,
    /// Setting whose values are tried one at a time, with the others as in the scene file
    /// [default, without --grid: method, radius_rule, radius, photons, direct, alpha]
    #[arg(long, value_name = "NAME=V1,V2", value_parser = axis)]
    vary: Vec<Axis>,
    /// Device to render on: auto, gpu, software, cpu, or part of a device name; repeat to compare
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto")]
    device: Vec<String>,
    /// Crop to show: columns x0 to x1 and rows y0 to y1 [default: the crop with the most contrast]
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = region)]
    crop: Option<Region>,
    #[command(flatten)]
    voice: OutputArgs,
    #[command(flatten)]
    overrides: Overrides,
}

const HELP: &str = "\
Settings for --grid and --vary: method, radius_rule, alpha, radius (2px or 0.01), photons, direct, \
max_bounces, eye_samples, device, lamp_area (all lamps scaled to this area at equal power; spheres \
also to a point).

Without --size or --truth, the image is reduced to at most 256 pixels per side, and the number of \
photons in proportion. See docs/study.md for how to read the report.

Examples:
  caustica study scenes/caustics.toml --budget 2m
  caustica study scenes/cornell.toml --grid radius_rule=global,local --grid photons=16384,65536 --seeds 5 --budget 10m
  caustica study scenes/cornell.toml --truth truth.exr --vary radius=1px,2px,4px";

/// Maximum side of a study's images in pixels, unless a size is given.
const SIDE: u32 = 256;
/// Fraction of the budget that is used for rendering; the rest is for file access and metrics.
const RENDERING: f64 = 0.85;

fn axis(text: &str) -> Result<Axis, String> {
    text.parse::<Axis>().map_err(|error| error.to_string())
}

fn region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Region { x0, y0, x1, y1 }),
        _ => {
            Err("expected four whole numbers with x0 < x1 and y0 < y1, e.g. 290,425,425,485"
                .to_owned())
        }
    }
}

/// Runs the study and writes the report.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let (mut scene, mut settings) = load(&arguments.scene, &arguments.overrides)?;
    let own_size = (scene.film.width, scene.film.height);
    fit_size(&arguments, &mut scene, &mut settings)?;
    let about = about(&arguments, &scene, settings, own_size)?;
    if let Some(crop) =
        arguments.crop.filter(|crop| !crop.fits(scene.film.width, scene.film.height))
    {
        let (width, height) = about.size;
        return Err(Failure::wrong_use(
            &format!("the crop ({crop}) extends beyond the image"),
            &format!(
                "the study's images have {width} columns and {height} rows; --size changes this"
            ),
        ));
    }
    let path = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    let folder = Folder::open(&path, &about)?;
    let mut teller = Teller { quiet: arguments.voice.quiet, json: arguments.voice.json };
    teller.begin(&about, &path)?;
    let study = Study {
        scene: &scene,
        about,
        folder,
        crop: arguments.crop,
        interrupted: interrupt::flag(),
    };
    compiling::begin(arguments.voice.quiet, arguments.voice.json);
    let conducted = study.conduct(&mut |event| teller.tell(event))?;
    if conducted.results.runs.is_empty() {
        message("interrupted before the first render was complete; repeat the command to continue");
        return Ok(Done::Interrupted);
    }
    let parts = report::write(&conducted, &study.folder)?;
    let about = &conducted.results.about;
    if arguments.voice.json {
        let advice: Vec<_> = parts.iter().map(|part| words::recommendations(about, part)).collect();
        result(json!({
            "event": "done",
            "complete": conducted.complete,
            "runs": conducted.results.runs.len(),
            "folder": path,
            "recommendations": advice,
        }))?;
    } else {
        for sentence in words::crossings(about, &parts) {
            result(sentence)?;
        }
        for part in &parts {
            if let Some(lamp) = part.lamp() {
                result(format_args!("lamp {lamp}:"))?;
            }
            words::recommendations(about, part).iter().try_for_each(result)?;
        }
        result(path.join("report.html").display())?;
    }
    if !conducted.complete {
        message("interrupted; the report is partial, repeat the command to continue");
        return Ok(Done::Interrupted);
    }
    match conducted.results.runs.iter().all(|run| run.failed.is_some()) {
        true => Err(Failure::failed(miette!(
            "none of the settings could be rendered; see the report for the reasons"
        ))),
        false => Ok(Done::Fully),
    }
}

fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    PathBuf::from(format!("{stem}-study"))
}

/// Sets the image size: as given by the user or the reference, otherwise reduced so that renders
/// are short.
fn fit_size(
    arguments: &Arguments,
    scene: &mut Scene,
    settings: &mut RenderSettings,
) -> Result<(), Failure> {
    let film = &mut scene.film;
    if arguments.overrides.size.is_some() {
        return Ok(());
    }
    if let Some(file) = arguments.truth.first() {
        let truth = read(file)?;
        (film.width, film.height) = (truth.width, truth.height);
        return Ok(());
    }
    let factor = f64::from(SIDE) / f64::from(film.width.max(film.height));
    if factor < 1.0 {
        let scaled = |side: u32| ((f64::from(side) * factor).round() as u32).max(1);
        (film.width, film.height) = (scaled(film.width), scaled(film.height));
        if arguments.overrides.photons.is_none() {
            settings.photons =
                ((f64::from(settings.photons) * factor * factor).round() as u32).max(1);
        }
    }
    Ok(())
}

fn about(
    arguments: &Arguments,
    scene: &Scene,
    settings: RenderSettings,
    own_size: (u32, u32),
) -> Result<About, Failure> {
    let varied = match (arguments.grid.as_slice(), arguments.vary.as_slice()) {
        ([], []) => default_axes(&settings),
        (_, vary) => vary.to_vec(),
    };
    let mut product = arguments.grid.clone();
    if arguments.device.len() > 1 {
        product.push(Axis { name: "device".to_owned(), values: arguments.device.clone() });
    }
    let mut base = Config::new(settings, arguments.device.first().map_or("auto", String::as_str));
    if let Some(quality) = arguments.overrides.quality {
        base.base = format!("preset {}", quality.word());
    }
    let mut configs = configs(&base, &product, &varied).map_err(StudyError::from)?;
    // report a missing device before any time is spent
    let devices = device::list();
    arguments.device.iter().for_each(|wanted| hidden::warn(&device::parse(wanted)));
    for config in &mut configs {
        let (picked, _) = device::pick(&device::parse(&config.device), &devices)?;
        if picked.kind == DeviceKind::Cpu {
            config.device = DeviceKind::Cpu.word().to_owned();
        }
    }
    let mut lamps: Vec<_> = configs.iter().map(|config| config.variant.lamp).collect();
    lamps.dedup();
    let lamps = lamps.len().max(1) as f64;
    let budget = arguments.budget.as_secs_f64();
    let truth_time = match (arguments.truth.as_slice(), arguments.truth_time) {
        ([], Some(time)) => time.as_secs_f64(),
        ([], None) => budget / 3.0,
        _ => 0.0,
    };
    let runs = configs.len() as f64 * f64::from(arguments.seeds);
    let run_seconds = RENDERING * (budget - truth_time) / runs;
    if run_seconds <= 0.0 {
        return Err(Failure::wrong_use(
            "the reference takes the whole budget",
            "raise --budget, or lower --truth-time",
        ));
    }
    let truth = match arguments.truth.as_slice() {
        [] => TruthSpec::Made {
            method: arguments.truth_method,
            seconds: RENDERING * truth_time / lamps,
            seeds: arguments.truth_seeds,
        },
        files => TruthSpec::Files(files.to_vec()),
    };
    Ok(About {
        version: VERSION.to_owned(),
        scene: scene.name.clone(),
        scene_text: storage::read_text(&arguments.scene, memory::readable()).unwrap_or_default(),
        size: (scene.film.width, scene.film.height),
        own_size,
        configs,
        seeds: arguments.seeds,
        run_seconds,
        truth,
    })
}

/// Reports the events of a study.
struct Teller {
    quiet: bool,
    json: bool,
}

impl Teller {
    fn begin(&self, about: &About, path: &Path) -> Result<(), Failure> {
        if self.json {
            return result(json!({
                "event": "start",
                "scene": about.scene,
                "folder": path,
                "configurations": about.configs.len(),
                "seeds": about.seeds,
                "run_seconds": about.run_seconds,
                "width": about.size.0,
                "height": about.size.1,
            }));
        }
        if !self.quiet {
            message(format_args!(
                "{}: {} settings, {} seeds each, {} s per render, {} x {} pixels",
                about.scene,
                about.configs.len(),
                about.seeds,
                words::short(about.run_seconds),
                about.size.0,
                about.size.1
            ));
        }
        Ok(())
    }

    fn tell(&mut self, event: &Event) {
        match (event, self.json, self.quiet) {
            (Event::Run { done, of, label, seed, last, remaining }, true, _) => {
                let figures = json!({
                    "event": "run",
                    "done": done,
                    "of": of,
                    "label": label,
                    "seed": seed,
                    "last": last,
                    "remaining": remaining.as_secs_f64(),
                });
                // a failure of standard output is reported with the results at the end
                let _ = result(figures);
            }
            (Event::Note(text), true, _) => {
                let _ = result(json!({ "event": "note", "text": text }));
            }
            (_, _, true) => (),
            (Event::Note(text), ..) => message(text),
            (Event::Run { done, of, label, seed, last, remaining }, ..) => {
                let figures = last.map_or("failed".to_owned(), |p| {
                    format!(
                        "{} passes in {:.1} s, relMSE {}",
                        p.passes,
                        p.seconds,
                        words::short(p.rel_mse)
                    )
                });
                message(format_args!(
                    "{done}/{of}  {label}, seed {seed}: {figures}; {} left",
                    time(*remaining)
                ));
            }
        }
    }
}
