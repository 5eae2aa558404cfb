//! Conversion of shapes and transforms.

use glam::DVec3;

use super::document::{Document, Item};
use super::file::{ShapeFile, SurfaceFile};
use super::transform::placement;
use super::{index, profile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::diagnostics::Report;
use crate::scene::meshes::MeshRequest;
use crate::scene::parts::Part;
use crate::scene::{Shape, ShapeKind, Transform};

/// The shapes of an item, checked: one, or one per material of a mesh with its own materials; `None`
/// after an error, which is reported.
pub(super) fn shapes(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: ShapeFile,
) -> Option<Vec<Shape>> {
    // The check of the emission follows also where the normal has no direction.
    let normal =
        |report: &mut Report, normal| unit(report, item, "normal", normal).unwrap_or(DVec3::Y);
    let (kind, material, surface) = match file {
        ShapeFile::Sphere { center, radius, material, surface } => {
            let kind = ShapeKind::Sphere { center: center.into(), radius: radius.0 };
            (kind, material, surface)
        }
        ShapeFile::Rectangle { origin, u, v, material, surface } => {
            let kind = ShapeKind::Rectangle { origin: origin.into(), u: u.into(), v: v.into() };
            (kind, material, surface)
        }
        ShapeFile::Disc { center, normal: along, radius, material, surface } => {
            let normal = normal(&mut builder.report, along);
            let kind = ShapeKind::Disc { center: center.into(), normal, radius: radius.0 };
            (kind, material, surface)
        }
        ShapeFile::Plane { point, normal: along, material, surface } => {
            let normal = normal(&mut builder.report, along);
            (ShapeKind::Plane { point: point.into(), normal }, material, surface)
        }
        ShapeFile::Box { min, max, material, surface } => {
            (ShapeKind::Cuboid { min: min.into(), max: max.into() }, material, surface)
        }
        ShapeFile::Revolution { profile, segments, material, surface } => {
            let segments = profile::segments(&mut builder.report, item, profile, segments);
            let place = placement(&mut builder.report, item, surface.transform.as_ref())?;
            let (segments, transform) = (segments?, place.similar.unwrap_or(Transform::IDENTITY));
            let kind = ShapeKind::Revolution { segments, transform, newton_tolerance: 0.0 };
            let material = index(document, "materials", &material);
            let shapes = vec![shape(kind, material, surface.emission.rgb(), &surface)];
            return Some(builder.checked(item, shapes, place.rest()));
        }
        ShapeFile::Mesh { file, smooth, material, surface } => {
            let place = placement(&mut builder.report, item, surface.transform.as_ref())?;
            let request = MeshRequest {
                file: &file,
                named_at: item.span_of("file"),
                smooth,
                material: material.map(|name| index(document, "materials", &name)),
                transform: place.similar.unwrap_or(Transform::IDENTITY),
                emits: surface.emission.rgb() == [0.0; 3],
            };
            let parts = builder.mesh(&request)?.into_iter().map(|part| {
                let emission = if request.emits { part.emission } else { surface.emission.rgb() };
                shape(ShapeKind::Mesh(part.mesh), part.material, emission, &surface)
            });
            let shapes = parts.collect();
            return Some(builder.checked(item, shapes, place.rest()));
        }
    };
    let material = index(document, "materials", &material);
    let shapes = vec![shape(kind, material, surface.emission.rgb(), &surface)];
    let place = match &surface.transform {
        None => None,
        file => Some(placement(&mut builder.report, item, file.as_ref())?),
    };
    Some(builder.checked(item, shapes, place.as_ref().map(|place| &place.map)))
}

fn shape(kind: ShapeKind, material: usize, emission: [f64; 3], surface: &SurfaceFile) -> Shape {
    Shape { kind, material, emission, planar_uv: surface.uv.is_some() }
}
