//! The scene file of a session: saved with its comments and order, and watched for changes.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use glam::DVec3;
use serde::Serialize;
use serde_json::{Value as Json, json};
use thiserror::Error;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value, value};

use crate::film::FileError;
use crate::film::file::write_whole;
use crate::memory;
use crate::scene::settings::RenderSettings;
use crate::scene::{Allowance, Camera, Film, Projection, SceneErrors, parse_within};
use crate::storage;

/// The parts of a scene that the window can change.
#[derive(Clone, Debug, PartialEq)]
pub struct Edits {
    /// Viewpoint and lens.
    pub camera: Camera,
    /// Film, of which exposure and tone map are saved.
    pub film: Film,
    /// Render settings.
    pub settings: RenderSettings,
}

/// Reason why a scene is not saved.
#[derive(Debug, Error)]
pub enum SaveError {
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file on disk is not TOML.
    #[error("{} is not valid TOML: {what}; fix it first", file.display())]
    Toml {
        /// The scene file.
        file: PathBuf,
        /// The parse error.
        what: String,
    },
    /// The edited file would not be a valid scene.
    #[error(
        "{} would not be a valid scene: {}",
        file.display(),
        errors.errors.first().map_or("", |e| e.message())
    )]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Errors in the edited file.
        errors: Box<SceneErrors>,
    },
}

/// Writes the differences between `before` and `after` into a scene file, in its current state on
/// disk; the rest of it does not change. Checks first, within `allowance`, that the result is a
/// valid scene.
pub fn save(
    file: &Path,
    allowance: &Allowance,
    before: &Edits,
    after: &Edits,
) -> Result<(), SaveError> {
    let text = storage::read_text(file, memory::readable()).map_err(|cause| FileError::Io {
        file: file.to_owned(),
        verb: "read",
        cause,
    })?;
    let edited = edited(&text, before, after)
        .map_err(|what| SaveError::Toml { file: file.to_owned(), what })?;
    parse_within(file, edited.as_bytes(), allowance)
        .map_err(|errors| SaveError::Scene { file: file.to_owned(), errors: Box::new(errors) })?;
    Ok(write_whole(file, edited.as_bytes())?)
}

/// The text with the differences between `before` and `after`.
///
/// # Errors
/// The parse error of a text that is not TOML.
pub fn edited(text: &str, before: &Edits, after: &Edits) -> Result<String, String> {
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| error.to_string())?;
    let focus = document.get("camera").and_then(|camera| number(camera.get("focus")?.as_value()?));
    let mut put = |section: &str, key: &str, differs: bool, new: Value| {
        if !differs {
            return;
        }
        let section = document.entry(section).or_insert_with(|| Item::Table(Table::new()));
        if let Some(table) = section.as_table_like_mut() {
            put(table, key, new);
        }
    };
    let (a, b) = (&before.camera, &after.camera);
    put("camera", "position", a.position != b.position, point(b.position));
    put("camera", "target", a.target != b.target, point(b.target));
    put("camera", "up", a.up != b.up, point(b.up));
    let differs = a.projection != b.projection;
    match b.projection {
        Projection::Perspective { fov_degrees, .. } | Projection::Fisheye { fov_degrees, .. } => {
            put("camera", "fov", differs, fov_degrees.into());
        }
        Projection::Orthographic { size, .. } => put("camera", "size", differs, size.into()),
        Projection::Panorama => {}
    }
    put("camera", "aperture", a.aperture != b.aperture, b.aperture.into());
    // without a focus, scene files use the target's distance, but a lens with an aperture needs one
    let without = (b.target - b.position).length();
    let needed = b.aperture > 0.0 && focus.is_none() || b.focus != focus.unwrap_or(without);
    put("camera", "focus", needed, b.focus.into());
    let (a, b) = (&before.film, &after.film);
    put("film", "exposure", a.exposure != b.exposure, b.exposure.into());
    put("film", "tonemap", a.tonemap != b.tonemap, written(&b.tonemap));
    let (a, b) = (&before.settings, &after.settings);
    put("render", "method", a.method != b.method, written(&b.method));
    put("render", "passes", a.passes != b.passes, written(&b.passes));
    put("render", "photons", a.photons != b.photons, written(&b.photons));
    put("render", "radius", a.radius != b.radius, written(&b.radius));
    put("render", "radius_rule", a.radius_rule != b.radius_rule, written(&b.radius_rule));
    put("render", "alpha", a.alpha != b.alpha, b.alpha.into());
    put("render", "direct", a.direct != b.direct, written(&b.direct));
    // a field of view replaces a focal length
    if differs && let Some(camera) = document.get_mut("camera").and_then(Item::as_table_like_mut) {
        camera.remove("focal_length");
        camera.remove("sensor");
    }
    Ok(document.to_string())
}

/// Replaces a value, and keeps the white space and comments around it.
fn put(table: &mut dyn TableLike, key: &str, new: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => replace(old, new),
        None => {
            table.insert(key, value(new));
        }
    }
}

fn replace(old: &mut Value, mut new: Value) {
    if let (Value::Array(old), Value::Array(new)) = (&mut *old, &new)
        && old.len() == new.len()
    {
        // number by number, so that the text between them stays
        old.iter_mut().zip(new.iter()).for_each(|(old, new)| replace(old, new.clone()));
        return;
    }
    if same(old, &new) {
        return;
    }
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

/// Returns whether two numbers are equal, so that the old notation can stay.
fn same(old: &Value, new: &Value) -> bool {
    number(old).zip(number(new)).is_some_and(|(old, new)| old == new)
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|whole| whole as f64))
}

fn point(p: DVec3) -> Value {
    Value::Array(Array::from_iter(p.to_array()))
}

/// A setting in the notation of scene files.
fn written(setting: &impl Serialize) -> Value {
    match json!(setting) {
        Json::String(word) => word.into(),
        Json::Object(members) => {
            let one = |(key, member): (String, Json)| {
                (key, Value::from(member.as_f64().unwrap_or_default()))
            };
            Value::InlineTable(InlineTable::from_iter(members.into_iter().map(one)))
        }
        other => {
            other.as_i64().map_or_else(|| other.as_f64().unwrap_or_default().into(), Value::from)
        }
    }
}

/// Watches files for changes.
pub struct Watch(Vec<(PathBuf, Stamp)>);

/// Modification time and length in bytes of a file; `None` if it does not exist.
type Stamp = Option<(SystemTime, u64)>;

impl Watch {
    /// Watches files, starting from their current state.
    pub fn new(files: impl IntoIterator<Item = PathBuf>) -> Self {
        let mut files: Vec<_> = files.into_iter().collect();
        files.sort();
        files.dedup();
        Self(files.into_iter().map(|file| (file.clone(), stamp(&file))).collect())
    }

    /// Changes the set of files; those that were watched before keep their known state.
    pub fn follow(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        let before = std::mem::replace(self, Self::new(files)).0;
        for (file, stamp) in &mut self.0 {
            if let Some((_, old)) = before.iter().find(|(old, _)| old == file) {
                *stamp = *old;
            }
        }
    }

    /// Returns whether any file has changed since the last call.
    pub fn changed(&mut self) -> bool {
        self.0.iter_mut().fold(false, |changed, (file, before)| {
            let now = stamp(file);
            std::mem::replace(before, now) != now || changed
        })
    }
}

fn stamp(file: &Path) -> Stamp {
    let data = std::fs::metadata(file).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// Theory: in an edited file, only the lines of edited keys differ, all comments stay, and the file
/// reads back as the edited values.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::settings::{Direct, Radius, RadiusRule};
    use crate::scene::{Axis, ToneMap};

    const TEXT: &str = "\
# A scene.
version = 1

[camera] # where
position = [0.0, # left
  1.0, 4]        # and out
target = [0, 0.4, 0]
fov = 30 # narrow

# Surfaces come first here.
[[shapes]]
type = \"sphere\" # round
center = [0.0, 0.4, 0.0]
radius = 0.4
material = \"white\"

[materials]
white = { type = \"diffuse\", reflectance = 0.5 } # dull

[render]
photons = 1000 # few
# the end
";

    fn of(text: &str) -> Edits {
        let loaded = crate::scene::parse("scene.toml".as_ref(), text.as_bytes()).unwrap();
        Edits { camera: loaded.scene.camera, film: loaded.scene.film, settings: loaded.settings }
    }

    fn changed<'a>(before: &'a str, after: &'a str) -> Vec<&'a str> {
        after.lines().filter(|line| !before.lines().any(|old| old == *line)).collect()
    }

    #[test]
    fn only_what_was_edited_changes() {
        let before = of(TEXT);
        let mut after = before.clone();
        after.camera.position.y = 1.5;
        after.camera.focus = (after.camera.target - after.camera.position).length();
        after.settings.photons = 2000;
        let text = edited(TEXT, &before, &after).unwrap();
        assert_eq!(changed(TEXT, &text), ["  1.5, 4]        # and out", "photons = 2000 # few"]);
        assert_eq!(text.lines().count(), TEXT.lines().count());
        assert_eq!(of(&text), after);
        assert_eq!(edited(TEXT, &before, &before).unwrap(), TEXT);
    }

    #[test]
    fn everything_that_can_be_edited_reads_back() {
        let before = of(TEXT);
        let mut after = before.clone();
        after.camera.position = DVec3::new(3.25, -1.0, 1e-7);
        after.camera.target = DVec3::new(0.1, 0.2, 0.3);
        after.camera.up = DVec3::Z;
        let axis = Axis::Vertical;
        after.camera.projection = Projection::Perspective { fov_degrees: 35.5, axis };
        (after.camera.aperture, after.camera.focus) = (0.02, 3.75);
        (after.film.exposure, after.film.tonemap) = (-1.5, ToneMap::Srgb);
        let settings = &mut after.settings;
        (settings.method, settings.passes, settings.alpha) =
            (crate::scene::settings::Method::Ppm, 7, 0.5);
        (settings.radius_rule, settings.direct) = (RadiusRule::Local, Direct::Photons);
        for radius in [Radius::Pixels(2.5), Radius::Units(0.01), Radius::Auto] {
            after.settings.radius = radius;
            let text = edited(TEXT, &before, &after).unwrap();
            assert_eq!(of(&text), after);
            let comments = |text: &str| {
                text.lines()
                    .filter_map(|l| l.split_once('#').map(|(_, c)| c.to_owned()))
                    .collect::<Vec<_>>()
            };
            assert_eq!(comments(&text), comments(TEXT));
        }
    }

    #[test]
    fn a_focus_of_its_own_is_saved_for_a_pinhole_too() {
        let before = of(TEXT);
        let mut after = before.clone();
        after.camera.focus = 2.5;
        let text = edited(TEXT, &before, &after).unwrap();
        assert_eq!(changed(TEXT, &text), ["focus = 2.5"]);
        assert_eq!(of(&text), after);
        assert_eq!(
            of(&edited(&text, &after, &before).unwrap()),
            before,
            "and the one of the target"
        );
    }

    /// Theory: an aperture needs a focus in the file, even if the focus equals the default.
    #[test]
    fn a_lens_that_opens_is_saved_with_its_focus() {
        let before = of(TEXT);
        let mut after = before.clone();
        after.camera.aperture = 0.01;
        let text = edited(TEXT, &before, &after).unwrap();
        assert!(changed(TEXT, &text).iter().any(|line| line.starts_with("focus = ")), "{text}");
        assert_eq!(of(&text), after);
    }

    #[test]
    fn files_in_disorder_are_left_alone() {
        let folder = std::env::temp_dir().join(format!("caustica-document-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("scene.toml");
        let before = of(TEXT);
        let mut after = before.clone();
        after.settings.photons = 20_000;
        for (text, word) in [
            ("version = ", "not valid TOML"),
            (&TEXT.replace("0.5", "1.5"), "not be a valid scene"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error =
                save(&file, &Allowance::default(), &before, &after).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
            assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
        }
        std::fs::write(&file, TEXT).unwrap();
        let mut watch = Watch::new([file.clone(), folder.join("gone.obj")]);
        assert!(!watch.changed());
        save(&file, &Allowance::default(), &before, &after).unwrap();
        assert!(watch.changed() && !watch.changed(), "once");
        std::fs::write(folder.join("gone.obj"), "v 0 0 0").unwrap();
        assert!(watch.changed(), "a file that was not there");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
