//! Faces that tobj has read, as triangles in world space grouped by material.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::smoothing::SmoothingGroups;
use crate::scene::meshes::{
    Corner, MeshBuilder, MeshPart, MeshRequest, Normals, OwnMaterial, Polygon, Steps,
};

/// The faces of an OBJ file.
pub(super) struct Faces {
    pub parts: Vec<MeshPart>,
    pub degenerate: usize,
    pub unusable_normals: usize,
    /// Number of faces that became part of a mesh; the caller checks that none is lost.
    pub count: u64,
}

/// Builds the triangles of all models; `own` holds the materials that `usemtl` names, and `groups`
/// the smoothing groups.
pub(super) fn faces(
    models: &[tobj::Model],
    request: &MeshRequest,
    own: &[Option<OwnMaterial>],
    groups: &SmoothingGroups,
    steps: &mut Steps,
) -> Faces {
    // tobj keeps the order of the faces.
    let mut groups = groups.of_faces();
    let corners: Vec<_> = models.iter().map(|model| polygons(&model.mesh, &mut groups)).collect();
    let normals =
        request.smooth.then(|| Normals::of(corners.iter().flatten(), request.crease_angle, steps));
    let mut triangles = 0;
    let mut builders: Vec<(OwnMaterial, MeshBuilder)> = Vec::new();
    let (mut known, mut count) = (HashMap::new(), 0);
    for (model, polygons) in models.iter().zip(&corners) {
        let given = request.material.map(|material| OwnMaterial { material, emission: [0.0; 3] });
        let called = || own.get(model.mesh.material_id?)?.clone();
        let Some(material) = given.or_else(called) else {
            triangles += polygons.iter().map(Polygon::triangles).sum::<usize>();
            continue;
        };
        let at = *known.entry(material.material).or_insert_with(|| {
            builders.push((material, MeshBuilder::new(request.transform)));
            builders.len() - 1
        });
        count += polygons.len() as u64;
        for polygon in polygons {
            builders[at].1.add(polygon, triangles, normals.as_ref(), steps);
            triangles += polygon.triangles();
        }
    }
    let mut faces = Faces { parts: Vec::new(), degenerate: 0, unusable_normals: 0, count };
    for (OwnMaterial { material, emission }, builder) in builders {
        faces.degenerate += builder.degenerate;
        faces.unusable_normals += builder.unusable_normals;
        if !builder.mesh.triangles.is_empty() {
            faces.parts.push(MeshPart { mesh: builder.mesh, material, emission });
        }
    }
    faces
}

/// The faces of a mesh that tobj has read with a single index for all attributes.
fn polygons(mesh: &tobj::Mesh, groups: &mut impl Iterator<Item = Option<u32>>) -> Vec<Polygon> {
    let vec3 =
        |values: &[f64], index: usize| values.get(3 * index..3 * index + 3).map(DVec3::from_slice);
    let corner = |&index: &u32| {
        let index = index as usize;
        Corner {
            position: vec3(&mesh.positions, index).unwrap_or_default(),
            normal: vec3(&mesh.normals, index),
            uv: mesh.texcoords.get(2 * index..2 * index + 2).map(DVec2::from_slice),
        }
    };
    let mut rest = &mesh.indices[..];
    let mut polygons = Vec::new();
    let mut arities = mesh.face_arities.iter();
    while !rest.is_empty() {
        let arity = arities.next().map_or(3, |&arity| arity as usize).min(rest.len());
        let (face, behind) = rest.split_at(arity);
        let group = groups.next().unwrap_or_default();
        polygons.push(Polygon { corners: face.iter().map(corner).collect(), group });
        rest = behind;
    }
    polygons
}
