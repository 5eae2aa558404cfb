//! Scaling of cost: increases one quantity at a time, and fits the exponents of the seconds of each
//! kernel, of loading and of building.
//! `cargo run --release --example growth -- [--device cpu] [--axis pixels]... [--full]` prints a
//! table, which docs/performance.md explains.
//!
//! Seconds are processor times of all threads if the system reports them, so that other load on the
//! machine does not count, averaged over several passes. The exponent is fitted to the larger half
//! of the sizes, since fixed costs dominate the smaller ones.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use caustica::low_level::bench::setup;
use caustica::low_level::device;
use caustica::low_level::gpu::program::Compiling;
use caustica::low_level::scene::settings::{Radius, RenderSettings};
use caustica::low_level::scene::{self, Allowance};
use caustica::low_level::study::statistics::fit;

/// Minimum time in seconds over which passes are timed, since processor times have a resolution of
/// some milliseconds.
const WINDOW: f64 = 0.5;
/// Fraction of a pass below which a row is omitted.
const NOTICEABLE: f64 = 0.05;

/// A quantity to scale.
struct Axis {
    name: &'static str,
    sizes: Vec<f64>,
    /// Text of the scene file for a size; it may refer to `mesh.obj`.
    scene: fn(f64) -> String,
    mesh: Option<fn(f64) -> String>,
    settings: fn(f64, &mut RenderSettings),
}

fn axes(full: bool) -> Vec<Axis> {
    let decades = |last: i32| (0..=last).map(|k| 10f64.powi(k)).collect::<Vec<_>>();
    let doublings =
        |first: i32, last: i32| (first..=last).map(|k| 2f64.powi(k)).collect::<Vec<_>>();
    vec![
        Axis {
            name: "pixels",
            sizes: (6..=11).map(|k| 4f64.powi(k)).collect(),
            scene: |n| cornell(n.sqrt() as u32, 1, 0.75),
            mesh: None,
            settings: |_, s| (s.photons, s.radius) = (1 << 15, Radius::Units(0.02)),
        },
        Axis {
            name: "photons",
            sizes: doublings(14, 22),
            scene: |_| cornell(128, 1, 0.75),
            mesh: None,
            settings: |n, s| (s.photons, s.radius) = (n as u32, Radius::Units(0.02)),
        },
        Axis {
            name: "triangles",
            sizes: decades(if full { 7 } else { 6 }).split_off(3),
            scene: |_| cornell(256, 1, 0.75) + MESH,
            mesh: Some(displaced_sphere),
            settings: |_, s| (s.photons, s.radius) = (1 << 16, Radius::Units(0.02)),
        },
        Axis {
            name: "lights",
            sizes: decades(4),
            scene: |n| cornell(256, n as u32, 0.75),
            mesh: None,
            settings: |_, s| (s.photons, s.radius) = (1 << 16, Radius::Units(0.02)),
        },
        Axis {
            name: "bounces",
            sizes: doublings(0, 6),
            scene: |_| cornell(256, 1, 0.999),
            mesh: None,
            settings: |n, s| {
                s.max_bounces = n as u32;
                (s.photons, s.radius) = (1 << 14, Radius::Units(0.01));
            },
        },
        Axis {
            name: "radius",
            sizes: doublings(0, 5).iter().map(|k| 0.005 * k).collect(),
            scene: |_| cornell(128, 1, 0.75),
            mesh: None,
            settings: |n, s| (s.photons, s.radius) = (1 << 17, Radius::Units(n)),
        },
    ]
}

const MESH: &str = r#"
[[shapes]]
type = "mesh"
file = "mesh.obj"
smooth = false
material = "white"
transform = { scale = 0.4, translate = [0.0, 0.6, 0.0] }
"#;

/// Scene text of a closed box of gray walls around the camera, lit by point lights below its
/// ceiling, with an image of `side` x `side` pixels.
fn cornell(side: u32, lights: u32, grey: f64) -> String {
    let mut text = format!(
        "version = 1\n[camera]\nposition = [0.0, 1.0, 4.0]\ntarget = [0.0, 1.0, 0.0]\nfov = 39.0\n\
         [film]\nwidth = {side}\nheight = {side}\n[materials.white]\ntype = \"diffuse\"\n\
         reflectance = {grey}\n"
    );
    let walls = [
        ([-1, 0, 5], [2, 0, 0], [0, 0, -6]),
        ([-1, 2, -1], [2, 0, 0], [0, 0, 6]),
        ([-1, 0, -1], [2, 0, 0], [0, 2, 0]),
        ([-1, 0, 5], [0, 0, -6], [0, 2, 0]),
        ([1, 0, -1], [0, 0, 6], [0, 2, 0]),
        ([1, 0, 5], [-2, 0, 0], [0, 2, 0]),
    ];
    for (origin, u, v) in walls {
        let _ = write!(
            text,
            "[[shapes]]\ntype = \"rectangle\"\norigin = {origin:?}\nu = {u:?}\nv = {v:?}\n\
             material = \"white\"\n"
        );
    }
    let columns = f64::from(lights).sqrt().ceil() as u32;
    for i in 0..lights {
        let place = |k: u32| 1.6 * (f64::from(k) + 0.5) / f64::from(columns) - 0.8;
        let (x, z) = (place(i % columns), place(i / columns));
        let power = 3.0 / f64::from(lights);
        let _ = write!(
            text,
            "[[lights]]\ntype = \"point\"\nposition = [{x}, 1.9, {z}]\n\
             intensity = [{power}, {power}, {power}]\n"
        );
    }
    text
}

/// OBJ text with about `triangles` triangles on r = 1 + 0.1 sin 7u sin 9v.
fn displaced_sphere(triangles: f64) -> String {
    let rows = (triangles / 4.0).sqrt().ceil() as u32;
    let columns = 2 * rows;
    let mut text = String::new();
    for i in 0..=rows {
        for j in 0..columns {
            let v = std::f64::consts::PI * f64::from(i) / f64::from(rows);
            let u = std::f64::consts::TAU * f64::from(j) / f64::from(columns);
            let r = 1.0 + 0.1 * (7.0 * u).sin() * (9.0 * v).sin();
            let _ = writeln!(
                text,
                "v {} {} {}",
                r * v.sin() * u.cos(),
                r * v.cos(),
                r * v.sin() * u.sin()
            );
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let at = |i: u32, j: u32| i * columns + j % columns + 1;
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
            // triangles at the poles are degenerate
            if i > 0 {
                let _ = writeln!(text, "f {a} {b} {c}");
            }
            if i + 1 < rows {
                let _ = writeln!(text, "f {b} {d} {c}");
            }
        }
    }
    text
}

/// Processor seconds of all threads on Linux, otherwise wall-clock seconds since `begun`.
fn spent(begun: Instant) -> f64 {
    let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = threads.filter_map(|thread| {
        let text = fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<u64>().ok()
    });
    match nanoseconds.sum::<u64>() {
        0 => begun.elapsed().as_secs_f64(),
        sum => sum as f64 * 1e-9,
    }
}

/// Measures the seconds of loading, building and each kernel at one size.
fn measure(
    axis: &Axis,
    size: f64,
    device: &str,
    folder: &Path,
) -> Result<BTreeMap<String, f64>, Box<dyn Error>> {
    let file = folder.join("scene.toml");
    fs::write(&file, (axis.scene)(size))?;
    if let Some(mesh) = axis.mesh {
        fs::write(folder.join("mesh.obj"), mesh(size))?;
    }
    let begun = Instant::now();
    let before = spent(begun);
    // ten million triangles exceed the default limits
    let allowance =
        Allowance { mesh_triangles: 1 << 24, mesh_bytes: 4 << 30, ..Allowance::default() };
    let mut loaded = scene::load_within(&file, &allowance)?;
    let mut seconds = BTreeMap::from([("(load)".to_owned(), spent(begun) - before)]);
    (axis.settings)(size, &mut loaded.settings);
    let devices = device::list();
    let (device, _) = device::pick(&device::parse(device), &devices)?;
    let before = spent(begun);
    let packed = caustica::low_level::pilots::prepare(
        &loaded.scene,
        loaded.scene.film.width,
        loaded.scene.film.height,
    )?;
    seconds.insert("(build)".to_owned(), spent(begun) - before);
    drop(packed);
    let mut ready = setup::ready(device, &loaded.scene, &loaded.settings, Compiling::Together)?;
    ready.runner.engine().pass()?;
    let (wall, before) = (Instant::now(), spent(begun));
    let mut sums = BTreeMap::new();
    let mut passes = 0.0;
    while passes < 3.0 || wall.elapsed().as_secs_f64() < WINDOW {
        for (kernel, time) in ready.runner.engine().timed_pass()?.1 {
            *sums.entry(kernel.to_owned()).or_insert(0.0) += time;
        }
        passes += 1.0;
    }
    // ratio of processor time to wall-clock time
    let share = (spent(begun) - before) / wall.elapsed().as_secs_f64();
    seconds.extend(sums.into_iter().map(|(kernel, sum)| (kernel, sum * share / passes)));
    Ok(seconds)
}

fn run() -> Result<(), Box<dyn Error>> {
    let (mut device, mut chosen, mut full) = ("cpu".to_owned(), Vec::new(), false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--device" => device = arguments.next().ok_or("--device takes a device")?,
            "--axis" => chosen.push(arguments.next().ok_or("--axis takes a name")?),
            "--full" => full = true,
            other => {
                return Err(format!(
                    "unknown option {other}; the options are --device, --axis and --full"
                )
                .into());
            }
        }
    }
    let all = axes(full);
    if let Some(unknown) = chosen.iter().find(|name| all.iter().all(|axis| axis.name != **name)) {
        let names: Vec<_> = all.iter().map(|axis| axis.name).collect();
        return Err(format!("unknown axis {unknown}; the axes are {}", names.join(", ")).into());
    }
    let folder: PathBuf =
        std::env::temp_dir().join(format!("caustica-growth-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    println!("| quantity | from | to | stage | s at smallest | at largest | exponent | n log n |");
    println!("|---|---|---|---|---|---|---|---|");
    for axis in
        all.iter().filter(|axis| chosen.is_empty() || chosen.iter().any(|name| name == axis.name))
    {
        let mut series: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
        for &size in &axis.sizes {
            for (what, seconds) in measure(axis, size, &device, &folder)? {
                series.entry(what).or_default().push((size, seconds));
            }
        }
        let largest = |points: &Vec<(f64, f64)>| points[points.len() - 1].1;
        let of_the_pass = |what: &str| !what.starts_with('(');
        let pass: f64 =
            series.iter().filter(|(what, _)| of_the_pass(what)).map(|(_, p)| largest(p)).sum();
        for (what, points) in series {
            let (first, last) = (points[0], points[points.len() - 1]);
            if last.1 < NOTICEABLE * pass {
                continue;
            }
            let upper = &points[(points.len() - 1) / 2..];
            let Some(law) = fit(upper) else { continue };
            let (low, high) = (upper[0].0, last.0);
            // exponent of n log n between the same sizes; undefined below one item
            let bound = (low > 1.0).then(|| 1.0 + (high.ln() / low.ln()).ln() / (high / low).ln());
            println!(
                "| {} | {} | {} | {what} | {:.2e} | {:.2e} | {:.2} | {} |",
                axis.name,
                first.0,
                last.0,
                first.1,
                last.1,
                law.slope,
                bound.map_or("-".to_owned(), |bound| format!("{bound:.2}")),
            );
        }
    }
    fs::remove_dir_all(&folder)?;
    Ok(())
}

fn main() -> std::process::ExitCode {
    match run() {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            std::process::ExitCode::FAILURE
        }
    }
}
