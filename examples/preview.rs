//! Latency of the preview: time from a new scene, and from a camera rotation, to the small image
//! and to the first pass of the full image, on each device; medians of three. The full image has a
//! quarter of the scene's sides and a sixteenth of its photons, so that the startup time is not
//! hidden by the pass. `cargo run --release --example preview [SCENE...]`

use std::error::Error;
use std::sync::Arc;
use std::time::{Duration, Instant};

use caustica::low_level::device::Wanted;
use caustica::low_level::gpu::{AdapterChoice, GpuEngine};
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::preview::frame::RenderRequest;
use caustica::low_level::preview::orbit::orbit;
use caustica::low_level::preview::worker::Worker;
use caustica::low_level::scene;

const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() {
        files = ["cornell", "caustics", "still-life"]
            .map(|name| format!("scenes/{name}.toml"))
            .to_vec();
    }
    println!(
        "| scene | device | scene: small | scene: full | camera: small | camera: full |\n\
         |---|---|---|---|---|---|"
    );
    for file in &files {
        for device in [Wanted::Cpu, Wanted::Software] {
            let mut times = [const { Vec::new() }; 4];
            let begun = Instant::now();
            let loaded = scene::load(file.as_ref())?;
            let reading = begun.elapsed();
            let mut request = RenderRequest {
                camera: loaded.scene.camera,
                film: loaded.scene.film,
                settings: loaded.settings,
                device: device.clone(),
            };
            request.film.width /= 4;
            request.film.height /= 4;
            request.settings.photons /= 16;
            let scene = Arc::new(loaded.scene);
            let mut worker = Worker::start(|| ());
            for _ in 0..ROUNDS {
                let begun = Instant::now();
                let number = worker.scene(scene.clone(), request.clone());
                times[0].push(reading + until(&worker, number, false, begun)?);
                times[1].push(reading + until(&worker, number, true, begun)?);
                request.camera = orbit(&request.camera, 0.02, 0.0);
                let begun = Instant::now();
                let number = worker.change(request.clone());
                times[2].push(until(&worker, number, false, begun)?);
                times[3].push(until(&worker, number, true, begun)?);
            }
            let middle = times.map(|mut times| {
                times.sort();
                format!("{:.2} s", times[ROUNDS / 2].as_secs_f64())
            });
            println!("| {} | {device:?} | {} |", scene.name, middle.join(" | "));
        }
    }
    println!("\n| scene | packing | GPU engine: new | with existing programs |\n|---|---|---|---|");
    for file in &files {
        println!("| {file} | {} |", renewal(file)?);
    }
    Ok(())
}

/// Times to pack a scene, to create an engine on the software driver, and to recreate it.
fn renewal(file: &str) -> Result<String, Box<dyn Error>> {
    let loaded = scene::load(file.as_ref())?;
    let film = loaded.scene.film;
    let begun = Instant::now();
    let packed = prepare(&loaded.scene, film.width, film.height)?;
    let mut times = vec![begun.elapsed()];
    let plan = Plan::probed(&packed, &loaded.settings).on(&film);
    let begun = Instant::now();
    let engine = GpuEngine::new(&AdapterChoice::Software, &packed, plan.clone())?;
    times.push(begun.elapsed());
    let begun = Instant::now();
    engine.renewed(&packed, plan)?;
    times.push(begun.elapsed());
    let times = times.iter().map(|time| format!("{:.3} s", time.as_secs_f64()));
    Ok(times.collect::<Vec<_>>().join(" | "))
}

/// Time from `begun` until an image of request `number` is available: the first pass of the full
/// image if `whole`, otherwise any image.
fn until(
    worker: &Worker,
    number: u64,
    whole: bool,
    begun: Instant,
) -> Result<Duration, Box<dyn Error>> {
    loop {
        if worker.frame().is_some_and(|frame| frame.number == number && !(whole && frame.quick)) {
            return Ok(begun.elapsed());
        }
        if let Some(failure) = worker.slot().failure() {
            return Err(failure.into());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
