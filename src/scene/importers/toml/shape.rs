//! Conversion of shapes and transforms.

use glam::{DMat3, DVec3};

use super::document::{Document, Item};
use super::file::{ShapeFile, SurfaceFile, TransformFile};
use super::numbers::Emission;
use super::{index, profile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::diagnostics::Report;
use crate::scene::meshes::MeshRequest;
use crate::scene::parts::Part;
use crate::scene::{Glow, Rgb, Shape, ShapeKind, Transform};

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
        ShapeFile::Mesh { file, smooth, material, transform, surface } => {
            let request = MeshRequest {
                file: &file,
                named_at: item.span_of("file"),
                smooth,
                material: material.map(|name| index(document, "materials", &name)),
                transform: placed(&mut builder.report, item, &transform)?,
                emits: matches!(&surface.emission, Emission::Color(c) if c.rgb() == [0.0; 3]),
            };
            let (own, glow) = emission(builder, document, item, &surface, request.emits);
            let parts = builder.mesh(&request)?.into_iter().map(|part| {
                let emission = if request.emits { part.emission } else { own };
                let planar_uv = surface.uv.is_some();
                let kind = ShapeKind::Mesh(part.mesh);
                Shape { kind, material: part.material, emission, glow, planar_uv }
            });
            builder.add_shapes(item, parts.collect());
            return Some(());
        }
    };
    let material = index(document, "materials", &material);
    let (emission, glow) = emission(builder, document, item, &surface, false);
    let planar_uv = surface.uv.is_some();
    builder.add_shapes(item, vec![Shape { kind, material, emission, glow, planar_uv }]);
    Some(())
}

/// Converts the emission of a shape. Reports keys about an emission that the shape does not have;
/// `elsewhere` if a mesh file may define one.
fn emission(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    surface: &SurfaceFile,
    elsewhere: bool,
) -> (Rgb, Glow) {
    let (radiance, texture) = match &surface.emission {
        Emission::Color(color) => (color.rgb(), None),
        Emission::Texture(name) => {
            let strength = surface.emission_strength.map_or([1.0; 3], |strength| strength.rgb());
            (strength, Some(index(document, "textures", name)))
        }
    };
    let report = &mut builder.report;
    if texture.is_none() && surface.emission_strength.is_some() {
        let message = "`emission_strength` has no meaning without a texture as `emission`";
        let label = "expected the name of a texture as `emission`";
        report.error(item.span_of("emission_strength"), message, label, None);
    }
    let given = [
        ("two_sided_emission", surface.two_sided_emission),
        ("camera_visible", !surface.camera_visible),
    ];
    for (key, _) in given.into_iter().filter(|(_, given)| *given) {
        if radiance == [0.0; 3] && !elsewhere {
            let message = format!("`{key}` has no meaning on a shape that does not emit");
            report.error(item.span_of(key), message, "expected an `emission` as well", None);
        }
    }
    let hidden_from_camera = !surface.camera_visible;
    (radiance, Glow { two_sided: surface.two_sided_emission, hidden_from_camera, texture })
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
