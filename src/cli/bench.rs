//! `caustica bench`: times and rates of devices, kernel by kernel, and time to error.

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

/// The scene where none is given.
const CORNELL: &[u8] = include_bytes!("../../scenes/cornell.toml");
/// Passes where neither they nor a time are given.
const PASSES: u32 = 10;
/// How long a run to a truth takes at most, where nothing is said.
const TO_ERROR: Duration = Duration::from_secs(60);

/// Measure devices: times and rates of the kernels, compile times, memory, time to error
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Arguments {
    /// Scene file [default: a Cornell box]
    scene: Option<PathBuf>,
    /// Device to measure, as for `render`; several are measured one after another
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_value = "auto")]
    device: Vec<String>,
    /// Begin no pass after this time, as in 30s; each run to a truth has the same time, and then no
    /// other limit [default: 60s for a run to a truth, unless --passes limits it]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time: Option<Duration>,
    /// Passes before those that count
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    warm_up: u32,
    /// Time that a submission to a GPU is to take, as in 50ms, or `none` for all in one; given
    /// several times, passes are measured with each, and the first one's count
    #[arg(long, value_name = "TIME|none", value_parser = slice, default_value = "50ms")]
    slice: Vec<f64>,
    /// Print one JSON object per line: what is measured, then all figures, times in seconds, memory
    /// in bytes
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    truth: Truth,
    #[command(flatten)]
    overrides: Overrides,
}

/// What a render is held against.
#[derive(clap::Args)]
#[command(next_help_heading = "Time to error")]
struct Truth {
    /// Picture that counts as the truth (.exr, .pfm, .hdr): tells relMSE over time
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Tell the error of a region too: columns x0 to x1 and rows y0 to y1 from the top left, x1 and
    /// y1 left out
    #[arg(long, value_name = "NAME=x0,y0,x1,y1", value_parser = region, requires = "truth")]
    region: Vec<(String, Region)>,
    /// relMSE to reach; exit with 3 where it is not
    #[arg(long = "max-relMSE", alias = "max-relmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true, requires = "truth")]
    max_rel_mse: Vec<Bound>,
    /// relMSE of the truth itself, by its noise, to take off
    #[arg(long, value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true, requires = "truth")]
    truth_noise: Vec<Bound>,
}

const HELP: &str = "\
Each round of a measurement is a pass whose kernels are timed, by the device's own clock where it has one, and a pass as \
it is for each --slice. docs/performance.md tells what the figures mean.

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
                &format!("path tracing does not run on {}", device.name),
                "take --device cpu, or --method sppm",
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
        // the next device compiles first, which a signal need not wait for
        let figures = arguments.json.then(|| as_json(&reports, false));
        interrupt::last_words(move || {
            // Standard output that takes nothing leaves nothing to do.
            let _ = figures.map(result);
        });
    }
    if arguments.json {
        result(as_json(&reports, complete))?;
    }
    if !complete {
        message("the figures are of the passes before the interrupt");
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
            "note: Mesa keeps compiled shaders; for cold compile times say MESA_SHADER_CACHE_DISABLE=true",
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

/// The whole picture and each region, with what was asked of them.
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

/// Fails where a place has two bounds.
fn check_single(bounds: &[Bound]) -> Result<(), Failure> {
    let twice =
        bounds.iter().enumerate().find(|(i, b)| bounds[..*i].iter().any(|a| a.region == b.region));
    match twice {
        None => Ok(()),
        Some((_, bound)) => Err(Failure::wrong_use(
            &format!("{} has two figures", bound.region.as_deref().unwrap_or("the whole picture")),
            "give one for each place",
        )),
    }
}

fn read_truth(file: &Path) -> Result<Picture, Failure> {
    let (picture, coding) = read_any(file)?;
    match coding {
        Coding::Radiance => Ok(picture),
        Coding::Display => Err(Failure::wrong_use(
            &format!("{} holds what a display shows, not radiance", file.display()),
            "take an .exr, .pfm or .hdr file",
        )),
    }
}

/// Finds before the measurement what the comparison would find after it.
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
            &format!("the region {name} ({region}) reaches beyond the picture"),
            &format!("the picture has {width} columns and {height} rows, counted from 0"),
        )),
    }
}
