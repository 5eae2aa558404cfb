//! `caustica render --like`: repeats a render from the metadata of its image.

use std::path::{Path, PathBuf};

use caustica::low_level::film::provenance::VERSION;
use caustica::low_level::film::{FileError, Provenance, file};
use caustica::low_level::render::identity::Identity;
use caustica::low_level::scene::{self, Loaded, Scene};

use super::Failure;
use super::allowed::Allowed;
use super::output::message;

/// An image whose render is to be repeated.
pub struct Like {
    file: PathBuf,
    made: Provenance,
    version: String,
}

impl Like {
    /// Reads the attributes of an EXR file written by caustica.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let attributes = file::read_exr(path)?.attributes;
        let made = Provenance::read(&attributes).map_err(|what| FileError::Malformed {
            file: path.to_owned(),
            what: format!("for --like, {what}"),
        })?;
        let version = attributes.get("caustica.version").cloned().unwrap_or_default();
        Ok(Self { file: path.to_owned(), made, version })
    }

    /// Scene file name as given by the user of the original render.
    pub fn scene(&self) -> PathBuf {
        PathBuf::from(&self.made.scene_file)
    }

    /// First pass of the image.
    pub fn first_pass(&self) -> u32 {
        self.made.first_pass
    }

    /// Device of the original render.
    pub fn device(&self) -> &str {
        &self.made.device
    }

    /// Default output: a name that differs from the default names of other commands.
    pub fn output(&self) -> PathBuf {
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        PathBuf::from(format!("{stem}-again.exr"))
    }

    /// Loads the scene from its file or, if that does not exist, from the text in the image.
    pub fn load(&self, path: &Path, allowed: &Allowed) -> Result<Loaded, Failure> {
        if path.exists() {
            return allowed.load(path);
        }
        message(format_args!(
            "{}: not found; the scene is read from the text in {}",
            path.display(),
            self.file.display()
        ));
        Ok(scene::parse_within(path, self.made.scene_text.as_bytes(), &allowed.allowance()?)?)
    }

    /// Applies the image's film and settings, and warns about differences from the original render.
    pub fn apply(&self, loaded: &mut Loaded) {
        let Loaded { scene, settings, .. } = loaded;
        if let Some(film) = self.made.film {
            let scene::Film { exposure, tonemap, filter, .. } = scene.film;
            scene.film = scene::Film { exposure, tonemap, filter, ..film };
        }
        *settings = self.made.asked.clone().unwrap_or_else(|| self.made.settings.clone());
        settings.passes = self.made.first_pass + self.made.passes_done;
        for warning in self.differences(scene) {
            message(format_args!("warning: {}: {warning}", self.file.display()));
        }
    }

    fn differences(&self, scene: &Scene) -> Vec<String> {
        let version = (self.version != VERSION).then(|| {
            format!(
                "rendered by version {}, this is {VERSION}: the image may have different bits",
                self.version
            )
        });
        let other =
            self.made.digest.as_ref().is_some_and(|digest| *digest != Identity::of(scene).digest());
        let scene = other.then(|| "the scene or a file that it uses has changed since".to_owned());
        version.into_iter().chain(scene).collect()
    }
}
