//! Checkpoints: what an engine holds, as a file, and as the program uses it.
//!
//! Theory: everything that a pass needs beside what is saved is made again from the scene, the
//! settings and the pass's number, with the same bits. So a render that goes on from a checkpoint,
//! on the CPU or on lavapipe, ends in the bits of one that never stopped; and where passes do not
//! need one another, ranges of them merge into all but for rounding.

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
use std::process::Command;
use std::sync::LazyLock;

use crate::support::{DISC, LAMP, Shape, ball, folder_with, words};
use caustica::low_level::checkpoint::{Checkpoint, Origin, Totals};
use caustica::low_level::device::{self, Opened, Wanted};
use caustica::low_level::engine::State;
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{self, Film, ToneMap};

/// With a mesh and a lens: two discs, maps of the lamp.
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

/// The wall behind it.
pub const MESH: &str = "v -2 0 -1.5\nv 2 0 -1.5\nv 0 2 -1.5\nf 1 2 3\n";

/// An empty folder with the scene in it.
pub fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE), ("wall.obj", MESH)])
}

/// The program with the words of `line`.
pub fn command(folder: &Path, line: &str) -> Command {
    crate::support::command(folder, &words(line))
}

/// Runs a command that must succeed; its standard output.
#[track_caller]
pub fn good(folder: &Path, line: &str) -> String {
    crate::support::good(folder, &words(line))
}

/// Runs a command that must fail with this code and these words.
#[track_caller]
pub fn fails(folder: &Path, line: &str, code: i32, told: &[&str]) {
    crate::support::fails(folder, &words(line), code, told);
}

/// An engine for the scene at `size`.
pub fn open(wanted: &Wanted, size: (u32, u32), change: impl Fn(&mut RenderSettings)) -> Opened {
    open_on(wanted, |film| (film.width, film.height) = size, change)
}

/// An engine for the scene on a film that is changed so.
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

/// A checkpoint of what an engine holds for a picture of this size.
pub fn checkpoint(opened: &Opened, size: (u32, u32), state: State) -> Checkpoint {
    checkpoint_on(opened, |film| (film.width, film.height) = size, state)
}

/// A checkpoint of what an engine holds for a film that is changed so.
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
