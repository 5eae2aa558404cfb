//! Conversion of shapes and transforms.

use glam::{DMat3, DVec3};

use super::axial::{Axis, frustum};
use super::document::{Document, Item};
use super::file::{ShapeFile, SurfaceFile, TransformFile};
use super::{index, profile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::diagnostics::Report;
use crate::scene::meshes::MeshRequest;
use crate::scene::parts::Part;
use crate::scene::{Shape, ShapeKind, Transform};

/// Adds the shapes of an item: one, or one per material of a mesh with its own materials.
pub(super) fn shapes(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: ShapeFile,
) -> Option<()> {
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
        ShapeFile::Revolution { profile, segments, material, transform, surface } => {
            let segments = profile::segments(&mut builder.report, item, profile, segments);
            let transform = placed(&mut builder.report, item, &transform)?;
            let segments = segments?;
            let kind = ShapeKind::Revolution { segments, transform, newton_tolerance: 0.0 };
            (kind, material, surface)
        }
        ShapeFile::Cylinder { radius, height, p0, p1, caps, material, transform, surface } => {
            let transform = placed(&mut builder.report, item, &transform)?;
            let axis = Axis { height, p0, p1 };
            let radii = [radius.0; 2];
            let kind = frustum(&mut builder.report, item, &axis, radii, caps, &transform)?;
            (kind, material, surface)
        }
        ShapeFile::Cone {
            radius,
            top_radius,
            height,
            p0,
            p1,
            caps,
            material,
            transform,
            surface,
        } => {
            let transform = placed(&mut builder.report, item, &transform)?;
            let axis = Axis { height, p0, p1 };
            let radii = [radius.0, top_radius.0];
            let kind = frustum(&mut builder.report, item, &axis, radii, caps, &transform)?;
            (kind, material, surface)
        }
        ShapeFile::Mesh { file, smooth, crease_angle, material, transform, surface } => {
            flat_creases(&mut builder.report, item, smooth, crease_angle);
            let request = MeshRequest {
                file: &file,
                named_at: item.span_of("file"),
                smooth,
                crease_angle,
                material: material.map(|name| index(document, "materials", &name)),
                transform: placed(&mut builder.report, item, &transform)?,
                emits: surface.emission.rgb() == [0.0; 3],
            };
            let parts = builder.mesh(&request)?.into_iter().map(|part| {
                let emission = if request.emits { part.emission } else { surface.emission.rgb() };
                shape(ShapeKind::Mesh(part.mesh), part.material, emission, &surface)
            });
            builder.add_shapes(item, parts.collect());
            return Some(());
        }
    };
    let material = index(document, "materials", &material);
    builder.add_shapes(item, vec![shape(kind, material, surface.emission.rgb(), &surface)]);
    Some(())
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

/// Converts a transform; reports a rotation axis without a direction.
pub(super) fn placed(report: &mut Report, item: &Item, file: &TransformFile) -> Option<Transform> {
    let rotation = match &file.rotate {
        None => DMat3::IDENTITY,
        Some(rotate) => {
            let Some(axis) = DVec3::from(rotate.axis).try_normalize() else {
                let message = format!("`{}` has no direction", item.key("transform.rotate.axis"));
                let node = item.node.get("transform").and_then(|node| node.get("rotate"));
                let span = node.map_or(item.span(), |node| node.span_of("axis"));
                report.error(span, message, "expected a vector of a length other than 0", None);
                return None;
            };
            DMat3::from_axis_angle(axis, rotate.degrees.to_radians())
        }
    };
    Some(Transform {
        scale: file.scale.map_or(1.0, f64::from),
        rotation,
        translation: file.translate.into(),
    })
}
