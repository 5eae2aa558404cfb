//! `caustica compare`: one scene rendered on two devices, and the difference of the images.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use caustica::low_level::device;
use caustica::low_level::film::metrics::{Comparison, compare};
use caustica::low_level::film::{Picture, blocks, file, heat};
use caustica::low_level::render::{Stop, render};
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;
use clap::builder::NonEmptyStringValueParser;
use serde_json::{Value, json};

use super::figures::comparison_json;
use super::output::{message, result};
use super::overrides::Overrides;
use super::render::{OutputArgs, begin, load};
use super::{Done, Failure, compiling, hidden};

/// Render a scene on two devices and compare the images
#[derive(clap::Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Device to test, then the reference device, as for `render`; give the option twice
    #[arg(long, value_name = "DEVICE", value_parser = NonEmptyStringValueParser::new(), default_values = ["auto", "cpu"])]
    device: Vec<String>,
    /// Difference image to write (.png)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Exit with code 3 if a channel's means differ by more than this fraction, e.g. 0.005
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true)]
    max_mean_ratio: Option<f64>,
    /// Exit with code 3 if relMSE exceeds this value
    #[arg(long, alias = "max-relMSE", value_name = "X", value_parser = share, allow_negative_numbers = true)]
    max_relmse: Option<f64>,
    /// Exit with code 3 if any bit differs
    #[arg(long)]
    bits: bool,
    #[command(flatten)]
    voice: OutputArgs,
    #[command(flatten)]
    overrides: Overrides,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("expected a number of zero or more".to_owned()),
    }
}

impl Arguments {
    /// Requested devices.
    pub fn devices(&self) -> &[String] {
        &self.device
    }
}

/// An image and the device that rendered it.
struct Rendered {
    device: String,
    picture: Picture,
}

/// Renders twice and compares.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let [first, second] = arguments.device.as_slice() else {
        return Err(Failure::wrong_use(
            &format!("compare takes two devices, not {}", arguments.device.len()),
            "give --device twice, e.g. --device gpu --device cpu",
        ));
    };
    if let Some(output) = &arguments.output {
        file::check_png(output)?;
    }
    let (scene, settings) = load(&arguments.scene, &arguments.overrides)?;
    // report a missing device before the first render
    let devices = device::list();
    for wanted in [first, second] {
        let wanted = device::parse(wanted);
        device::pick(&wanted, &devices)?;
        hidden::warn(&wanted);
    }
    compiling::begin(arguments.voice.quiet, arguments.voice.json);
    let a = render_on(first, &scene, &settings, &arguments.voice)?;
    let b = render_on(second, &scene, &settings, &arguments.voice)?;
    let comparison = compare(&a.picture, &b.picture)?;
    let outside =
        blocks::share_outside(&blocks::block_deviations(&a.picture, &b.picture, None, 0.0)?);
    if arguments.voice.json {
        result(as_json(&a.device, &b.device, &comparison, outside))?;
    } else {
        result(as_text(&a.device, &b.device, &comparison, outside))?;
    }
    if let Some(output) = &arguments.output {
        heat::write(output, &heat::heat_map(&a.picture, &b.picture)?)?;
        if !arguments.voice.json {
            result(output.display())?;
        }
    }
    let over = passed_thresholds(&arguments, &comparison);
    for threshold in &over {
        message(format_args!("over the threshold: {threshold}"));
    }
    Ok(if over.is_empty() { Done::Fully } else { Done::OverThreshold })
}

fn render_on(
    wanted: &str,
    scene: &Scene,
    settings: &RenderSettings,
    voice: &OutputArgs,
) -> Result<Rendered, Failure> {
    let opened = device::open(&device::parse(wanted), scene, settings)?;
    let mut reporter = begin(voice, scene, &opened)?;
    let stop = Stop { passes: settings.passes, time: None, target_error: None };
    let mut engine = opened.engine;
    let never = AtomicBool::new(false);
    let outcome = render(engine.as_mut(), stop, &never, &mut |progress| reporter.show(progress));
    reporter.finish();
    Ok(Rendered { device: opened.name, picture: outcome?.picture })
}

fn passed_thresholds(arguments: &Arguments, comparison: &Comparison) -> Vec<String> {
    let mut over = Vec::new();
    let mut hold = |name: &str, value: f64, most: Option<f64>| {
        // NaN exceeds every threshold
        if let Some(most) = most
            && (value.is_nan() || value > most)
        {
            over.push(format!("{name} {value:.3e}, at most {most:.3e}"));
        }
    };
    hold("difference of the means", comparison.mean_error(), arguments.max_mean_ratio);
    hold("relMSE", comparison.rel_mse, arguments.max_relmse);
    if arguments.bits && comparison.pixels_differing > 0 {
        over.push(format!("{} pixels differ, at most 0", comparison.pixels_differing));
    }
    over
}

fn as_text(a: &str, b: &str, comparison: &Comparison, outside: f64) -> String {
    let Comparison { mean_ratio: [red, green, blue], worst, .. } = comparison;
    [
        format!("a                     {a}"),
        format!("b                     {b}"),
        format!("mean ratio a/b        {red:.6} {green:.6} {blue:.6}"),
        format!("relMSE                {:.3e}", comparison.rel_mse),
        format!("median difference     {:.3e}", comparison.median),
        format!("RMSE                  {:.3e}", comparison.rmse),
        format!("PSNR                  {:.2} dB", comparison.psnr),
        format!("blocks over 4 sigma   {:.2} %", 100.0 * outside),
        format!("pixels that differ    {} of {}", comparison.pixels_differing, comparison.pixels),
        format!(
            "worst pixel           column {}, row {}: {:?} and {:?}",
            worst.x, worst.y, worst.a, worst.b
        ),
    ]
    .join("\n")
}

/// Metrics as a JSON object; infinite values are null.
fn as_json(a: &str, b: &str, comparison: &Comparison, outside: f64) -> Value {
    let mut figures = comparison_json(comparison);
    figures["event"] = json!("comparison");
    figures["a"] = json!(a);
    figures["b"] = json!(b);
    figures["blocks_outside"] = json!(outside);
    figures
}
