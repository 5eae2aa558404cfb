//! Mesh files that scenes name, for every importer and every mesh format.

mod normals;
mod triangles;

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::builder::SceneBuilder;
use super::diagnostics::nearest_file;
use super::importers::mesh_reader;
use super::limits::{Refusal, within};
use super::{Mesh, Rgb, Transform};

pub(crate) use normals::Normals;
pub(crate) use triangles::{Corner, MeshBuilder, Polygon, Steps};

/// A mesh file with its options from the scene file.
pub(crate) struct MeshRequest<'r> {
    /// File name as in the scene file.
    pub file: &'r str,
    /// Position of the file name in the scene file.
    pub named_at: Range<usize>,
    /// True if shading uses vertex normals.
    pub smooth: bool,
    /// Angle in degrees between faces from which on the edge between them is a crease. If given,
    /// computed normals replace those of the file.
    pub crease_angle: Option<f64>,
    /// Material of all triangles; `None` for the materials of the mesh file.
    pub material: Option<usize>,
    pub transform: Transform,
    /// True if the emission of the mesh file's materials counts.
    pub emits: bool,
}

/// Triangles of one material.
pub(crate) struct MeshPart {
    pub mesh: Mesh,
    /// Index into the scene's materials.
    pub material: usize,
    pub emission: Rgb,
}

/// What all meshes of a scene share during loading.
#[derive(Debug, Default)]
pub(crate) struct MeshState {
    /// Bytes and triangles of the allowance that the meshes so far have used.
    bytes: u64,
    triangles: u64,
    /// Steps of ear clipping that are left.
    pub steps: Steps,
    /// Materials from files so far.
    pub own_materials: HashMap<OwnMaterialKey, OwnMaterial>,
}

/// Identifies a material from a file: the mesh file as the scene names it, the material file, the
/// index in it, and whether its emission counts.
pub(crate) type OwnMaterialKey = (String, PathBuf, usize, bool);

/// A material that a mesh file defines or refers to.
#[derive(Clone, Debug)]
pub(crate) struct OwnMaterial {
    /// Index into the scene's materials.
    pub material: usize,
    pub emission: Rgb,
}

impl SceneBuilder<'_> {
    /// Reads a mesh file, as one part per material. Reports errors, and returns `None` after one.
    pub fn mesh(&mut self, request: &MeshRequest) -> Option<Vec<MeshPart>> {
        let path = self.resolve(request.file);
        self.report.files.push(path.clone());
        mesh_reader(&path).read(self, request, &path)
    }

    /// Reads the bytes of a mesh file. Reports a file that cannot be read; `expected` names the
    /// format.
    pub fn mesh_file(
        &mut self,
        request: &MeshRequest,
        path: &Path,
        expected: &str,
    ) -> Option<Vec<u8>> {
        let error = match self.mesh_bytes(path) {
            Ok(bytes) => return Some(bytes),
            Err(error) => error,
        };
        let advise = error.is_missing() && !self.report.errors.is_full();
        let near = || nearest_file(path).filter(|_| advise);
        let help = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
        let message = format!("cannot read mesh {}: {error}", path.display());
        self.report.error(request.named_at.clone(), message, expected, help);
        None
    }

    /// Reads a mesh file or a file that it names within the limits.
    pub fn mesh_bytes(&mut self, path: &Path) -> Result<Vec<u8>, Refusal> {
        let left = self.allowance.mesh_bytes - self.meshes.bytes;
        let bytes = self.allowance.read(path, ("mesh-bytes", left))?;
        self.meshes.bytes += bytes.len() as u64;
        Ok(bytes)
    }

    /// Charges triangles of copies of meshes to the limits before they are made.
    pub fn charge_copies(&mut self, count: u64) -> Result<(), Refusal> {
        let left = self.allowance.triangles.saturating_sub(self.meshes.triangles);
        within("triangles", "triangles of instances", count, left)?;
        self.meshes.triangles += count;
        Ok(())
    }

    /// Charges the triangles of a mesh to the limits before they are made. Reports a mesh that
    /// exceeds them, and returns `None`.
    pub fn charge_triangles(&mut self, request: &MeshRequest, count: u64) -> Option<()> {
        let each = self.allowance.mesh_triangles;
        let all = self.allowance.triangles - self.meshes.triangles;
        let allowed = within("mesh-triangles", "triangles", count, each)
            .and_then(|()| within("triangles", "triangles", count, all));
        if let Err(refusal) = allowed {
            let message = format!("{} is too large: {refusal}", request.file);
            let label = "expected a mesh with fewer";
            self.report.error(request.named_at.clone(), message, label, refusal.help());
            return None;
        }
        self.meshes.triangles += count;
        Some(())
    }

    /// Reports a mesh whose polygons exceed the steps of ear clipping, and returns `None`.
    pub fn check_steps(&mut self, request: &MeshRequest) -> Option<()> {
        if !self.meshes.steps.are_used_up() {
            return Some(());
        }
        let message =
            format!("the faces of {} are too intricate to cut into triangles", request.file);
        let help = "triangulate the mesh in the program that exports it".to_owned();
        let label = "expected faces with fewer corners";
        self.report.error(request.named_at.clone(), message, label, Some(help));
        None
    }

    /// Warns about triangles that were dropped or made flat.
    pub fn warn_of_triangles(
        &mut self,
        request: &MeshRequest,
        degenerate: usize,
        unusable_normals: usize,
    ) {
        let counts = [
            (degenerate, "without area dropped"),
            (unusable_normals, "with a normal of length 0 made flat"),
        ];
        for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
            let noun = if count == 1 { "triangle" } else { "triangles" };
            let message = format!("{}: {count} {noun} {what}", request.file);
            self.report.warn(request.named_at.clone(), message, "in this file");
        }
    }
}
