//! Renders a scene with independent seeds and compares means per region with theory or with one
//! another.
//!
//! With K runs a region's mean m and standard error s satisfy |m - truth| <= T s with probability
//! 1 - 1e-4 (Student's t with K - 1 degrees of freedom). A comparison also plants an error of
//! stated size in the truth and fails unless the same test would reject it: a test too noisy to
//! find such an error is not accepted.

use std::path::PathBuf;

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::device;
use caustica::low_level::engine::Engine;
use caustica::low_level::film::Picture;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::scene::{self, Scene};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Independent runs of every comparison.
pub const RUNS: u64 = 20;
/// Two-sided quantile of Student's t with RUNS - 1 degrees of freedom at 1e-4.
const T: f64 = 4.897;

/// A pinhole camera, y up, with a square image.
#[derive(Clone, Copy)]
pub struct Camera {
    pub position: DVec3,
    pub target: DVec3,
    /// Vertical field of view, degrees.
    pub fov: f64,
    /// Pixels per row and per column.
    pub size: u32,
}

impl Camera {
    /// The head of a scene file.
    pub fn toml(&self) -> String {
        format!(
            "version = 1\n[camera]\nposition = {}\ntarget = {}\nfov = {}\n[film]\nwidth = {}\n\
             height = {}\n",
            list(self.position),
            list(self.target),
            self.fov,
            self.size,
            self.size
        )
    }

    /// Direction through the image at (x, y) in [0, 1]^2, row 0 on top; not normalised.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        let forward = (self.target - self.position).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let tan = (0.5 * self.fov).to_radians().tan();
        forward + right * tan * (2.0 * at.x - 1.0) + up * tan * (1.0 - 2.0 * at.y)
    }

    /// The point of the plane y = 0 at (x, y) of the image.
    pub fn on_floor(&self, at: DVec2) -> DVec3 {
        let d = self.direction(at);
        self.position - d * (self.position.y / d.y)
    }

    /// The expected image of a floor y = 0 with radiance `f`, gathered from discs of radius `r`:
    /// the mean over each pixel (2x2 Gauss points in each of its quarters) and over the disc (8
    /// points on each of three rings of equal area, rotated against one another). Both are exact
    /// for quadratics; folds of caustics, where f is infinite, need that many.
    pub fn floor_picture(&self, r: f64, f: impl Fn(DVec3) -> f64 + Sync) -> Vec<f64> {
        let n = self.size;
        let offset = |k: usize| {
            let (ring, turn) = (k as f64 / 8.0, k as f64 + (k / 8) as f64 / 3.0);
            let (sin, cos) = (turn * std::f64::consts::FRAC_PI_4).sin_cos();
            DVec3::new(cos, 0.0, sin) * r * ((ring.floor() + 0.5) / 3.0).sqrt()
        };
        let offsets: Vec<DVec3> =
            if r > 0.0 { (0..24).map(offset).collect() } else { vec![DVec3::ZERO] };
        let gauss = |k: usize| {
            0.5 * (k / 2) as f64
                + if k.is_multiple_of(2) {
                    0.25 - 0.25 / 3f64.sqrt()
                } else {
                    0.25 + 0.25 / 3f64.sqrt()
                }
        };
        let point = |i: u32, k: usize| {
            let pixel = DVec2::new((i % n) as f64, (i / n) as f64);
            self.on_floor((pixel + DVec2::new(gauss(k % 4), gauss(k / 4))) / n as f64)
        };
        let disc = |p: DVec3| offsets.iter().map(|o| f(p + *o)).sum::<f64>() / offsets.len() as f64;
        (0..n * n)
            .into_par_iter()
            .map(|i| (0..16).map(|k| disc(point(i, k))).sum::<f64>() / 16.0)
            .collect()
    }
}

/// `v` as TOML and JSON write it.
pub fn list(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// The default settings of all tests: photon mapping in a few passes, radius in scene units.
pub fn settings(radius: f64) -> RenderSettings {
    RenderSettings {
        passes: 4,
        photons: 1 << 15,
        radius: Radius::Units(radius),
        radius_rule: RadiusRule::Fixed,
        max_bounces: 64,
        ..RenderSettings::default()
    }
}

/// Both ways of finding direct light.
pub const DIRECT: [Direct; 2] = [Direct::Sampled, Direct::Photons];

/// A folder for generated files.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
}

/// Parses the scene `text`; its files are relative to [`folder`].
pub fn parse(text: &str) -> Scene {
    match scene::parse(&folder().join("scene.toml"), text.as_bytes()) {
        Ok(loaded) => loaded.scene,
        Err(errors) => panic!("{errors:?}\n{text}"),
    }
}

/// Renders one run. The path tracer runs on the CPU, everything else on the chosen device.
pub fn render(scene: &Scene, settings: &RenderSettings) -> Picture {
    snapshots(scene, settings, &[settings.passes]).remove(0)
}

/// The image of one run after each of these numbers of passes, in increasing order.
pub fn snapshots(scene: &Scene, settings: &RenderSettings, passes: &[u32]) -> Vec<Picture> {
    Prepared::new(scene, settings).snapshots(settings, passes)
}

/// A scene that is ready to be rendered. Preparation takes longer than a few passes of a small
/// image. It does not depend on the seed or on the number of passes, so runs share it.
pub struct Prepared<'s> {
    scene: &'s Scene,
    device: String,
    cpu: Option<(PackedScene, Plan)>,
}

impl<'s> Prepared<'s> {
    /// Prepares the scene for renders whose settings are `settings` but for seed and passes.
    pub fn new(scene: &'s Scene, settings: &RenderSettings) -> Self {
        let device = std::env::var("CAUSTICA_DEVICE").unwrap_or_else(|_| "cpu".into());
        let cpu = (settings.method == Method::Path || device == "cpu").then(|| {
            let packed = prepare(scene, scene.film.width, scene.film.height)
                .unwrap_or_else(|e| panic!("{e}"));
            let plan = Plan::probed(&packed, settings);
            (packed, plan)
        });
        Self { scene, device, cpu }
    }

    /// As the function [`snapshots`].
    pub fn snapshots(&self, settings: &RenderSettings, passes: &[u32]) -> Vec<Picture> {
        let mut engine: Box<dyn Engine> = match &self.cpu {
            Some((packed, plan)) => {
                let mut plan = plan.clone();
                (plan.settings.seed, plan.settings.passes) = (settings.seed, settings.passes);
                Box::new(CpuEngine::new(packed.clone(), plan))
            }
            None => {
                device::open(&device::parse(&self.device), self.scene, settings)
                    .unwrap_or_else(|e| panic!("{e}"))
                    .engine
            }
        };
        let mut done = 0;
        let mut snapshot = |until: &u32| {
            while done < *until {
                engine.pass().unwrap();
                done += 1;
            }
            let picture = engine.picture().unwrap();
            assert_eq!(picture.not_finite(), 0, "NaN or infinity in the picture");
            picture
        };
        passes.iter().map(&mut snapshot).collect()
    }

    /// [`RUNS`] runs.
    pub fn runs(&self, settings: &RenderSettings) -> Runs {
        let run = |seed| {
            let settings = RenderSettings { seed: settings.seed + seed, ..settings.clone() };
            grey(&self.snapshots(&settings, &[settings.passes])[0])
        };
        Runs { size: self.scene.film.width, pixels: (0..RUNS).map(run).collect() }
    }
}

/// Grey pixels of [`RUNS`] runs.
pub struct Runs {
    pub size: u32,
    pub pixels: Vec<Vec<f64>>,
}

/// Renders `text` [`RUNS`] times. A pilot of `settings.passes` passes with other seeds determines
/// how many passes are needed to know the whole image's mean to `power`; more follow if that was
/// too few.
pub fn runs_to(power: f64, text: &str, settings: &RenderSettings) -> Runs {
    let reached = |runs: &Runs| {
        let Estimate { mean, error } = runs.region(|_, _| true);
        T * error / ((power - ARITHMETIC) * mean)
    };
    let scene = parse(text);
    let prepared = Prepared::new(&scene, settings);
    let with = |passes: f64, seed| {
        let passes = (passes.ceil() as u32).clamp(settings.passes, 256 * settings.passes);
        (passes as f64, prepared.runs(&RenderSettings { passes, seed, ..settings.clone() }))
    };
    let (mut passes, mut runs) = with(settings.passes as f64, settings.seed + 1000);
    for _ in 0..3 {
        (passes, runs) = with(passes * (reached(&runs) / 0.65).powi(2), settings.seed);
        if reached(&runs) < 0.95 {
            break;
        }
    }
    runs
}

/// Renders `text` [`RUNS`] times.
pub fn runs(text: &str, settings: &RenderSettings) -> Runs {
    let scene = parse(text);
    Prepared::new(&scene, settings).runs(settings)
}

/// The mean of the three channels of every pixel.
pub fn grey(picture: &Picture) -> Vec<f64> {
    picture.rgb.iter().map(|c| c.iter().map(|&x| x as f64).sum::<f64>() / 3.0).collect()
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

impl Estimate {
    /// The estimate from independent values.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Self { mean, error: (variance / n).sqrt() }
    }

    /// Whether the t-test accepts `truth`; `slack` is a known numerical error of the truth or the
    /// arithmetic.
    pub fn admits(&self, truth: f64, slack: f64) -> bool {
        (self.mean - truth).abs() <= T * self.error + slack * truth.abs()
    }
}

/// Relative error of f32 sums and 16-bit directions, which no test can resolve.
const ARITHMETIC: f64 = 2e-4;

impl Runs {
    /// The mean over the pixels for which `inside` holds.
    pub fn region(&self, inside: impl Fn(u32, u32) -> bool) -> Estimate {
        let means: Vec<f64> =
            self.pixels.iter().map(|p| region_mean(p, self.size, &inside)).collect();
        Estimate::of(&means)
    }

    /// Checks that the whole image and each of its quarters agree with `truth`, and would not with
    /// one that is off by `power` (whole) or four times that (quarters). `what` names the case.
    pub fn assert_picture(&self, what: &str, truth: &[f64], power: f64) {
        let n = self.size;
        assert_agrees(what, self.region(|_, _| true), region_mean(truth, n, &|_, _| true), power);
        for quarter in 0..4 {
            let inside = |x: u32, y: u32| (2 * x / n) + 2 * (2 * y / n) == quarter;
            let name = format!("{what}, quarter {quarter}");
            assert_agrees(&name, self.region(inside), region_mean(truth, n, &inside), 4.0 * power);
        }
    }
}

fn region_mean(pixels: &[f64], size: u32, inside: &impl Fn(u32, u32) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (i, p) in pixels.iter().enumerate() {
        if inside(i as u32 % size, i as u32 / size) {
            sum += p;
            count += 1;
        }
    }
    sum / count as f64
}

/// Checks that `found` agrees with `truth`, and would not if the truth were off by the share
/// `power`.
pub fn assert_agrees(what: &str, found: Estimate, truth: f64, power: f64) {
    let Estimate { mean, error } = found;
    let report = format!(
        "{what}: {mean:.6} +- {error:.6}, theory {truth:.6}: off by {:+.3} % ({:+.1} sigma)",
        100.0 * (mean / truth - 1.0),
        (mean - truth) / error
    );
    println!("{report}");
    assert!(found.admits(truth, ARITHMETIC), "{report}");
    for planted in [truth * (1.0 + power), truth * (1.0 - power)] {
        let centred = Estimate { mean: truth, error };
        assert!(
            !centred.admits(planted, ARITHMETIC),
            "{report}: too noisy to find an error of {power}"
        );
    }
}

/// Checks that two estimates of one number agree, and would not if one were off by the share
/// `power`.
pub fn assert_same(what: &str, a: Estimate, b: Estimate, power: f64) {
    let difference = Estimate { mean: a.mean - b.mean, error: a.error.hypot(b.error) };
    let scale = 0.5 * (a.mean + b.mean).abs();
    let sigma = difference.mean / difference.error;
    let report = format!(
        "{what}: {:.6} and {:.6}, off by {:+.3} % ({sigma:+.1} sigma)",
        a.mean,
        b.mean,
        100.0 * difference.mean / scale
    );
    println!("{report}");
    let bound = T * difference.error + ARITHMETIC * scale;
    assert!(difference.mean.abs() <= bound, "{report}");
    assert!(power * scale > bound, "{report}: too noisy to find an error of {power}");
}

/// Writes a file to [`folder`], once per name.
pub fn file(name: &str, bytes: &[u8]) -> String {
    let path = folder().join(name);
    // tests run in parallel, so the rename publishes a complete file
    let neighbor = path.with_extension(format!("{:?}.part", std::thread::current().id()));
    std::fs::write(&neighbor, bytes).unwrap();
    std::fs::rename(&neighbor, &path).unwrap();
    name.to_owned()
}

/// Checks that two sets of runs agree over the whole image (and would not if one were off by twice
/// `power`) and in each of 4x4 tiles, of which at least half would detect an error of eight times
/// `power`.
pub fn assert_regions(what: &str, a: &Runs, b: &Runs, power: f64) {
    let n = a.size;
    assert_same(what, a.region(|_, _| true), b.region(|_, _| true), 2.0 * power);
    let mut sharp = 0;
    for tile in 0..16 {
        let inside = |x: u32, y: u32| (4 * x / n) + 4 * (4 * y / n) == tile;
        let (a, b) = (a.region(inside), b.region(inside));
        assert_same(&format!("{what}, tile {tile}"), a, b, f64::INFINITY);
        sharp += (T * a.error.hypot(b.error) < 8.0 * power * a.mean) as u32;
    }
    assert!(sharp >= 8, "{what}: only {sharp} tiles would show an error");
}
