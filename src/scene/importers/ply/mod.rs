//! PLY meshes (Turk, "The PLY Polygon File Format", 1994): text, and binary in either byte order.

mod faces;
mod header;
mod lists;
mod values;
mod vertices;

use std::path::Path;

use glam::DVec2;

use self::faces::Faces;
use self::header::{Broken, Element, Format, Header};
use self::values::{Binary, Text, Values};
use self::vertices::Vertices;
use crate::scene::builder::SceneBuilder;
use crate::scene::diagnostics::{Faults, SourceFile};
use crate::scene::importers::MeshReader;
use crate::scene::meshes::{Corner, MeshBuilder, MeshPart, MeshRequest, Normals, Polygon};

/// Reads PLY files.
pub(super) struct Ply;

const EXPECTED: &str = "expected a PLY file";

impl MeshReader for Ply {
    fn accepts(&self, path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"))
    }

    fn read(
        &self,
        builder: &mut SceneBuilder,
        request: &MeshRequest,
        path: &Path,
    ) -> Option<Vec<MeshPart>> {
        let bytes = builder.mesh_file(request, path, EXPECTED)?;
        let Some(material) = request.material else {
            let message = format!("{} has no material: PLY files have none", request.file);
            let help = Some("add material = \"NAME\" to the shape".to_owned());
            builder.report.error(request.named_at.clone(), message, "expected `material`", help);
            return None;
        };
        let mut found = Findings { errors: Faults::default(), warnings: Faults::warnings() };
        let content = Content::read(&bytes, &mut found);
        let failed = !found.errors.is_empty();
        found.report(builder, request, path, &bytes);
        let content = content.filter(|_| !failed)?;
        builder.charge_triangles(request, content.faces.triangles())?;
        let steps = &mut builder.meshes.steps;
        let normals = request.smooth.then(|| {
            // Without a crease angle, computed normals are for files without their own.
            let needed = request.crease_angle.is_some() || content.vertices.normals.is_empty();
            let polygons = content.polygons().filter(|_| needed);
            Normals::of(polygons, request.crease_angle, steps)
        });
        let mut mesh = MeshBuilder::new(request.transform);
        let mut triangles = 0;
        for polygon in content.polygons() {
            mesh.add(&polygon, triangles, normals.as_ref(), steps);
            triangles += polygon.triangles();
        }
        builder.check_steps(request)?;
        builder.warn_of_triangles(request, mesh.degenerate, mesh.unusable_normals);
        if mesh.mesh.triangles.is_empty() {
            let message = format!("{} has no triangles", request.file);
            let expected = "expected a mesh with faces";
            builder.report.error(request.named_at.clone(), message, expected, None);
            return None;
        }
        Some(vec![MeshPart { mesh: mesh.mesh, material, emission: [0.0; 3] }])
    }
}

/// Errors and warnings about a file.
struct Findings {
    errors: Faults,
    warnings: Faults,
}

impl Findings {
    fn error(&mut self, broken: Broken) {
        self.errors.push(broken.span, broken.message, broken.expected);
    }

    /// Adds the findings to the builder's report. They point into the file, or into its header if
    /// the rest is binary.
    fn report(self, builder: &mut SceneBuilder, request: &MeshRequest, path: &Path, bytes: &[u8]) {
        if self.errors.is_empty() && self.warnings.is_empty() {
            return;
        }
        let length = header::text_length(bytes);
        // Comments may be in any encoding; offsets stay the same.
        let shown = |byte: &u8| if byte.is_ascii() { char::from(*byte) } else { '?' };
        let text = bytes[..length].iter().map(shown).collect();
        let source = SourceFile::new(path, text);
        builder.report.asset_errors(request.named_at.clone(), &source, self.errors);
        builder.report.asset_warnings(request.named_at.clone(), &source, self.warnings);
    }
}

/// Vertices and faces of a file.
#[derive(Default)]
struct Content {
    vertices: Vertices,
    faces: Faces,
}

impl Content {
    /// Reads a file; `None` after an error.
    fn read(bytes: &[u8], found: &mut Findings) -> Option<Self> {
        let header = header::header(bytes).map_err(|broken| found.error(broken)).ok()?;
        let body = header.body;
        let read = match header.format {
            Format::Ascii => Self::body(&mut Text::new(bytes, body), &header, bytes, found),
            Format::LittleEndian => {
                Self::body(&mut Binary::<false>::new(bytes, body), &header, bytes, found)
            }
            Format::BigEndian => {
                Self::body(&mut Binary::<true>::new(bytes, body), &header, bytes, found)
            }
        };
        read.map_err(|broken| found.error(broken)).ok()
    }

    fn body<V: Values>(
        values: &mut V,
        header: &Header,
        bytes: &[u8],
        found: &mut Findings,
    ) -> Result<Self, Broken> {
        let whole = 0..header::text_length(bytes).min(3);
        let of = |name: &str| header.elements.iter().find(|element| element.name == name);
        let missing = |name: &str| {
            let message = format!("the file has no element `{name}`");
            Broken::new(whole.clone(), message, "expected the elements `vertex` and `face`")
        };
        let vertex = of("vertex").ok_or_else(|| missing("vertex"))?;
        of("face").ok_or_else(|| missing("face"))?;
        let mut content = Self::default();
        let mut elements = header.elements.iter();
        let read = elements.try_for_each(|element| {
            content.element(values, header, element, vertex.count, (bytes, found))
        });
        let is_whole = read.is_ok() && found.errors.is_empty() && values.is_at_end();
        if let Some(at) = values.ragged().filter(|_| !is_whole) {
            // Later errors follow from this one.
            found.errors = Faults::default();
            let message = "a row with more or fewer numbers than the header states";
            return Err(Broken::new(at, message, "expected the end of the line before this"));
        }
        read?;
        content.check_vertices(found);
        if !values.is_at_end() {
            let message = format!("{} bytes after the last element not used", values.left());
            found.warnings.push(whole, message, "in this file");
        }
        Ok(content)
    }

    fn element<V: Values>(
        &mut self,
        values: &mut V,
        header: &Header,
        element: &Element,
        vertices: u64,
        (bytes, found): (&[u8], &mut Findings),
    ) -> Result<(), Broken> {
        values::fits(element, header.format, values.left(), bytes.len())?;
        match element.name.as_str() {
            "vertex" => self.vertices = vertices::vertices(values, element, bytes)?,
            "face" => {
                self.faces = faces::faces(values, element, vertices, bytes, &mut found.errors)?;
            }
            _ => lists::skip_rows(values, element, bytes)?,
        }
        Ok(())
    }

    /// Reports vertices that have an unusable number: errors if a face uses them, else a warning.
    fn check_vertices(&mut self, found: &mut Findings) {
        let bad = &mut self.vertices.bad;
        if bad.is_empty() {
            return;
        }
        let mut used: Vec<_> = self.faces.corners.iter().filter_map(|at| bad.remove(at)).collect();
        used.sort_by_key(|broken| broken.span.start);
        used.into_iter().for_each(|broken| found.error(broken));
        let count = bad.len();
        if let Some(first) = bad.drain().map(|(_, broken)| broken).min_by_key(|b| b.span.start) {
            let vertices = if count == 1 { "vertex has" } else { "vertices have" };
            let message = format!("{count} {vertices} a number that cannot be used");
            found.warnings.push(first.span, message, "no face uses them");
        }
    }

    fn polygons(&self) -> impl Iterator<Item = Polygon> + '_ {
        let Self { vertices, faces } = self;
        let corner = |at: usize| {
            let vertex = *faces.corners.get(at)? as usize;
            let own = faces.uvs.get(at).copied().filter(|uv: &DVec2| uv.is_finite());
            Some(Corner {
                position: *vertices.positions.get(vertex)?,
                normal: vertices.normals.get(vertex).copied(),
                uv: own.or_else(|| vertices.uvs.get(vertex).copied()),
            })
        };
        faces.ranges().map(move |range| Polygon {
            corners: range.filter_map(corner).collect(),
            group: Some(0),
        })
    }
}
