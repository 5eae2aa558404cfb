//! Folder of a study: its parameters and all completed renders, so that an interrupted study can be
//! continued.

use std::fs;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::StudyError;
use super::grid::Config;
use super::lamps::Lamp;
use super::statistics::Products;
use super::truth::TruthSpec;
use crate::film::file::{read, write_whole};
use crate::film::{FileError, Picture, pfm};
use crate::memory;
use crate::storage::{self, Purpose};

/// Parameters of a study. Each folder contains one study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Version of caustica.
    pub version: String,
    /// Scene name.
    pub scene: String,
    /// Text of the scene file.
    pub scene_text: String,
    /// Image columns and rows.
    pub size: (u32, u32),
    /// Image columns and rows in the scene file.
    pub own_size: (u32, u32),
    /// Configurations of the grid.
    pub configs: Vec<Config>,
    /// Number of renders per configuration.
    pub seeds: u32,
    /// Time per render in seconds.
    pub run_seconds: f64,
    /// Source of the reference.
    pub truth: TruthSpec,
}

/// Measurement of an intermediate image against the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Number of passes.
    pub passes: u32,
    /// Render time in seconds.
    pub seconds: f64,
    /// Photon paths emitted.
    pub photons: u64,
    /// Rays traced.
    pub rays: u64,
    /// Mean squared error, including that of the reference.
    pub mse: f64,
    /// relMSE as of `caustica diff`, including that of the reference.
    pub rel_mse: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// Mean luminance divided by that of the reference.
    pub mean_ratio: f64,
}

/// A completed render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Index into [`About::configs`].
    pub config: usize,
    /// Seed number, from 0.
    pub seed: u32,
    /// Device name.
    pub device: String,
    /// Seconds before the first pass: packing, probing, compiling.
    pub setup_seconds: f64,
    /// Automatic start radius in pixels, if the settings ask for one.
    #[serde(default)]
    pub automatic_radius: Option<f64>,
    /// relMSE of one pass, estimated from the first two passes without a reference; `None` if only
    /// one pass was rendered.
    #[serde(default)]
    pub one_pass: Option<f64>,
    /// Measurements in order of passes.
    pub points: Vec<Point>,
    /// Error message of a failed render, which has no measurements.
    pub failed: Option<String>,
}

/// Joint statistics of all renders of a configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProductsRecord {
    /// Index into [`About::configs`].
    pub config: usize,
    /// Number of passes of the images.
    pub passes: u32,
    /// Products of the errors.
    pub products: Products,
}

/// A reference and its accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthRecord {
    /// Lamp size that the reference belongs to.
    pub lamp: Option<Lamp>,
    /// Description of its source.
    pub source: String,
    /// Mean squared relative error over all pixels, from the scatter of the reference's images;
    /// `None` for a single image.
    pub variance: Option<f64>,
    /// relMSE of the reference, likewise.
    pub rel_mse: Option<f64>,
}

/// All results of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Results {
    /// Parameters.
    pub about: About,
    /// References, one for each lamp size.
    pub truths: Vec<TruthRecord>,
    /// Completed renders.
    pub runs: Vec<RunRecord>,
    /// Joint statistics of the configurations whose renders are all complete.
    pub products: Vec<ProductsRecord>,
}

/// Folder of a study.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

const ABOUT: &str = "about.json";
const RUNS: &str = "runs.jsonl";
const PRODUCTS: &str = "products.jsonl";

impl Folder {
    /// Creates the folder, or opens it if it contains the same study.
    ///
    /// # Errors
    /// If the folder contains a different study, or other files.
    pub fn open(path: &Path, about: &About) -> Result<Self, StudyError> {
        let folder = Self(path.to_owned());
        let other = |what: String| StudyError::Folder { folder: path.to_owned(), what };
        let file = path.join(ABOUT);
        if file.exists() {
            // check the files that are written later: a pipe would block until it is read
            for file in [RUNS, PRODUCTS].map(|name| path.join(name)) {
                storage::check(&file, Purpose::Keepsake)
                    .map_err(|cause| io(&file, "written", cause))?;
            }
            let text = storage::read_text(&file, memory::readable());
            let text = text.map_err(|cause| io(&file, "read", cause))?;
            let found: About = serde_json::from_str(&text).map_err(|error| {
                other(format!("cannot parse {ABOUT}, perhaps of another version: {error}"))
            })?;
            return match difference(&found, about) {
                None => Ok(folder),
                Some(what) => Err(other(format!(
                    "contains a study with {what}; use another folder, or remove this one"
                ))),
            };
        }
        let used = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if used || path.is_file() {
            return Err(other(
                "contains something other than a study; use another folder".to_owned(),
            ));
        }
        for sub in ["truth", "unfinished", "crops", "charts"] {
            let sub = path.join(sub);
            fs::create_dir_all(&sub).map_err(|cause| io(&sub, "written", cause))?;
        }
        let text = serde_json::to_string_pretty(about).map_err(|error| other(error.to_string()))?;
        write_whole(&file, text.as_bytes())?;
        Ok(folder)
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.join(name)
    }

    /// Reads the completed renders.
    pub fn runs(&self) -> Vec<RunRecord> {
        self.lines(RUNS)
    }

    /// Writes the completed renders.
    pub fn keep_runs(&self, runs: &[RunRecord]) -> Result<(), FileError> {
        self.keep(RUNS, runs)
    }

    /// Reads the joint statistics of completed configurations.
    pub fn products(&self) -> Vec<ProductsRecord> {
        self.lines(PRODUCTS)
    }

    /// Writes the joint statistics.
    pub fn keep_products(&self, products: &[ProductsRecord]) -> Result<(), FileError> {
        self.keep(PRODUCTS, products)
    }

    /// Writes an image losslessly as PFM.
    pub fn keep_picture(&self, name: &str, picture: &Picture) -> Result<(), FileError> {
        write_whole(&self.file(name), &pfm::encode(picture))
    }

    /// Reads an image; `None` if it is missing or damaged.
    pub fn picture(&self, name: &str) -> Option<Picture> {
        read(&self.file(name)).ok()
    }

    /// Removes a file.
    pub fn remove(&self, name: &str) {
        // the file may be gone already
        let _ = fs::remove_file(self.file(name));
    }

    /// Parses the lines of a file and skips invalid ones, whose renders are repeated.
    fn lines<T: DeserializeOwned>(&self, name: &str) -> Vec<T> {
        let text = storage::read_text(&self.file(name), memory::readable()).unwrap_or_default();
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    fn keep<T: Serialize>(&self, name: &str, items: &[T]) -> Result<(), FileError> {
        let file = self.file(name);
        let lines = items.iter().map(serde_json::to_string).collect::<Result<Vec<_>, _>>();
        let lines = lines
            .map_err(|error| FileError::Encode { file: file.clone(), what: error.to_string() })?;
        write_whole(
            &file,
            lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect::<String>().as_bytes(),
        )
    }
}

fn io(file: &Path, verb: &'static str, cause: std::io::Error) -> FileError {
    FileError::Io { file: file.to_owned(), verb, cause }
}

/// Describes the first difference between two studies.
fn difference(found: &About, wanted: &About) -> Option<String> {
    let About { version, scene, scene_text, size, own_size: _, configs, seeds, run_seconds, truth } =
        found;
    let checks = [
        (*scene != wanted.scene, format!("the scene `{scene}`")),
        (*scene_text != wanted.scene_text, "a different text of this scene".to_owned()),
        (*size != wanted.size, format!("{} x {} pixels", size.0, size.1)),
        (*configs != wanted.configs, format!("a different grid of {} settings", configs.len())),
        (*seeds != wanted.seeds, format!("{seeds} seeds")),
        (*truth != wanted.truth, "a different truth".to_owned()),
        (
            *run_seconds != wanted.run_seconds,
            format!("{run_seconds:.3} s per render (a different --budget)"),
        ),
        (*version != wanted.version, format!("version {version} of caustica")),
    ];
    checks.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
}
