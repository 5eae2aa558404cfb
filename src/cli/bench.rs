//! `caustica bench`: kernel times and rates per device, and time to error.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use caustica::low_level::bench::to_error::{Approach, Goal, Limit, ToErrorError, approach};
use caustica::low_level::bench::{
    Conduct, DeviceReport, can_run, device_report, machine::Machine, setup,
};
use caustica::low_level::device::{self, DeviceInfo, DeviceKind};
use caustica::low_level::film::metrics::MetricsError;
use caustica::low_level::film::{Coding, Picture, Region, read_any};
use caustica::low_level::gpu::program::Compiling;
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{self, Loaded, Scene};
use clap::builder::NonEmptyStringValueParser;
use miette::miette;
use serde_json::json;

use super::bench_table::{device_text, heading};
use super::bounds::{Bound, check_regions, upper};
use super::diff::{region, region_names};
use super::output::{message, result};
use super::overrides::{Overrides, duration};
use super::render::in_force;
use super::{Done, Failure, compiling, hidden, interrupt};

/// Default scene.
const CORNELL: &[u8] = include_bytes!("../../scenes/cornell.toml");
/// Default number of passes without a time limit.
const PASSES: u32 = 10;
/// Default time limit of a time-to-error run.
const TO_ERROR: Duration = Duration::from_secs(60);

/// Benchmark devices: kernel times and rates, compile times, memory, time to error
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file [default: a Cornell box]
    scene: Option<PathBuf>,
    /// Device to measure, as for `render`; repeatable
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto")]
    device: Vec<String>,
    /// Start no pass after this time, e.g. 30s; also limits the time-to-error run [default: 60s for
    /// the time-to-error run, unless --passes is given]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Warm-up passes, which are not measured
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    warm_up: u32,
    /// Target time of a GPU submission, e.g. 50ms, or `none` for a single submission; repeatable:
    /// passes are measured with each value, and the main figures use the first
    #[arg(long, value_name = "TIME|none", value_parser = slice, default_value = "50ms")]
    slice: Vec<f64>,
    /// Print one JSON object per line; times in seconds, memory in bytes
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    truth: Truth,
    #[command(flatten)]
    overrides: Overrides,
}

/// Reference image and error targets.
#[derive(clap::Args)]
#[command(next_help_heading = "Time to error")]
struct Truth {
    /// Reference image (.exr, .pfm, .hdr); reports relMSE over time
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Also report the error of a region: columns x0 to x1 and rows y0 to y1 from the top left, x1
    /// and y1 excluded
    #[arg(long, value_name = "NAME=x0,y0,x1,y1", value_parser = region, requires = "truth")]
    region: Vec<(String, Region)>,
    /// Target relMSE; exit with code 3 if it is not reached
    #[arg(long = "max-relMSE", alias = "max-relmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true, requires = "truth")]
    max_rel_mse: Vec<Bound>,
    /// relMSE of the reference due to its own noise, which is subtracted
    #[arg(long, value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true, requires = "truth")]
    truth_noise: Vec<Bound>,
}

const HELP: &str = "\
Each measurement round consists of a pass with timed kernels (by the device's clock if it has \
one) and a regular pass for each --slice. See docs/performance.md for the figures.

Examples:
  caustica bench --device gpu --device cpu
  caustica bench scenes/caustics.toml --size 3840x2160 --photons 16777216 --json > mine.json
  caustica bench --device software --slice 50ms --slice none
  caustica bench --truth truth.exr --region caustic=290,425,425,485 --max-relMSE 0.0014 --max-relMSE caustic=0.0039";

fn slice(text: &str) -> Result<f64, String> {
    match text {
        "none" => Ok(f64::INFINITY),
        _ => duration(text)
            .map(|time| time.as_secs_f64())
            .map_err(|error| format!("{error}, or none")),
    }
}

/// Measures and prints.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let names = region_names(&arguments.truth.region)?;
    let bounds = arguments.truth.max_rel_mse.iter().chain(&arguments.truth.truth_noise);
    check_regions(bounds, &names)?;
    for bounds in [&arguments.truth.max_rel_mse, &arguments.truth.truth_noise] {
        check_single(bounds)?;
    }
    let (scene, settings) =
        in_force(load(arguments.scene.as_deref(), &arguments.overrides)?, &arguments.overrides)?;
    let truth = arguments.truth.truth.as_deref().map(read_truth).transpose()?;
    if let (Some(truth), Some(file)) = (&truth, &arguments.truth.truth) {
        check_truth(truth, file, &scene, &arguments.truth.region)?;
    }
    let devices = device::list();
    let mut chosen = Vec::new();
    for wanted in &arguments.device {
        let wanted = device::parse(wanted);
        let (device, _) = device::pick(&wanted, &devices)?;
        hidden::warn(&wanted);
        if !can_run(device, &settings) {
            return Err(Failure::wrong_use(
                &format!("{} does not support path tracing", device.name),
                "use --device cpu, or --method sppm",
            ));
        }
        chosen.push(device);
    }
    compiling::begin(false, arguments.json);
    let machine = Machine::this();
    if !arguments.json {
        result(heading(&scene, &settings, &machine))?;
    }
    let as_json = |reports: &[DeviceReport], complete: bool| {
        json!({
            "event": "bench",
            "version": env!("CARGO_PKG_VERSION"),
            "scene": scene.name,
            "width": scene.film.width,
            "height": scene.film.height,
            "settings": settings,
            "machine": machine,
            "devices": reports,
            "complete": complete,
        })
    };
    let stop = || interrupt::flag().load(Ordering::Relaxed);
    let mut complete = true;
    let mut reports = Vec::new();
    let of = chosen.len();
    for (done, device) in chosen.into_iter().enumerate() {
        if arguments.json {
            result(json!({ "event": "measuring", "device": device.name, "done": done, "of": of }))?;
        }
        let report = measure(device, &scene, &settings, truth.as_ref(), &arguments, &stop)?;
        if !arguments.json {
            result(device_text(&report))?;
        }
        reports.push(report);
        if stop() {
            complete = false;
            break;
        }
        // a signal need not wait for the next device to compile its kernels
        let figures = arguments.json.then(|| as_json(&reports, false));
        interrupt::last_words(move || {
            // a failure to write to standard output cannot be reported anywhere
            let _ = figures.map(result);
        });
    }
    if arguments.json {
        result(as_json(&reports, complete))?;
    }
    if !complete {
        message("interrupted; the figures cover the passes before the interrupt");
        return Ok(Done::Interrupted);
    }
    let missed = |a: &Approach| a.goal.is_some() && a.reached_seconds.is_none();
    let missed: Vec<&Approach> =
        reports.iter().flat_map(|r| &r.to_error).filter(|a| missed(a)).collect();
    for Approach { region, goal, .. } in &missed {
        let place = region.as_ref().map(|name| format!(" of {name}")).unwrap_or_default();
        message(format_args!("not reached: relMSE{place} {:.4e}", goal.unwrap_or_default()));
    }
    Ok(if missed.is_empty() { Done::Fully } else { Done::OverThreshold })
}

fn load(file: Option<&Path>, overrides: &Overrides) -> Result<Loaded, Failure> {
    match file {
        Some(file) => overrides.allowed.load(file),
        None => Ok(scene::parse("cornell.toml".as_ref(), CORNELL)?),
    }
}

fn measure(
    device: &DeviceInfo,
    scene: &Scene,
    settings: &RenderSettings,
    truth: Option<&Picture>,
    arguments: &Arguments,
    stop: &dyn Fn() -> bool,
) -> Result<DeviceReport, Failure> {
    let cached = std::env::var_os("MESA_SHADER_CACHE_DISABLE").is_none();
    if device.kind == DeviceKind::Software && cached {
        message(
            "note: Mesa caches compiled shaders; set MESA_SHADER_CACHE_DISABLE=true for cold \
             compile times",
        );
    }
    let wanted = arguments.overrides.pass_count();
    let conduct = Conduct {
        warm_up: arguments.warm_up,
        passes: wanted.unwrap_or(if arguments.time.is_some() { u32::MAX } else { PASSES }),
        time: arguments.time,
        slices: arguments.slice.clone(),
    };
    let mut report = device_report(device, scene, settings, &conduct, stop)?;
    if let Some(truth) = truth.filter(|_| !stop()) {
        let mut ready = setup::ready(device, scene, settings, Compiling::Together)?;
        if let (Some(gpu), Some(slice)) = (ready.runner.gpu(), arguments.slice.first()) {
            gpu.set_slice(*slice);
        }
        let limit = match (arguments.time, wanted) {
            (Some(time), _) => Limit { time, passes: u32::MAX },
            (None, Some(passes)) => Limit { time: Duration::MAX, passes },
            (None, None) => Limit { time: TO_ERROR, passes: u32::MAX },
        };
        report.to_error =
            approach(ready.runner.engine(), truth, &goals(&arguments.truth), limit, stop).map_err(
                |error| match error {
                    ToErrorError::Engine(error) => Failure::from(error),
                    ToErrorError::Metrics(error) => Failure::from(error),
                },
            )?;
    }
    Ok(report)
}

/// Goals of the whole image and of each region.
fn goals(truth: &Truth) -> Vec<Goal> {
    let of = |bounds: &[Bound], name: Option<&str>| {
        bounds.iter().find(|bound| bound.region.as_deref() == name).map(|bound| bound.limit)
    };
    let goal = |region: Option<&(String, Region)>| {
        let name = region.map(|(name, _)| name.as_str());
        Goal {
            region: region.cloned(),
            rel_mse: of(&truth.max_rel_mse, name),
            truth_noise: of(&truth.truth_noise, name).unwrap_or(0.0),
        }
    };
    std::iter::once(goal(None))
        .chain(truth.region.iter().map(|region| goal(Some(region))))
        .collect()
}

/// Fails if the image or a region has two bounds.
fn check_single(bounds: &[Bound]) -> Result<(), Failure> {
    let twice =
        bounds.iter().enumerate().find(|(i, b)| bounds[..*i].iter().any(|a| a.region == b.region));
    match twice {
        None => Ok(()),
        Some((_, bound)) => Err(Failure::wrong_use(
            &format!("{} has two values", bound.region.as_deref().unwrap_or("the whole image")),
            "give one value for the image and one for each region",
        )),
    }
}

fn read_truth(file: &Path) -> Result<Picture, Failure> {
    let (picture, coding) = read_any(file)?;
    match coding {
        Coding::Radiance => Ok(picture),
        Coding::Display => Err(Failure::wrong_use(
            &format!("{} contains display values, not radiance", file.display()),
            "use an .exr, .pfm or .hdr file",
        )),
    }
}

/// Checks before the measurement that the reference can be compared.
fn check_truth(
    truth: &Picture,
    file: &Path,
    scene: &Scene,
    regions: &[(String, Region)],
) -> Result<(), Failure> {
    let (width, height) = (scene.film.width, scene.film.height);
    if (truth.width, truth.height) != (width, height) {
        let error = MetricsError::Size { a: (width, height), b: (truth.width, truth.height) };
        let help = format!("the second is {}; --size changes the first", file.display());
        return Err(Failure::failed(miette!(help = help, "{error}")));
    }
    match regions.iter().find(|(_, region)| !region.fits(width, height)) {
        None => Ok(()),
        Some((name, region)) => Err(Failure::wrong_use(
            &format!("the region {name} ({region}) extends beyond the image"),
            &format!("the image has {width} columns and {height} rows, counted from 0"),
        )),
    }
}
