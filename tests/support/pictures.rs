//! Images: their bits, how to write them, and how to render them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use caustica::low_level::device::{self, Wanted};
use caustica::low_level::engine::Engine;
use caustica::low_level::film::{Picture, exr_file};
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{Scene, SceneErrors};

/// The bits of every pixel.
pub fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture.rgb.iter().map(|rgb| rgb.map(f32::to_bits)).collect()
}

/// The bytes of an EXR file without layers and attributes.
pub fn exr_bytes(picture: &Picture) -> Vec<u8> {
    exr_file::encode(picture, exr_file::Frame::of(picture), &[], &BTreeMap::new()).unwrap()
}

/// Writes an EXR file without layers and attributes.
pub fn write_exr(file: &Path, picture: &Picture) {
    fs::write(file, exr_bytes(picture)).unwrap();
}

/// The loaded scene; panics with the full report of its errors.
#[track_caller]
pub fn sound<T>(loaded: Result<T, SceneErrors>) -> T {
    loaded.unwrap_or_else(|errors| panic!("{:?}", miette::Report::new(errors)))
}

/// Renders `count` passes.
pub fn passes(engine: &mut dyn Engine, count: u32) {
    for _ in 0..count {
        engine.pass().unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Renders the passes that the settings ask for.
pub fn render_on(wanted: &Wanted, scene: &Scene, settings: &RenderSettings) -> Picture {
    let opened =
        device::open(wanted, scene, settings).unwrap_or_else(|e| panic!("{wanted:?}: {e}"));
    let mut engine = opened.engine;
    passes(engine.as_mut(), settings.passes);
    engine.picture().unwrap_or_else(|error| panic!("{error}"))
}
