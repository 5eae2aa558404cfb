//! Wavefront OBJ meshes with their MTL materials, parsed by tobj.

mod faces;
mod libraries;
mod library;
mod lines;
mod mtl;
mod scan;
mod smoothing;

use std::io::Cursor;
use std::path::Path;

use self::faces::faces;
use self::libraries::Libraries;
use self::lines::Text;
use crate::scene::builder::SceneBuilder;
use crate::scene::importers::MeshReader;
use crate::scene::meshes::{MeshPart, MeshRequest};

/// Reads Wavefront OBJ files.
pub(super) struct Obj;

const EXPECTED: &str = "expected a Wavefront OBJ file";

/// Most keywords that are listed in warnings.
const MOST_KEYWORDS: usize = 20;

impl MeshReader for Obj {
    fn accepts(&self, path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"))
    }

    fn read(
        &self,
        builder: &mut SceneBuilder,
        request: &MeshRequest,
        path: &Path,
    ) -> Option<Vec<MeshPart>> {
        let text = text(builder, request, path)?;
        let before = builder.report.errors.found();
        let named_at = &request.named_at;
        let mut scan = scan::scan(text.lines(), request.material.is_none());
        let mut own = Vec::new();
        if request.material.is_none() {
            let mut libraries = Libraries::read(builder, path, &text, &mut scan);
            own = libraries.materials(builder, (request.file, &text), &mut scan, request.emits);
            libraries.report(builder, named_at);
            if let Some(span) = scan.bare_face.take() {
                let expected = "expected `usemtl` above, or `material` in the scene file";
                scan.faults.push(span, "a face without a material", expected);
            }
        }
        builder.report.asset_errors(named_at.clone(), &text.source, scan.faults);
        builder.report.asset_warnings(named_at.clone(), &text.source, scan.warnings);
        if builder.report.errors.found() > before {
            return None;
        }
        builder.charge_triangles(request, scan.triangles)?;
        for (keyword, count) in scan.unread.iter().take(MOST_KEYWORDS) {
            let message = format!("{}: {count} `{keyword}` not used", request.file);
            builder.report.warn(named_at.clone(), message, "in this file");
        }
        let options = tobj::LoadOptions { single_index: true, ..Default::default() };
        let loaded = tobj::load_obj_buf(&mut Cursor::new(&scan.cleaned), &options, |_| {
            let names = (0..own.len()).map(|index| (index.to_string(), index)).collect();
            Ok((vec![tobj::Material::default(); own.len()], names))
        });
        let models = match loaded {
            Ok((models, _)) => models,
            Err(error) => {
                let message = format!("cannot read mesh {}: {error}", request.file);
                builder.report.error(named_at.clone(), message, EXPECTED, None);
                return None;
            }
        };
        let faces = faces(&models, request, &own, &scan.smoothing, &mut builder.meshes.steps);
        builder.check_steps(request)?;
        if faces.count != scan.faces {
            let message =
                format!("{} of {} faces of {} were read", faces.count, scan.faces, request.file);
            builder.report.error(named_at.clone(), message, "expected all", None);
            return None;
        }
        builder.warn_of_triangles(request, faces.degenerate, faces.unusable_normals);
        if faces.parts.is_empty() {
            let message = format!("{} has no triangles", request.file);
            builder.report.error(named_at.clone(), message, "expected a mesh with faces", None);
        }
        Some(faces.parts)
    }
}

/// Reads and decodes the file.
fn text(builder: &mut SceneBuilder, request: &MeshRequest, path: &Path) -> Option<Text> {
    let bytes = builder.mesh_file(request, path, EXPECTED)?;
    match Text::decode(path, &bytes) {
        Ok(text) => Some(text),
        Err(foreign) => {
            let message = format!("{}: {foreign}", path.display());
            let help = Some(foreign.help());
            builder.report.error(request.named_at.clone(), message, EXPECTED, help);
            None
        }
    }
}
