//! Checkpoints: an engine's state, its file format, and the options that use it.
//!
//! Theory: a pass depends only on the saved state, the scene, the settings and the pass number. So
//! a resumed render, on the CPU or on lavapipe, has the bits of an uninterrupted one. Where passes
//! do not depend on one another, ranges of passes merge up to rounding.

#[path = "../support/mod.rs"]
mod support;

mod engines;
mod files;
mod films;
#[cfg(unix)]
mod kills;
mod merging;
mod program;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::support::{DISC, LAMP, Shape, ball, folder_with, words};
use caustica::low_level::checkpoint::{Checkpoint, Origin, Totals};
use caustica::low_level::device::{self, Opened, Wanted};
use caustica::low_level::engine::State;
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{self, Film, ToneMap};

/// The test scene, with a mesh and a lens, so that it uses two gather discs and a guiding map of
/// the lamp.
pub static SCENE: LazyLock<String> = LazyLock::new(|| {
    let scene = ball((24, 16), "passes = 24\nphotons = 1500", &[DISC, WALL, LAMP]);
    scene.replace("fov = 40.0\n", "fov = 40.0\naperture = 0.05\nfocus = 5.0\n")
});

const WALL: Shape = r#"
[[shapes]]
type = "mesh"
file = "wall.obj"
material = "white"
"#;

/// The OBJ file of the wall behind the ball.
pub const MESH: &str = "v -2 0 -1.5\nv 2 0 -1.5\nv 0 2 -1.5\nf 1 2 3\n";

/// A fresh folder that contains the scene.
pub fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE), ("wall.obj", MESH)])
}

/// Runs a command that must succeed and returns its standard output.
#[track_caller]
pub fn good(folder: &Path, line: &str) -> String {
    support::good(folder, &words(line))
}

/// Runs a command that must fail with this code and these words.
#[track_caller]
pub fn fails(folder: &Path, line: &str, code: i32, reported: &[&str]) {
    support::fails(folder, &words(line), code, reported);
}

/// Opens an engine for the scene at `size`.
pub fn open(wanted: &Wanted, size: (u32, u32), change: impl Fn(&mut RenderSettings)) -> Opened {
    open_on(wanted, |film| (film.width, film.height) = size, change)
}

/// Opens an engine for the scene after `film` and `change` have edited its film and settings.
pub fn open_on(
    wanted: &Wanted,
    film: impl Fn(&mut Film),
    change: impl Fn(&mut RenderSettings),
) -> Opened {
    let mut loaded = scene::load(&folder_once().join("ball.toml")).unwrap();
    film(&mut loaded.scene.film);
    change(&mut loaded.settings);
    device::open(wanted, &loaded.scene, &loaded.settings)
        .unwrap_or_else(|e| panic!("{wanted:?}: {e}"))
}

fn folder_once() -> &'static Path {
    static FOLDER: std::sync::OnceLock<PathBuf> = std::sync::OnceLock::new();
    FOLDER.get_or_init(|| folder("library"))
}

/// Makes a checkpoint of an engine's state for an image of this size.
pub fn checkpoint(opened: &Opened, size: (u32, u32), state: State) -> Checkpoint {
    checkpoint_on(opened, |film| (film.width, film.height) = size, state)
}

/// Makes a checkpoint of an engine's state for a film that `film` has edited.
pub fn checkpoint_on(opened: &Opened, film: impl Fn(&mut Film), state: State) -> Checkpoint {
    let mut scene = scene::load(&folder_once().join("ball.toml")).unwrap().scene;
    (scene.film.exposure, scene.film.tonemap) = (0.5, ToneMap::Agx);
    film(&mut scene.film);
    Checkpoint {
        origin: Origin::of(opened, &scene, &SCENE),
        totals: Totals { photons: u64::MAX, radius: 0.1 + 0.2, ..Totals::default() },
        state,
        cuts: Vec::new(),
    }
}
