//! `caustica compare`: one scene on two devices, and how far the pictures are apart.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use caustica::device;
use caustica::film::metrics::{Comparison, compare};
use caustica::film::{FileError, Picture, blocks, file, heat};
use caustica::render::{Ending, Stop, render};
use caustica::scene::Scene;
use caustica::settings::RenderSettings;
use serde_json::json;

use super::overrides::Overrides;
use super::progress::Reporter;
use super::render::{Voice, load};
use super::{Done, Failure};

/// Render a scene on two devices and compare the pictures
#[derive(clap::Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// The device and the one that counts as the truth, as for `render`; give it twice
    #[arg(long, value_name = "DEVICE", default_values = ["auto", "cpu"])]
    device: Vec<String>,
    /// Picture of the difference to write (.png)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Exit with 3 where a channel's means differ by more than this share, as in 0.005
    #[arg(long, value_name = "SHARE", value_parser = share)]
    max_mean_ratio: Option<f64>,
    /// Exit with 3 where relMSE is more than this
    #[arg(long, value_name = "X", value_parser = share)]
    max_relmse: Option<f64>,
    /// Exit with 3 where a bit differs
    #[arg(long)]
    bits: bool,
    #[command(flatten)]
    overrides: Overrides,
    #[command(flatten)]
    voice: Voice,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("expected a number of zero or more".to_owned()),
    }
}

/// A picture and the device that made it.
struct Rendered {
    device: String,
    picture: Picture,
}

/// Renders twice and compares.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let [first, second] = arguments.device.as_slice() else {
        return Err(Failure::wrong_use(
            &format!("compare takes two devices, not {}", arguments.device.len()),
            "say --device twice, as in --device gpu --device cpu",
        ));
    };
    if let Some(output) = &arguments.output {
        check_difference_output(output)?;
    }
    let (scene, settings) = load(&arguments.scene, &arguments.overrides)?;
    let a = render_on(first, &scene, &settings, &arguments.voice)?;
    let b = render_on(second, &scene, &settings, &arguments.voice)?;
    let comparison = compare(&a.picture, &b.picture)?;
    let outside = blocks::share_outside(&blocks::block_deviations(&a.picture, &b.picture, None, 0.0)?);
    if arguments.voice.json {
        println!("{}", as_json(&a.device, &b.device, &comparison, outside));
    } else {
        print(&a.device, &b.device, &comparison, outside);
    }
    if let Some(output) = &arguments.output {
        heat::write(output, &heat::heat_map(&a.picture, &b.picture)?)?;
        if !arguments.voice.json {
            println!("{}", output.display());
        }
    }
    let over = passed_thresholds(&arguments, &comparison);
    for threshold in &over {
        eprintln!("over the threshold: {threshold}");
    }
    Ok(if over.is_empty() { Done::Fully } else { Done::OverThreshold })
}

fn check_difference_output(output: &std::path::Path) -> Result<(), FileError> {
    if file::Format::of(output) != Some(file::Format::Png) {
        return Err(FileError::UnknownFormat {
            file: output.to_owned(),
            what: "a picture of the difference is a PNG file".to_owned(),
            known: ".png",
        });
    }
    file::check_place(output)
}

fn render_on(wanted: &str, scene: &Scene, settings: &RenderSettings, voice: &Voice) -> Result<Rendered, Failure> {
    let opened = device::open(&device::parse(wanted), scene, settings)?;
    let mut reporter = Reporter::new(voice.quiet, voice.json);
    reporter.note(&format!("{}: {} ({})", scene.name, opened.name, opened.why));
    let stop = Stop { passes: settings.passes, time: None };
    let mut engine = opened.engine;
    let never = AtomicBool::new(false);
    let outcome = render(engine.as_mut(), stop, &never, &mut |progress| reporter.show(progress));
    reporter.finish();
    let outcome = outcome?;
    match outcome.ending {
        Ending::Failed(error) => Err(error.into()),
        Ending::Passes | Ending::Time | Ending::Interrupted => {
            Ok(Rendered { device: opened.name, picture: outcome.picture })
        }
    }
}

fn passed_thresholds(arguments: &Arguments, comparison: &Comparison) -> Vec<String> {
    let mut over = Vec::new();
    let mut hold = |name: &str, value: f64, most: Option<f64>| {
        // A value that is no number is over every threshold.
        if let Some(most) = most
            && (value.is_nan() || value > most)
        {
            over.push(format!("{name} {value:.3e}, at most {most:.3e}"));
        }
    };
    hold("difference of the means", comparison.mean_error(), arguments.max_mean_ratio);
    hold("relMSE", comparison.rel_mse, arguments.max_relmse);
    hold("pixels of other bits", comparison.pixels_differing as f64, arguments.bits.then_some(0.0));
    over
}

fn print(a: &str, b: &str, comparison: &Comparison, outside: f64) {
    let [r, g, blue] = comparison.mean_ratio;
    let worst = &comparison.worst;
    println!("a                     {a}");
    println!("b                     {b}");
    println!("mean ratio a/b        {r:.6} {g:.6} {blue:.6}");
    println!("relMSE                {:.3e}", comparison.rel_mse);
    println!("RMSE                  {:.3e}", comparison.rmse);
    println!("PSNR                  {:.2} dB", comparison.psnr);
    println!("blocks over 4 sigma   {:.2} %", 100.0 * outside);
    println!("pixels of other bits  {} of {}", comparison.pixels_differing, comparison.pixels);
    println!("worst pixel           column {}, row {}: {:?} and {:?}", worst.x, worst.y, worst.a, worst.b);
}

/// The figures as a JSON object; those that are infinite are null.
fn as_json(a: &str, b: &str, comparison: &Comparison, outside: f64) -> serde_json::Value {
    let worst = &comparison.worst;
    json!({
        "event": "comparison",
        "a": a,
        "b": b,
        "mean_ratio": comparison.mean_ratio,
        "rel_mse": comparison.rel_mse,
        "rmse": comparison.rmse,
        "psnr": comparison.psnr,
        "blocks_outside": outside,
        "pixels_differing": comparison.pixels_differing,
        "pixels": comparison.pixels,
        "worst": { "x": worst.x, "y": worst.y, "a": worst.a, "b": worst.b },
    })
}
