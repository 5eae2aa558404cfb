//! Loading of scene files, whatever their format.

use std::path::{Path, PathBuf};

use super::diagnostics::{Finding, Report, SceneErrors, SourceFile, nearest_file};
use super::encoding::unmarked;
use super::limits::Allowance;
use super::settings::RenderSettings;
use super::{Scene, Spans, importers};
use crate::telemetry::stage::stage;

/// Contents of a scene file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The validated scene.
    pub scene: Scene,
    /// The file's render settings, with defaults filled in.
    pub settings: RenderSettings,
    /// Warnings about the scene.
    pub warnings: Vec<Finding>,
    /// Positions of the parts in the file.
    pub places: Spans,
    /// Files that were read in addition to the scene file.
    pub files: Vec<PathBuf>,
}

/// Reads a scene file and all files that it names.
///
/// # Errors
/// All errors in these files together.
pub fn load(path: &Path) -> Result<Loaded, SceneErrors> {
    load_within(path, &Allowance::default())
}

/// Like [`load`], within an allowance.
///
/// # Errors
/// As [`load`], and everything that the allowance forbids.
pub fn load_within(path: &Path, allowance: &Allowance) -> Result<Loaded, SceneErrors> {
    parse_within(path, &read(path, allowance)?, allowance)
}

/// Reads a scene from a file's bytes. `path` names the scene in messages, and file names in the
/// scene are relative to it.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Loaded, SceneErrors> {
    parse_within(path, bytes, &Allowance::default())
}

/// Like [`parse`], within an allowance. `bytes` may have any length.
///
/// # Errors
/// As [`load_within`].
pub fn parse_within(
    path: &Path,
    bytes: &[u8],
    allowance: &Allowance,
) -> Result<Loaded, SceneErrors> {
    let _stage = stage("parse");
    let file = InputFile { path, bytes, allowance };
    importers::importer(&file).import(&file)
}

/// Reads the bytes of a scene or profile file.
///
/// # Errors
/// A file that cannot be read; if it does not exist, the message suggests the nearest name.
pub(super) fn read(path: &Path, allowance: &Allowance) -> Result<Vec<u8>, SceneErrors> {
    allowance.read_scene(path).map_err(|error| {
        let near = || nearest_file(path).filter(|_| error.is_missing());
        let help = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
        let file = InputFile { path, bytes: &[], allowance };
        file.unreadable(format!("cannot read {}: {error}", path.display()), help)
    })
}

/// A file to import, with the limits that apply.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputFile<'a> {
    /// Name in messages; files that the scene names are relative to its folder.
    pub path: &'a Path,
    pub bytes: &'a [u8],
    pub allowance: &'a Allowance,
}

impl InputFile<'_> {
    /// Decodes a text file, and returns its text together with an empty report about it.
    ///
    /// # Errors
    /// Any encoding but UTF-8.
    pub fn decode(&self) -> Result<(String, Report), SceneErrors> {
        let bytes = unmarked(self.bytes).map_err(|foreign| {
            let message = format!("{}: {foreign}", self.path.display());
            self.unreadable(message, Some(foreign.help()))
        })?;
        let text = String::from_utf8_lossy(bytes).into_owned();
        let source = SourceFile::new(self.path, text.clone());
        let mut report = Report::new(self.path, source, self.allowance.errors);
        if let Err(error) = std::str::from_utf8(bytes) {
            let at = error.valid_up_to();
            report.error(at..at + 1, "the file is not UTF-8", "expected UTF-8 text", None);
            return Err(report.into_errors());
        }
        Ok((text, report))
    }

    /// The error that the file as a whole cannot be used.
    pub fn unreadable(&self, message: String, help: Option<String>) -> SceneErrors {
        let source = SourceFile::new(self.path, String::new());
        let mut report = Report::new(self.path, source, self.allowance.errors);
        report.unreadable(message, help);
        report.into_errors()
    }
}
