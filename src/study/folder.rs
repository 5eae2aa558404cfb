//! The folder of a study: what it is about, and each finished piece, so that a stopped study goes
//! on where it was.

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

/// What a study is about; a folder holds one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// This program's version.
    pub version: String,
    /// The scene's name.
    pub scene: String,
    /// The scene file's text.
    pub scene_text: String,
    /// Columns and rows of the pictures.
    pub size: (u32, u32),
    /// Columns and rows that the scene file asks for.
    pub own_size: (u32, u32),
    /// The points of the grid.
    pub configs: Vec<Config>,
    /// Renders of each.
    pub seeds: u32,
    /// Seconds of rendering for each render.
    pub run_seconds: f64,
    /// Where the truth comes from.
    pub truth: TruthSpec,
}

/// A picture of a render against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Passes in it.
    pub passes: u32,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Photon paths emitted.
    pub photons: u64,
    /// Rays traced.
    pub rays: u64,
    /// Mean squared error, the truth's own in it.
    pub mse: f64,
    /// Relative mean squared error as `caustica diff` has it, the truth's own in it.
    pub rel_mse: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// Mean luminance over the truth's.
    pub mean_ratio: f64,
}

/// A finished render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Index into [`About::configs`].
    pub config: usize,
    /// Which of the seeds, from 0.
    pub seed: u32,
    /// The device that it ran on.
    pub device: String,
    /// Seconds before the first pass: flattening, probing, compiling.
    pub setup_seconds: f64,
    /// The start radius in pixels that was chosen where the settings left it open.
    #[serde(default)]
    pub automatic_radius: Option<f64>,
    /// relMSE of one pass, as two tell it without a truth; none where only one was made.
    #[serde(default)]
    pub one_pass: Option<f64>,
    /// In the order of passes.
    pub points: Vec<Point>,
    /// Why there are no points, if there are none.
    pub failed: Option<String>,
}

/// What all renders of a configuration say together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProductsRecord {
    /// Index into [`About::configs`].
    pub config: usize,
    /// Passes of the pictures.
    pub passes: u32,
    /// Products of their errors.
    pub products: Products,
}

/// A truth and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthRecord {
    /// The size of the lamps that it is for.
    pub lamp: Option<Lamp>,
    /// What it was made from.
    pub source: String,
    /// Its own mean squared relative error, all pixels in it, by the scatter of its parts; none
    /// where it has only one.
    pub variance: Option<f64>,
    /// Its own relMSE, likewise.
    pub rel_mse: Option<f64>,
}

/// All that a study has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Results {
    /// What it is about.
    pub about: About,
    /// One for each size of the lamps.
    pub truths: Vec<TruthRecord>,
    /// Finished renders.
    pub runs: Vec<RunRecord>,
    /// Of the configurations of which all renders are finished.
    pub products: Vec<ProductsRecord>,
}

/// A study's folder.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

const ABOUT: &str = "about.json";
const RUNS: &str = "runs.jsonl";
const PRODUCTS: &str = "products.jsonl";

impl Folder {
    /// Makes the folder, or finds the same study in it.
    ///
    /// # Errors
    /// Where it holds another study, or other files and no study.
    pub fn open(path: &Path, about: &About) -> Result<Self, StudyError> {
        let folder = Self(path.to_owned());
        let other = |what: String| StudyError::Folder { folder: path.to_owned(), what };
        let file = path.join(ABOUT);
        if file.exists() {
            // what is added to later: a pipe would wait for a reader
            for file in [RUNS, PRODUCTS].map(|name| path.join(name)) {
                storage::check(&file, Purpose::Keepsake)
                    .map_err(|cause| io(&file, "written", cause))?;
            }
            let text = storage::read_text(&file, memory::readable());
            let text = text.map_err(|cause| io(&file, "read", cause))?;
            let found: About = serde_json::from_str(&text).map_err(|error| {
                other(format!("its {ABOUT} is not one of this version's: {error}"))
            })?;
            return match difference(&found, about) {
                None => Ok(folder),
                Some(what) => Err(other(format!(
                    "it holds a study of {what}; name another folder, or remove this one"
                ))),
            };
        }
        let used = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if used || path.is_file() {
            return Err(other(
                "it holds something else than a study; name another folder".to_owned(),
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

    /// A file in it.
    pub fn file(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.join(name)
    }

    /// Finished renders.
    pub fn runs(&self) -> Vec<RunRecord> {
        self.lines(RUNS)
    }

    /// Keeps the finished renders.
    pub fn keep_runs(&self, runs: &[RunRecord]) -> Result<(), FileError> {
        self.keep(RUNS, runs)
    }

    /// Products of errors of finished configurations.
    pub fn products(&self) -> Vec<ProductsRecord> {
        self.lines(PRODUCTS)
    }

    /// Keeps the products.
    pub fn keep_products(&self, products: &[ProductsRecord]) -> Result<(), FileError> {
        self.keep(PRODUCTS, products)
    }

    /// Keeps a picture with all its bits.
    pub fn keep_picture(&self, name: &str, picture: &Picture) -> Result<(), FileError> {
        write_whole(&self.file(name), &pfm::encode(picture))
    }

    /// A kept picture; none where it is missing or damaged.
    pub fn picture(&self, name: &str) -> Option<Picture> {
        read(&self.file(name)).ok()
    }

    /// Removes a file that is no longer needed.
    pub fn remove(&self, name: &str) {
        // One that is gone already is as good.
        let _ = fs::remove_file(self.file(name));
    }

    /// The lines of a file that can be read; what was not finished is made again.
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

/// In which way a study is another one.
fn difference(found: &About, wanted: &About) -> Option<String> {
    let About { version, scene, scene_text, size, own_size: _, configs, seeds, run_seconds, truth } =
        found;
    let checks = [
        (*scene != wanted.scene, format!("the scene `{scene}`")),
        (*scene_text != wanted.scene_text, "an older text of this scene".to_owned()),
        (*size != wanted.size, format!("{} x {} pixels", size.0, size.1)),
        (*configs != wanted.configs, format!("another grid, of {} configurations", configs.len())),
        (*seeds != wanted.seeds, format!("{seeds} seeds")),
        (*truth != wanted.truth, "another truth".to_owned()),
        (
            *run_seconds != wanted.run_seconds,
            format!("{run_seconds:.3} s for each render (another --budget)"),
        ),
        (*version != wanted.version, format!("version {version} of this program")),
    ];
    checks.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
}
