//! Compares stated errors with true errors, and prints a table.
//!
//!     cargo run --release --example promise [-- --only "cornell sppm" --seeds 20 --device cpu]
//!
//! The references of `cornell`, `drop` and `mesh` are in tests/data/truth. Those of other scenes,
//! and of a larger `drop`, are rendered first, as two independent images each, and stored in
//! target/promise. Exits with code 1 if the stated error bounds the true one in fewer than 90 % of
//! the renders of a row. docs/error-estimate.md explains the table.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use caustica::low_level::device::{self, Wanted};
use caustica::low_level::film::{self, Development, Picture, Provenance};
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::scene::{self, Scene};
use caustica::low_level::validation::{BlockTruth, NoisyTruth, Promise, promises};
use clap::Parser;

/// Compare stated errors with true errors
#[derive(Parser)]
struct Arguments {
    /// Device to render on: auto, gpu, software, cpu, cpu-f64, or part of a device name
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Only rows that contain this text, e.g. mesh or "cornell ppm"
    #[arg(long, value_name = "WORD", default_value = "")]
    only: String,
    /// Number of renders per row
    #[arg(long, default_value_t = 20)]
    seeds: u64,
}

/// Numbers of passes after which errors are compared.
const PASSES: [u32; 3] = [6, 16, 64];
/// Required fraction of renders whose stated error bounds the true one.
const PROMISED: f64 = 0.9;
/// Settings of each of the two renders of a reference: passes, photons per pass, start radius in
/// pixels.
const TRUTH: (u32, u32, f64) = (512, 131_072, 0.5);

/// Scenes and image sizes. `None` is the size of the reference in tests/data/truth; for other sizes
/// the reference is rendered. `drop` has both: in the smaller image of 1200 pixels, too few have a
/// glint for each render to contain one.
const SCENES: [(&str, Option<(u32, u32)>); 6] = [
    ("cornell", None),
    ("drop", None),
    ("drop", Some((160, 120))),
    ("mesh", None),
    ("caustics", Some((96, 63))),
    ("soft-shadows", Some((96, 60))),
];

/// Rows for each scene: label, settings, and whether scenes other than the first are rendered.
fn lines() -> Vec<(&'static str, RenderSettings, bool)> {
    let sppm = || RenderSettings { photons: 32_768, ..RenderSettings::default() };
    vec![
        ("sppm global", sppm(), true),
        ("sppm global photons", RenderSettings { direct: Direct::Photons, ..sppm() }, true),
        ("sppm local", RenderSettings { radius_rule: RadiusRule::Local, ..sppm() }, false),
        ("sppm fixed", RenderSettings { radius_rule: RadiusRule::Fixed, ..sppm() }, false),
        ("ppm global", RenderSettings { method: Method::Ppm, ..sppm() }, true),
        (
            "ppm local",
            RenderSettings { method: Method::Ppm, radius_rule: RadiusRule::Local, ..sppm() },
            false,
        ),
        ("path", RenderSettings { method: Method::Path, ..sppm() }, false),
    ]
}

fn main() -> ExitCode {
    match hold_all(&Arguments::parse()) {
        Ok(kept) => ExitCode::from(u8::from(!kept)),
        Err(error) => {
            eprintln!("promise: {error}");
            ExitCode::FAILURE
        }
    }
}

fn hold_all(arguments: &Arguments) -> Result<bool, Box<dyn Error>> {
    let wanted = device::parse(&arguments.device);
    println!(
        "{:20} {:20} {:>6} {:>8} {:>8} {:>8} {:>8} {:>13} {:>13} {:>9}",
        "scene",
        "render",
        "passes",
        "true %",
        "noise %",
        "bias %",
        "stated %",
        "estimate/true",
        "stated/true",
        "within"
    );
    let mut all = Vec::new();
    let mut kept = true;
    for (name, size) in SCENES {
        let of_scene = lines().into_iter().filter(|(line, _, everywhere)| {
            (*everywhere || name == "cornell") && format!("{name} {line}").contains(&arguments.only)
        });
        let mut loaded = None;
        for (line, settings, _) in of_scene {
            if loaded.is_none() {
                loaded = Some(scene_and_truth(&wanted, name, size)?);
            }
            let Some((scene, radius, truth)) = &loaded else { continue };
            let mut said = vec![Vec::new(); PASSES.len()];
            for seed in 0..arguments.seeds {
                let settings = RenderSettings { seed, radius: *radius, ..settings.clone() };
                let mut engine = device::open(&wanted, scene, &settings)?.engine;
                let heard = promises(engine.as_mut(), truth, &PASSES)?;
                said.iter_mut().zip(heard).for_each(|(list, promise)| list.push(promise));
            }
            for (passes, promises) in PASSES.iter().zip(said) {
                let film = format!("{name} {}x{}", scene.film.width, scene.film.height);
                kept &= print_line(&film, line, *passes, &promises);
                all.extend(promises);
            }
        }
    }
    println!(
        "within, in all: {} of {}",
        all.iter().filter(|promise| promise.kept()).count(),
        all.len()
    );
    Ok(kept)
}

fn print_line(scene: &str, line: &str, passes: u32, promises: &[Promise]) -> bool {
    let mean = |value: &dyn Fn(&Promise) -> f64| {
        promises.iter().map(value).sum::<f64>() / promises.len() as f64
    };
    let kept = promises.iter().filter(|promise| promise.kept()).count();
    let [truth, noise, bias, stated] = [
        mean(&|p| 100.0 * p.truth),
        mean(&|p| 100.0 * p.said.noise),
        mean(&|p| 100.0 * p.said.bias),
        mean(&|p| 100.0 * p.said.stated),
    ];
    println!(
        "{scene:20} {line:20} {passes:6} {truth:8.2} {noise:8.2} {bias:8.2} {stated:8.2} {:13.2} {:13.2} {:>9}",
        mean(&Promise::estimate_ratio),
        mean(&|p| p.said.stated / p.truth),
        format!("{kept}/{}", promises.len())
    );
    kept as f64 >= PROMISED * promises.len() as f64
}

/// Loads a scene with its film, the start radius of its file, and its reference.
fn scene_and_truth(
    wanted: &Wanted,
    name: &str,
    size: Option<(u32, u32)>,
) -> Result<(Scene, Radius, NoisyTruth), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = |folder| root.join(folder).join(name).with_extension("toml");
    let (shipped, reference) = (file("scenes"), file("tests/data/reference"));
    let mut loaded =
        scene::load(if size.is_some() && shipped.exists() { &shipped } else { &reference })?;
    let film = &mut loaded.scene.film;
    let truth = match size {
        None => {
            let truth =
                BlockTruth::read(&root.join("tests/data/truth").join(name).with_extension("exr"))?;
            (film.width, film.height) = (truth.mean.width, truth.mean.height);
            NoisyTruth::Blocks(truth)
        }
        Some(size) => {
            (film.width, film.height) = size;
            let half = |seed| truth_half(wanted, &loaded.scene, name, seed);
            NoisyTruth::Halves([half(1000)?, half(1001)?])
        }
    };
    Ok((loaded.scene, loaded.settings.radius, truth))
}

/// One of the renders of a reference, read from its file if it exists.
fn truth_half(
    wanted: &Wanted,
    scene: &Scene,
    name: &str,
    seed: u64,
) -> Result<Picture, Box<dyn Error>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/promise");
    std::fs::create_dir_all(&folder)?;
    let file = folder.join(format!("{name}-{seed}.exr"));
    if file.exists() {
        return Ok(film::read(&file)?);
    }
    let (passes, photons, pixels) = TRUTH;
    let settings = RenderSettings {
        passes,
        photons,
        radius: Radius::Pixels(pixels),
        seed,
        ..RenderSettings::default()
    };
    let opened = device::open(wanted, scene, &settings)?;
    let mut engine = opened.engine;
    for _ in 0..passes {
        engine.pass()?;
    }
    let picture = engine.picture()?;
    let provenance = Provenance {
        scene: name.to_owned(),
        scene_text: String::new(),
        settings,
        device: opened.name,
        first_pass: 0,
        passes_done: passes,
        ..Provenance::default()
    };
    film::write(&file, &picture, &[], &Development::default(), &provenance)?;
    Ok(picture)
}
