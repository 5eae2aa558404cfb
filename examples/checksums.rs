//! Checksums of images, to verify that a code change does not change any bit of them.
//!
//! `cargo run --release --example checksums -- [FILE.toml]...` renders the scenes of
//! `tests/engines/scenes.rs`, those in `scenes/` and the given files at a small size with few
//! photons, on the CPU in f32 and f64 and on the software driver. It prints one line per image:
//! device, xxh3 of the bits of radiance and layers, scene. Compare two outputs with `diff`.

#![allow(dead_code)] // the shared scene list has helpers for tests

use std::error::Error;
use std::path::PathBuf;

use caustica::low_level::device::{self, Wanted};
use caustica::low_level::scene::{self, Loaded};
use xxhash_rust::xxh3::Xxh3;

#[path = "../tests/engines/scenes.rs"]
mod scenes;

mod support {
    use std::path::PathBuf;

    /// Creates an empty folder for the files of scenes.
    pub fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("caustica-checksums-{name}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder for temporary files");
        folder
    }
}

const SIZE: (u32, u32) = (48, 36);
const PHOTONS: u32 = 6000;
const PASSES: u32 = 4;
const DEVICES: [(&str, Wanted); 3] =
    [("cpu", Wanted::Cpu), ("cpu-f64", Wanted::CpuDouble), ("software", Wanted::Software)];

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args_os().skip(1).map(PathBuf::from);
    let mut files: Vec<PathBuf> = std::fs::read_dir("scenes")?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    for (name, settings, rest) in scenes::SCENES {
        print(name, &scenes::loaded_at(SIZE, settings, rest))?;
    }
    for file in files.into_iter().chain(given) {
        let mut loaded = scene::load(&file)?;
        (loaded.scene.film.width, loaded.scene.film.height) = SIZE;
        loaded.settings.photons = PHOTONS;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        print(&name, &loaded)?;
        loaded.settings.method = caustica::low_level::scene::settings::Method::Path;
        print(&format!("{name} by path tracing"), &loaded)?;
    }
    Ok(())
}

/// Renders on each device that supports the method, and prints the checksums.
fn print(name: &str, loaded: &Loaded) -> Result<(), Box<dyn Error>> {
    for (device, wanted) in &DEVICES {
        if *device == "software"
            && loaded.settings.method == caustica::low_level::scene::settings::Method::Path
        {
            continue;
        }
        let mut engine = device::open(wanted, &loaded.scene, &loaded.settings)?.engine;
        for _ in 0..PASSES {
            engine.pass()?;
        }
        let (mut picture, mut layers) = (Xxh3::new(), Xxh3::new());
        for x in engine.picture()?.rgb.iter().flatten() {
            picture.update(&x.to_bits().to_le_bytes());
        }
        for layer in engine.layers()? {
            layer.plane.values.iter().for_each(|x| layers.update(&x.to_bits().to_le_bytes()));
        }
        println!("{device:8} {:016x} {:016x} {name}", picture.digest(), layers.digest());
    }
    Ok(())
}
