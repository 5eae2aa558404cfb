//! Measures the error of single precision and prints the tables of docs/precision.md.
//!
//!     cargo run --release --example precision [-- SCENE.toml...]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use caustica::low_level::device::{self, Wanted};
use caustica::low_level::film::metrics::compare;
use caustica::low_level::film::{Picture, luminance};
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{self, Scene};

/// Image width in pixels.
const WIDTH: u32 = 160;
/// Passes per render.
const PASSES: u32 = 16;
/// Photons per pass.
const PHOTONS: u32 = 100_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut scenes: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if scenes.is_empty() {
        let names =
            ["caustics", "cornell", "depth-of-field", "soft-shadows", "still-life", "water-drop"];
        scenes = names.map(|name| Path::new("scenes").join(name).with_extension("toml")).into();
    }
    println!(
        "| scene | median pixel | means | RMS pixel | RMS noise | noise / cost | time f64 / f32 |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for path in scenes {
        scene_row(&path)?;
    }
    println!("\n| r / d | f32 | f64 |");
    println!("|--:|--:|--:|");
    for over in [30, 100, 300, 1000, 3000, 10_000] {
        lamp_row(f64::from(over))?;
    }
    Ok(())
}

fn render(
    wanted: &Wanted,
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<(Picture, Duration), Box<dyn Error>> {
    let mut engine = device::open(wanted, scene, settings)?.engine;
    let start = Instant::now();
    for _ in 0..settings.passes {
        engine.pass()?;
    }
    Ok((engine.picture()?, start.elapsed()))
}

/// Compares f32 and f64 with the same random numbers, and f32 with different ones to measure the
/// noise. RMS values are square roots of relMSE.
fn scene_row(path: &Path) -> Result<(), Box<dyn Error>> {
    let mut loaded = scene::load(path)?;
    let film = &mut loaded.scene.film;
    (film.width, film.height) = (WIDTH, WIDTH * film.height / film.width);
    let settings = RenderSettings { passes: PASSES, photons: PHOTONS, ..loaded.settings };
    let other = RenderSettings { seed: settings.seed + 1, ..settings.clone() };
    let (single, single_time) = render(&Wanted::Cpu, &loaded.scene, &settings)?;
    let (double, double_time) = render(&Wanted::CpuDouble, &loaded.scene, &settings)?;
    let (noisy, _) = render(&Wanted::Cpu, &loaded.scene, &other)?;
    let c = compare(&single, &double)?;
    let cost = c.rel_mse.sqrt();
    // the difference contains the noise of two images
    let noise = (0.5 * compare(&noisy, &single)?.rel_mse).sqrt();
    println!(
        "| {} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.0} | {:.2} |",
        path.file_stem().unwrap_or_default().display(),
        c.median,
        c.mean_error(),
        cost,
        noise,
        noise / cost,
        double_time.as_secs_f64() / single_time.as_secs_f64()
    );
    Ok(())
}

/// Ratio of the rendered to the analytic irradiance of a spherical lamp whose distance is `over`
/// times its radius.
fn lamp_row(over: f64) -> Result<(), Box<dyn Error>> {
    let distance = 9.0;
    let text = format!(
        r#"
        version = 1
        camera = {{ position = [0.0, 3.0, 0.01], target = [0.0, 0.0, 0.0], fov = 0.5 }}
        film = {{ width = 32, height = 32 }}
        materials.floor = {{ type = "diffuse", reflectance = 0.5 }}
        materials.black = {{ type = "diffuse", reflectance = 0.0 }}
        shapes = [
            {{ type = "rectangle", origin = [-1.0, 0.0, 1.0], u = [2.0, 0.0, 0.0], v = [0.0, 0.0, -2.0], material = "floor" }},
            {{ type = "sphere", center = [0.0, {distance:?}, 0.0], radius = {:?}, material = "black", emission = 1.0 }},
        ]"#,
        distance / over
    );
    let scene = scene::parse(Path::new("lamp.toml"), text.as_bytes())?.scene;
    let settings = RenderSettings { passes: PASSES, photons: 1, ..RenderSettings::default() };
    let ratio = |wanted: &Wanted| -> Result<f64, Box<dyn Error>> {
        let (picture, _) = render(wanted, &scene, &settings)?;
        let mean =
            picture.rgb.iter().map(|rgb| luminance(*rgb)).sum::<f64>() / picture.rgb.len() as f64;
        Ok(mean / (0.5 / (over * over)))
    };
    println!("| 1 / {over} | {:.6} | {:.6} |", ratio(&Wanted::Cpu)?, ratio(&Wanted::CpuDouble)?);
    Ok(())
}
