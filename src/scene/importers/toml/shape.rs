//! Conversion of shapes and transforms.

use glam::DVec3;

use super::axial::{Axis, frustum};
use super::document::{Document, Item};
use super::file::{ShapeFile, SurfaceFile};
use super::transform::{Placement, placement};
use super::{index, profile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::diagnostics::Report;
use crate::scene::meshes::MeshRequest;
use crate::scene::parts::Part;
use crate::scene::{Shape, ShapeKind, Transform};

/// The shapes of an item, checked: one, or one per material of a mesh with its own materials.
/// `None` after an error, which is reported.
pub(super) fn shapes(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: ShapeFile,
) -> Option<Vec<Shape>> {
    // The check of the emission follows also where the normal has no direction.
    let normal =
        |report: &mut Report, normal| unit(report, item, "normal", normal).unwrap_or(DVec3::Y);
    let place = placement(&mut builder.report, item, file.surface().transform.as_ref());
    // scale, rotation and translation of the kinds that have them
    let similar = place.map(|place| place.similar.unwrap_or(Transform::IDENTITY));
    let index = |name: &str| index(document, "materials", name);
    let alone = |kind, material: String, surface: SurfaceFile| {
        vec![shape(kind, index(&material), surface.emission.rgb(), &surface)]
    };
    let rest = place.as_ref().map(Placement::rest);
    let (shapes, map) = match file {
        ShapeFile::Sphere { center, radius, material, surface } => {
            let kind = ShapeKind::Sphere { center: center.into(), radius: radius.0 };
            (alone(kind, material, surface), place.as_ref().map(Placement::given)?)
        }
        ShapeFile::Rectangle { origin, u, v, material, surface } => {
            let kind = ShapeKind::Rectangle { origin: origin.into(), u: u.into(), v: v.into() };
            (alone(kind, material, surface), place.as_ref().map(Placement::given)?)
        }
        ShapeFile::Disc { center, normal: along, radius, material, surface } => {
            let normal = normal(&mut builder.report, along);
            let kind = ShapeKind::Disc { center: center.into(), normal, radius: radius.0 };
            (alone(kind, material, surface), place.as_ref().map(Placement::given)?)
        }
        ShapeFile::Plane { point, normal: along, material, surface } => {
            let normal = normal(&mut builder.report, along);
            let kind = ShapeKind::Plane { point: point.into(), normal };
            (alone(kind, material, surface), place.as_ref().map(Placement::given)?)
        }
        ShapeFile::Box { min, max, material, surface } => {
            let kind = ShapeKind::Cuboid { min: min.into(), max: max.into() };
            (alone(kind, material, surface), place.as_ref().map(Placement::given)?)
        }
        ShapeFile::Revolution { profile, segments, material, surface } => {
            let segments = profile::segments(&mut builder.report, item, profile, segments);
            let (segments, transform) = (segments?, similar?);
            let kind = ShapeKind::Revolution { segments, transform, newton_tolerance: 0.0 };
            (alone(kind, material, surface), rest?)
        }
        ShapeFile::Cylinder { radius, height, p0, p1, caps, material, surface } => {
            let axis = Axis { height, p0, p1 };
            let radii = [radius.0; 2];
            let kind = frustum(&mut builder.report, item, &axis, radii, caps, &similar?)?;
            (alone(kind, material, surface), rest?)
        }
        ShapeFile::Cone { radius, top_radius, height, p0, p1, caps, material, surface } => {
            let axis = Axis { height, p0, p1 };
            let radii = [radius.0, top_radius.0];
            let kind = frustum(&mut builder.report, item, &axis, radii, caps, &similar?)?;
            (alone(kind, material, surface), rest?)
        }
        ShapeFile::Mesh { file, smooth, crease_angle, material, surface } => {
            flat_creases(&mut builder.report, item, smooth, crease_angle);
            let request = MeshRequest {
                file: &file,
                named_at: item.span_of("file"),
                smooth,
                crease_angle,
                material: material.map(|name| index(&name)),
                transform: similar?,
                emits: surface.emission.rgb() == [0.0; 3],
            };
            let parts = builder.mesh(&request)?.into_iter().map(|part| {
                let emission = if request.emits { part.emission } else { surface.emission.rgb() };
                shape(ShapeKind::Mesh(part.mesh), part.material, emission, &surface)
            });
            (parts.collect(), rest?)
        }
    };
    Some(builder.checked(item, shapes, map))
}

/// Reports a crease angle of a mesh without normals.
fn flat_creases(report: &mut Report, item: &Item, smooth: bool, crease_angle: Option<f64>) {
    if !smooth && crease_angle.is_some() {
        let message = format!("{} has a crease angle, but its faces are flat", item.place());
        let help = Some("leave out `crease_angle` or `smooth = false`".to_owned());
        report.error(item.span_of("crease_angle"), message, "expected a smooth mesh", help);
    }
}

fn shape(kind: ShapeKind, material: usize, emission: [f64; 3], surface: &SurfaceFile) -> Shape {
    Shape { kind, material, emission, planar_uv: surface.uv.is_some() }
}
