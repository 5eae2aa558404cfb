//! Meshes from Wavefront OBJ files, read by tobj.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Cursor;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::allowance::{Refusal, within};
use super::appearance::{Material, Rgb, Texture};
use super::check::Item;
use super::encoding::{Foreign, unmarked};
use super::geometry::{Mesh, Transform};
use super::load::Loader;
use super::report::{SourceFile, did_you_mean};
use super::text::nearest_file;
use super::triangles::{Builder, Polygon, Steps, vertex_normals};
use super::{mtl, obj};

/// A mesh as the scene file asks for it.
pub(super) struct Request<'r> {
    pub file: &'r str,
    pub smooth: bool,
    pub material: Option<usize>,
    pub transform: Transform,
}

/// What all meshes so far have used up of what is allowed.
#[derive(Debug, Default)]
pub(crate) struct Spent {
    bytes: u64,
    triangles: u64,
    steps: Steps,
}

/// The triangles of one material.
pub(super) struct Part {
    pub mesh: Mesh,
    pub material: usize,
    pub emission: Rgb,
}

/// Material libraries of an OBJ file by the name it calls them: materials, and the index of each name.
type Libraries = BTreeMap<PathBuf, (Vec<tobj::Material>, BTreeMap<String, usize>)>;

/// Reads a mesh; one part for each material.
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
    let source = read(loader, item, &path)?;
    let text = obj::join_lines(source.text());
    let before = loader.report.errors.found();
    let mut scan = obj::scan(&text, request.material.is_none());
    let libraries = libraries(loader, &path, &mut scan, &named_at);
    if request.material.is_none() {
        own_materials(&mut scan, &libraries);
    }
    loader.report.asset_errors(named_at.clone(), &source, scan.faults);
    if loader.report.errors.found() > before {
        return None;
    }
    let Spent { triangles, .. } = loader.spent;
    let (each, all) = (loader.allowance.mesh_triangles, loader.allowance.triangles - triangles);
    let allowed = within("mesh-triangles", "triangles", scan.triangles, each)
        .and_then(|()| within("triangles", "triangles", scan.triangles, all));
    if let Err(refusal) = allowed {
        let message = format!("too much in {}: {refusal}", request.file);
        loader.report.error(named_at, message, "expected a mesh with fewer", refusal.help());
        return None;
    }
    loader.spent.triangles += scan.triangles;
    for (keyword, count) in scan.unread.iter().take(MOST_KEYWORDS) {
        let message = format!("{}: {count} `{keyword}` not used", request.file);
        loader.report.warn(named_at.clone(), message, "in this file");
    }
    let options = tobj::LoadOptions { single_index: true, ..Default::default() };
    let loaded = tobj::load_obj_buf(&mut Cursor::new(&scan.cleaned), &options, |library| {
        let (materials, names) = libraries.get(library).cloned().unwrap_or_default();
        Ok((materials, names.into_iter().collect()))
    });
    let (models, own) = match loaded {
        Ok((models, own)) => (models, own.unwrap_or_default()),
        Err(error) => {
            let message = format!("cannot read mesh {}: {error}", request.file);
            loader.report.error(named_at, message, "expected a Wavefront OBJ file", None);
            return None;
        }
    };
    let built = build(&models, request, &mut loader.spent.steps);
    if loader.spent.steps.are_used_up() {
        let message = format!("the faces of {} are too intricate to cut into triangles", request.file);
        let help = "triangulate the mesh where it comes from";
        loader.report.error(named_at, message, "expected faces with fewer corners", Some(help.into()));
        return None;
    }
    report_counts(loader, request.file, &named_at, &built);
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut parts = Vec::new();
    for (own_id, mesh) in built.parts {
        let part = match (request.material, own_id.and_then(|id| own.get(id))) {
            (Some(material), _) => Part { mesh, material, emission: [0.0; 3] },
            (None, Some(own)) => {
                let name = format!("{}:{}", request.file, own.name);
                let known = loader.own_materials.get(&name).copied();
                let material = known.unwrap_or_else(|| {
                    let (material, unused) =
                        mtl::material(name.clone(), own, folder, &mut loader.images, textures);
                    for key in unused {
                        let message = format!("{key} of material {name} is not used");
                        loader.report.warn(named_at.clone(), message, "in this file's MTL");
                    }
                    materials.push(material);
                    loader.own_materials.insert(name, materials.len() - 1);
                    materials.len() - 1
                });
                Part { mesh, material, emission: own.emissive.unwrap_or([0.0; 3]) }
            }
            (None, None) => continue,
        };
        parts.push(part);
    }
    if parts.is_empty() {
        let message = format!("{} has no triangles", request.file);
        loader.report.error(named_at, message, "expected a mesh with faces", None);
    }
    Some(parts)
}

/// Most keywords that are warned of.
const MOST_KEYWORDS: usize = 20;

fn read(loader: &mut Loader, item: &Item, path: &Path) -> Option<SourceFile> {
    match bytes(loader, path) {
        Ok(bytes) => match source(path, &bytes) {
            Ok(source) => Some(source),
            Err(foreign) => {
                let message = format!("{}: {foreign}", path.display());
                let label = "expected a Wavefront OBJ file";
                loader.report.error(item.node.span_of("file"), message, label, Some(foreign.help()));
                None
            }
        },
        Err(error) => {
            let advise = error.is_missing() && !loader.report.errors.is_full();
            let near = || nearest_file(path).filter(|_| advise);
            let help = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
            let message = format!("cannot read mesh {}: {error}", path.display());
            loader.report.error(item.node.span_of("file"), message, "expected a Wavefront OBJ file", help);
            None
        }
    }
}

/// The bytes of an OBJ or MTL file.
fn bytes(loader: &mut Loader, path: &Path) -> Result<Vec<u8>, Refusal> {
    let left = loader.allowance.mesh_bytes - loader.spent.bytes;
    let bytes = loader.allowance.read(path, ("mesh-bytes", left))?;
    loader.spent.bytes += bytes.len() as u64;
    Ok(bytes)
}

/// The text of a file; of names and comments in an encoding of one byte a character, what is not ASCII is lost.
fn source(path: &Path, bytes: &[u8]) -> Result<SourceFile, Foreign> {
    Ok(SourceFile::new(path, String::from_utf8_lossy(unmarked(bytes)?).into_owned()))
}

fn libraries(loader: &mut Loader, path: &Path, scan: &mut obj::Scan, named_at: &Range<usize>) -> Libraries {
    let mut libraries = Libraries::new();
    for (name, span) in std::mem::take(&mut scan.libraries) {
        let library = path.parent().unwrap_or(Path::new("")).join(name);
        loader.report.files.push(library.clone());
        let bytes = match bytes(loader, &library) {
            Ok(bytes) => bytes,
            Err(error) => {
                let message = format!("cannot read {}: {error}", library.display());
                let near = || nearest_file(&library).filter(|_| error.is_missing() && !scan.faults.is_full());
                let mend = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
                scan.faults.push(span, message, mend.unwrap_or_else(|| "expected an MTL file".to_owned()));
                continue;
            }
        };
        let source = match source(&library, &bytes) {
            Ok(source) => source,
            Err(foreign) => {
                let message = format!("{}: {foreign}", library.display());
                scan.faults.push(span, message, foreign.help());
                continue;
            }
        };
        let folder = library.parent().unwrap_or(Path::new(""));
        let found = mtl::scan(source.text(), folder, &mut loader.images);
        let materials = match tobj_materials(&found) {
            Ok(materials) => materials,
            Err(error) => {
                let message = format!("cannot read {}: {error}", library.display());
                scan.faults.push(span, message, "expected an MTL file");
                continue;
            }
        };
        let names = found.names.iter().enumerate().map(|(index, &name)| (name.to_owned(), index));
        libraries.insert(name.into(), (materials, names.collect()));
        loader.report.asset_errors(named_at.clone(), &source, found.faults);
    }
    libraries
}

/// The materials of a library, in its order; none when it has faults, which tobj may not survive.
fn tobj_materials(found: &mtl::Scan) -> Result<Vec<tobj::Material>, tobj::LoadError> {
    if !found.faults.is_empty() {
        return Ok(Vec::new());
    }
    tobj::load_mtl_buf(&mut Cursor::new(&found.cleaned)).map(|(materials, _)| materials)
}

/// Holds the materials that faces call against those that the libraries define.
fn own_materials(scan: &mut obj::Scan, libraries: &Libraries) {
    let known: BTreeSet<_> =
        libraries.values().flat_map(|(_, names)| names.keys().map(String::as_str)).collect();
    for (name, span) in scan.uses.iter().filter(|(name, _)| !name.is_empty() && !known.contains(name)) {
        let other = "expected a material of the file's MTL";
        let advise = !scan.faults.is_full();
        let expected =
            if advise { did_you_mean(name, known.iter().copied(), other) } else { other.to_owned() };
        let message = format!("material `{name}` is not defined");
        scan.faults.push(span.clone(), message, expected);
    }
    if let Some(span) = scan.bare_face.take() {
        let expected = "expected `usemtl` above, or `material` in the scene file";
        scan.faults.push(span, "a face without a material", expected);
    }
}

struct Built {
    parts: Vec<(Option<usize>, Mesh)>,
    degenerate: usize,
    unusable_normals: usize,
}

/// Triangles in the world, grouped by the file's own materials unless the scene gives one.
fn build(models: &[tobj::Model], request: &Request, steps: &mut Steps) -> Built {
    let corners: Vec<_> = models.iter().map(|model| Polygon::of(&model.mesh)).collect();
    let shared = request.smooth.then(|| vertex_normals(corners.iter().flatten(), steps));
    let mut builders: Vec<(Option<usize>, Builder)> = Vec::new();
    let mut known = HashMap::new();
    for (model, polygons) in models.iter().zip(&corners) {
        let id = model.mesh.material_id.filter(|_| request.material.is_none());
        let at = *known.entry(id).or_insert_with(|| {
            builders.push((id, Builder::new(request.transform)));
            builders.len() - 1
        });
        for polygon in polygons {
            builders[at].1.add(polygon, shared.as_ref(), steps);
        }
    }
    let mut built = Built { parts: Vec::new(), degenerate: 0, unusable_normals: 0 };
    for (id, builder) in builders {
        built.degenerate += builder.degenerate;
        built.unusable_normals += builder.unusable_normals;
        if !builder.mesh.triangles.is_empty() {
            built.parts.push((id, builder.mesh));
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
        loader.report.warn(named_at.clone(), format!("{file}: {count} {noun} {what}"), "in this file");
    }
}
