//! Checkpoints: what an engine holds, as a file, and as the program uses it.
//!
//! Theory: everything that a pass needs beside what is saved is made again from the scene, the settings and the pass's number, with
//! the same bits. So a render that goes on from a checkpoint, on the CPU or on lavapipe, ends in the bits of one that never
//! stopped; and where passes do not need one another, ranges of them merge into all but for rounding.

mod engines;
mod files;
#[cfg(unix)]
mod kills;
mod merging;
mod program;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use caustica::checkpoint::{Checkpoint, Origin, Totals};
use caustica::device::{self, Opened, Wanted};
use caustica::engine::State;
use caustica::scene;
use caustica::settings::RenderSettings;

/// A glass ball over a floor under a lamp, with a mesh: caustics, two discs, maps of the lamp.
pub const SCENE: &str = r#"
version = 1
[camera]
position = [0.0, 1.0, 5.0]
target = [0.0, 0.5, 0.0]
fov = 40.0
aperture = 0.05
focus = 5.0
[film]
width = 24
height = 16
[render]
passes = 24
photons = 1500
[materials.white]
type = "diffuse"
reflectance = 0.5
[materials.glass]
type = "glass"
ior = 1.5
[[shapes]]
type = "sphere"
center = [0.0, 0.7, 0.0]
radius = 0.5
material = "glass"
[[shapes]]
type = "disc"
center = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
radius = 3.0
material = "white"
[[shapes]]
type = "mesh"
file = "wall.obj"
material = "white"
[[shapes]]
type = "disc"
center = [0.0, 3.0, 1.0]
normal = [0.0, -1.0, 0.0]
radius = 0.3
material = "white"
emission = [20.0, 20.0, 20.0]
"#;

/// The wall behind it.
pub const MESH: &str = "v -2 0 -1.5\nv 2 0 -1.5\nv 0 2 -1.5\nf 1 2 3\n";

/// An empty folder with the scene in it.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("checkpoint").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("ball.toml"), SCENE).unwrap();
    fs::write(folder.join("wall.obj"), MESH).unwrap();
    folder
}

/// The program with the words of `line`.
pub fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    command.args(line.split_whitespace()).current_dir(folder).env("NO_COLOR", "1");
    command
}

/// Runs it.
pub fn caustica(folder: &Path, line: &str) -> Output {
    command(folder, line).output().unwrap()
}

/// Runs a command that must succeed; its standard output.
pub fn good(folder: &Path, line: &str) -> String {
    let output = caustica(folder, line);
    assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Output as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// An engine for the scene at `size`.
pub fn open(wanted: &Wanted, size: (u32, u32), change: impl Fn(&mut RenderSettings)) -> Opened {
    let file = folder_once().join("ball.toml");
    let mut loaded = scene::load(&file).unwrap();
    (loaded.scene.film.width, loaded.scene.film.height) = size;
    change(&mut loaded.settings);
    device::open(wanted, &loaded.scene, &loaded.settings).unwrap_or_else(|e| panic!("{wanted:?}: {e}"))
}

fn folder_once() -> &'static Path {
    static FOLDER: std::sync::OnceLock<PathBuf> = std::sync::OnceLock::new();
    FOLDER.get_or_init(|| folder("library"))
}

/// A checkpoint of what an engine holds.
pub fn checkpoint(opened: &Opened, size: (u32, u32), state: State) -> Checkpoint {
    Checkpoint {
        origin: Origin {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: "ball".into(),
            scene_text: SCENE.into(),
            identity: opened.identity.clone(),
            width: size.0,
            height: size.1,
            radiance_unit: opened.radiance_unit,
            settings: opened.settings.clone(),
            device: opened.name.clone(),
            exposure: 0.5,
            tonemap: scene::ToneMap::Agx,
        },
        totals: Totals { photons: u64::MAX, radius: 0.1 + 0.2, ..Totals::default() },
        state,
        parts: Vec::new(),
    }
}
