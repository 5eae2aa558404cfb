//! Meshes from Wavefront OBJ files, parsed by tobj.

use std::collections::HashMap;
use std::io::Cursor;
use std::ops::Range;
use std::path::Path;

use super::appearance::{Material, Rgb, Texture};
use super::diagnostics::nearest_file;
use super::geometry::{Mesh, Transform};
use super::libraries::{Libraries, Own};
use super::limits::{Refusal, within};
use super::lines::Text;
use super::load::Loader;
use super::obj;
use super::triangles::{Builder, Polygon, Steps, vertex_normals};
use super::validate::Item;

/// A mesh with its options from the scene file.
pub(super) struct Request<'r> {
    pub file: &'r str,
    pub smooth: bool,
    pub material: Option<usize>,
    pub transform: Transform,
    /// True if the emission of its MTL materials counts.
    pub emits: bool,
}

/// Amounts of the allowance that all meshes so far have used.
#[derive(Debug, Default)]
pub(crate) struct Spent {
    bytes: u64,
    triangles: u64,
    steps: Steps,
}

/// Triangles of one material.
pub(super) struct Part {
    pub mesh: Mesh,
    pub material: usize,
    pub emission: Rgb,
}

/// Reads a mesh, as one part per material.
pub(super) fn load(
    loader: &mut Loader,
    item: &Item,
    request: &Request,
    textures: &mut Vec<Texture>,
    materials: &mut Vec<Material>,
) -> Option<Vec<Part>> {
    let path = loader.resolve(request.file);
    let named_at = item.node.span_of("file");
    loader.report.files.push(path.clone());
    let text = read(loader, item, &path)?;
    let before = loader.report.errors.found();
    let mut scan = obj::scan(text.lines(), request.material.is_none());
    let mut own = Vec::new();
    if request.material.is_none() {
        let mut libraries = Libraries::read(loader, &path, &text, &mut scan);
        let made = (&mut *textures, &mut *materials);
        own = libraries.materials(loader, (request.file, &text), &mut scan, request.emits, made);
        libraries.report(loader, &named_at);
        if let Some(span) = scan.bare_face.take() {
            let expected = "expected `usemtl` above, or `material` in the scene file";
            scan.faults.push(span, "a face without a material", expected);
        }
    }
    loader.report.asset_errors(named_at.clone(), &text.source, scan.faults);
    loader.report.asset_warnings(named_at.clone(), &text.source, scan.warnings);
    if loader.report.errors.found() > before {
        return None;
    }
    let Spent { triangles, .. } = loader.spent;
    let (each, all) = (loader.allowance.mesh_triangles, loader.allowance.triangles - triangles);
    let allowed = within("mesh-triangles", "triangles", scan.triangles, each)
        .and_then(|()| within("triangles", "triangles", scan.triangles, all));
    if let Err(refusal) = allowed {
        let message = format!("{} is too large: {refusal}", request.file);
        loader.report.error(named_at, message, "expected a mesh with fewer", refusal.help());
        return None;
    }
    loader.spent.triangles += scan.triangles;
    for (keyword, count) in scan.unread.iter().take(MOST_KEYWORDS) {
        let message = format!("{}: {count} `{keyword}` not used", request.file);
        loader.report.warn(named_at.clone(), message, "in this file");
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
            loader.report.error(named_at, message, "expected a Wavefront OBJ file", None);
            return None;
        }
    };
    let built = build(&models, request, &own, &mut loader.spent.steps);
    if loader.spent.steps.are_used_up() {
        let message =
            format!("the faces of {} are too intricate to cut into triangles", request.file);
        let help = "triangulate the mesh in the program that exports it";
        loader.report.error(
            named_at,
            message,
            "expected faces with fewer corners",
            Some(help.into()),
        );
        return None;
    }
    if built.faces != scan.faces {
        let message =
            format!("{} of {} faces of {} were read", built.faces, scan.faces, request.file);
        loader.report.error(named_at, message, "expected all", None);
        return None;
    }
    report_counts(loader, request.file, &named_at, &built);
    if built.parts.is_empty() {
        let message = format!("{} has no triangles", request.file);
        loader.report.error(named_at, message, "expected a mesh with faces", None);
    }
    Some(built.parts)
}

/// Most keywords that are listed in warnings.
const MOST_KEYWORDS: usize = 20;

fn read(loader: &mut Loader, item: &Item, path: &Path) -> Option<Text> {
    match loader.mesh_bytes(path) {
        Ok(bytes) => match Text::decode(path, &bytes) {
            Ok(text) => Some(text),
            Err(foreign) => {
                let message = format!("{}: {foreign}", path.display());
                let label = "expected a Wavefront OBJ file";
                loader.report.error(
                    item.node.span_of("file"),
                    message,
                    label,
                    Some(foreign.help()),
                );
                None
            }
        },
        Err(error) => {
            let advise = error.is_missing() && !loader.report.errors.is_full();
            let near = || nearest_file(path).filter(|_| advise);
            let help = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
            let message = format!("cannot read mesh {}: {error}", path.display());
            loader.report.error(
                item.node.span_of("file"),
                message,
                "expected a Wavefront OBJ file",
                help,
            );
            None
        }
    }
}

impl Loader<'_, '_> {
    /// Reads an OBJ or MTL file within the limits.
    pub fn mesh_bytes(&mut self, path: &Path) -> Result<Vec<u8>, Refusal> {
        let left = self.allowance.mesh_bytes - self.spent.bytes;
        let bytes = self.allowance.read(path, ("mesh-bytes", left))?;
        self.spent.bytes += bytes.len() as u64;
        Ok(bytes)
    }
}

struct Built {
    parts: Vec<Part>,
    degenerate: usize,
    unusable_normals: usize,
    /// Number of faces that became part of a mesh; the caller checks that none is lost.
    faces: u64,
}

/// Builds world-space triangles, grouped by material.
fn build(
    models: &[tobj::Model],
    request: &Request,
    own: &[Option<Own>],
    steps: &mut Steps,
) -> Built {
    let corners: Vec<_> = models.iter().map(|model| Polygon::of(&model.mesh)).collect();
    let shared = request.smooth.then(|| vertex_normals(corners.iter().flatten(), steps));
    let mut builders: Vec<(Own, Builder)> = Vec::new();
    let (mut known, mut faces) = (HashMap::new(), 0);
    for (model, polygons) in models.iter().zip(&corners) {
        let given = request.material.map(|material| Own { material, emission: [0.0; 3] });
        let called = || own.get(model.mesh.material_id?)?.clone();
        let Some(material) = given.or_else(called) else { continue };
        let at = *known.entry(material.material).or_insert_with(|| {
            builders.push((material, Builder::new(request.transform)));
            builders.len() - 1
        });
        faces += polygons.len() as u64;
        for polygon in polygons {
            builders[at].1.add(polygon, shared.as_ref(), steps);
        }
    }
    let mut built = Built { parts: Vec::new(), degenerate: 0, unusable_normals: 0, faces };
    for (Own { material, emission }, builder) in builders {
        built.degenerate += builder.degenerate;
        built.unusable_normals += builder.unusable_normals;
        if !builder.mesh.triangles.is_empty() {
            built.parts.push(Part { mesh: builder.mesh, material, emission });
        }
    }
    built
}

fn report_counts(loader: &mut Loader, file: &str, named_at: &Range<usize>, built: &Built) {
    let counts = [
        (built.degenerate, "without area dropped"),
        (built.unusable_normals, "with a normal of length 0 made flat"),
    ];
    for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
        let noun = if count == 1 { "triangle" } else { "triangles" };
        loader.report.warn(
            named_at.clone(),
            format!("{file}: {count} {noun} {what}"),
            "in this file",
        );
    }
}
