//! File formats: a folder for each, which knows nothing of the others, and its line in one of the
//! lists below.
//!
//! A scene format implements `Importer`, a mesh format, which scene files of any format name,
//! `MeshReader`.

mod obj;
mod ply;
pub mod toml;

use std::path::Path;

use super::builder::SceneBuilder;
use super::diagnostics::SceneErrors;
use super::load::{InputFile, Loaded};
use super::meshes::{MeshPart, MeshRequest};

/// Scene formats. The first one reads every file that no other one accepts.
const SCENES: [&dyn Importer; 1] = [&toml::Toml];

/// Mesh formats. The first one reads every file that no other one accepts.
const MESHES: [&dyn MeshReader; 2] = [&obj::Obj, &ply::Ply];

/// A format of scene files.
pub(crate) trait Importer: Sync {
    /// Returns whether a file is in this format, by its name or its first bytes.
    fn accepts(&self, file: &InputFile) -> bool;

    /// Reads a scene: adds each part to a [`SceneBuilder`], and finishes it.
    ///
    /// # Errors
    /// All errors in the file and the files that it names together.
    fn import(&self, file: &InputFile) -> Result<Loaded, SceneErrors>;
}

/// A format of mesh files.
pub(crate) trait MeshReader: Sync {
    /// Returns whether a file is in this format, by its name.
    fn accepts(&self, path: &Path) -> bool;

    /// Reads a mesh, as one part per material. Reports errors to the builder, and returns `None`
    /// after one.
    /// The builder has resolved the file's name to `path`.
    fn read(
        &self,
        builder: &mut SceneBuilder,
        request: &MeshRequest,
        path: &Path,
    ) -> Option<Vec<MeshPart>>;
}

/// The importer for a scene file.
pub(super) fn importer(file: &InputFile) -> &'static dyn Importer {
    SCENES.into_iter().find(|format| format.accepts(file)).unwrap_or(SCENES[0])
}

/// The reader for a mesh file.
pub(super) fn mesh_reader(path: &Path) -> &'static dyn MeshReader {
    MESHES.into_iter().find(|format| format.accepts(path)).unwrap_or(MESHES[0])
}
