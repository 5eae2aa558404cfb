//! Compares renders of the reference scenes with images of other renderers, and prints a table.
//!
//!     cargo run --release --example hold [-- --device cpu --full --only mesh]
//!     cargo run --release --example hold -- --make-truth FULL.exr tests/data/truth/NAME.exr \
//!         [--relmse 3.3e-4]
//!
//! Exits with code 1 if a render disagrees. docs/truth.md explains the table.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use caustica::low_level::device;
use caustica::low_level::film::{Development, Picture, Provenance, file};
use caustica::low_level::scene;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::validation::agreement::{
    CHANCE, LIMIT, LIMIT_FAR, MEAN_ERRORS, MEAN_LIMIT, REGION,
};
use caustica::low_level::validation::reference::{BLOCK, PixelNoise};
use caustica::low_level::validation::{Agreement, BlockTruth, hold, render_parts};
use clap::Parser;

/// Compare renders of the reference scenes with reference images
#[derive(Parser)]
struct Arguments {
    /// Device to render on: auto, gpu, software, cpu, cpu-f64, or part of a device name
    #[arg(long, default_value = "auto")]
    device: String,
    /// Render four times as many passes
    #[arg(long)]
    full: bool,
    /// Only rows that contain this text, e.g. mesh or "ppm global"
    #[arg(long, value_name = "WORD", default_value = "")]
    only: String,
    /// Folder for images of each row's deviations (.pfm, one pixel per block)
    #[arg(long, value_name = "FOLDER")]
    maps: Option<PathBuf>,
    /// Only convert the image FULL.exr to the block reference OUT.exr
    #[arg(long, num_args = 2, value_names = ["FULL.exr", "OUT.exr"])]
    make_truth: Option<Vec<PathBuf>>,
    /// With --make-truth: relMSE of an image without standard errors
    #[arg(long, value_name = "E", requires = "make_truth")]
    relmse: Option<f64>,
}

/// Names of scenes in tests/data/reference and of references in tests/data/truth. For variants,
/// whose names have a hyphen, only the first two rows are rendered.
const SCENES: [&str; 5] = ["cornell", "drop", "drop-clear", "mesh", "mesh-turned"];
/// Number of independent renders per row.
const RENDERS: u32 = 16;
/// Number of passes per render; eight times as many for path tracing.
const PASSES: u32 = 2;
/// Allowed relative bias of density estimation.
const BIAS: f64 = 0.01;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match &arguments.make_truth {
        Some(files) => make_truth(&files[0], &files[1], arguments.relmse).map(|()| true),
        None => hold_all(&arguments),
    };
    match done {
        Ok(agrees) => ExitCode::from(u8::from(!agrees)),
        Err(error) => {
            eprintln!("hold: {error}");
            ExitCode::FAILURE
        }
    }
}

fn make_truth(full: &Path, out: &Path, relmse: Option<f64>) -> Result<(), Box<dyn Error>> {
    let exr = file::read_exr(full)?;
    let picture = exr.picture("").ok_or("channels R, G and B are missing")?;
    let noise = match (exr.picture("SE."), relmse) {
        (_, Some(e)) => PixelNoise::RelMse(e),
        (Some(errors), None) => PixelNoise::Known(errors),
        (None, None) => {
            return Err("channels SE.R, SE.G and SE.B are missing; use --relmse".into());
        }
    };
    let truth = BlockTruth::from_picture(&picture, &noise)
        .ok_or_else(|| format!("the image size is not a multiple of {BLOCK} pixels"))?;
    Ok(truth.write(out)?)
}

/// Rows of the table: label, settings and allowed relative bias.
fn lines() -> Vec<(String, RenderSettings, f64)> {
    let mut lines = Vec::new();
    let path =
        RenderSettings { method: Method::Path, passes: 8 * PASSES, ..RenderSettings::default() };
    lines.push(("path".to_owned(), path, 0.0));
    lines.push((
        "sppm default".to_owned(),
        RenderSettings { passes: PASSES, ..RenderSettings::default() },
        BIAS,
    ));
    for (method, name) in [(Method::Sppm, "sppm"), (Method::Ppm, "ppm")] {
        for (radius_rule, rule, pixels) in [
            (RadiusRule::Global, "global", 1.0),
            (RadiusRule::Local, "local", 1.0),
            (RadiusRule::Fixed, "fixed", 0.5),
        ] {
            for (direct, light) in [(Direct::Sampled, "sampled"), (Direct::Photons, "photons")] {
                let radius = Radius::Pixels(pixels);
                let settings = RenderSettings {
                    method,
                    radius_rule,
                    direct,
                    radius,
                    passes: PASSES,
                    ..RenderSettings::default()
                };
                lines.push((format!("{name} {rule} {light}"), settings, BIAS));
            }
        }
    }
    lines
}

fn hold_all(arguments: &Arguments) -> Result<bool, Box<dyn Error>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let wanted = device::parse(&arguments.device);
    println!(
        "{:10} {:20} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>13} {:>6} {:>9} {:>6}",
        "scene",
        "render",
        "R",
        "G",
        "B",
        "+- %",
        "truth %",
        "relMSE",
        "outside",
        "worst",
        "regions",
        "s"
    );
    let mut agrees = true;
    for name in SCENES {
        let scene = scene::load(&data.join(format!("reference/{name}.toml")))?.scene;
        let truth = BlockTruth::read(&data.join(format!("truth/{name}.exr")))?;
        for (line, mut settings, bias) in lines() {
            let variant = name.contains('-') && !["path", "sppm default"].contains(&line.as_str());
            if variant || !format!("{name} {line}").contains(&arguments.only) {
                continue;
            }
            settings.passes *= if arguments.full { 4 } else { 1 };
            let start = Instant::now();
            let size = (truth.mean.width, truth.mean.height);
            let rendered = render_parts(&wanted, &scene, &settings, RENDERS, size)?;
            let agreement = hold(&rendered.parts, &truth, bias);
            print_line(name, &line, &agreement, start.elapsed().as_secs_f64());
            agrees &= agreement.faults().is_empty();
            if let Some(folder) = &arguments.maps {
                let map = folder.join(format!("{name} {line}.pfm").replace(' ', "-"));
                write_map(&map, &agreement, size, &settings)?;
            }
        }
    }
    println!(
        "outside: blocks beyond {LIMIT} sigma, and the allowed number (exceeded by chance in {} % \
         of renders that agree); no block may be beyond {LIMIT_FAR} sigma.\n\
         regions: the same for regions of {REGION} x {REGION} blocks.\n\
         mean: within {} % plus {MEAN_ERRORS} combined standard errors of the render (+-) and the \
         truth.",
        100.0 * CHANCE,
        100.0 * MEAN_LIMIT,
    );
    Ok(agrees)
}

fn print_line(scene: &str, line: &str, a: &Agreement, seconds: f64) {
    let percent = |e: [f64; 3]| 100.0 * e[0].max(e[1]).max(e[2]);
    let [r, g, b] = a.mean_ratio;
    let outside =
        format!("{}/{} <= {}", a.blocks.outside(), a.blocks.values.len(), a.blocks.allowed);
    let regions = format!("{} <= {}", a.regions.outside(), a.regions.allowed);
    let faults = a.faults();
    let verdict = if faults.is_empty() {
        "agrees".to_owned()
    } else {
        format!("FAILS: {}", faults.join(", "))
    };
    println!(
        "{scene:10} {line:20} {r:8.4} {g:8.4} {b:8.4} {:8.3} {:8.3} {:9.2e} {outside:>13} {:6.1} {regions:>9} {seconds:6.1} {verdict}",
        percent(a.ratio_error),
        percent(a.truth_error),
        a.rel_mse,
        a.blocks.worst(),
    );
}

fn write_map(
    path: &Path,
    agreement: &Agreement,
    (width, height): (u32, u32),
    settings: &RenderSettings,
) -> Result<(), Box<dyn Error>> {
    let map = Picture::from_fn(width, height, |x, y| {
        [agreement.blocks.values[(y * width + x) as usize] as f32; 3]
    });
    let provenance = Provenance {
        scene: String::new(),
        scene_text: String::new(),
        settings: settings.clone(),
        device: String::new(),
        first_pass: 0,
        passes_done: settings.passes,
        ..Provenance::default()
    };
    Ok(file::write(path, &map, &[], &Development::default(), &provenance)?)
}
