//! Conversion and checks of shapes and transforms.

use glam::{DMat3, DVec3};

use super::appearance::{Material, Texture};
use super::camera::unit;
use super::diagnostics::Report;
use super::file::{ShapeFile, SurfaceFile, TransformFile};
use super::geometry::{Shape, ShapeKind, Transform};
use super::load::Loader;
use super::numbers::{LARGEST, SMALLEST};
use super::validate::Item;
use super::{mesh, profile};

/// Smallest sine of the angle between the edges of a rectangle.
const LEAST_SINE: f64 = 1e-12;

/// Shapes of an item: one, or one per material of a mesh with its own materials.
pub(super) fn shapes(
    loader: &mut Loader,
    item: &Item,
    file: ShapeFile,
    textures: &mut Vec<Texture>,
    materials: &mut Vec<Material>,
) -> Option<Vec<Shape>> {
    let (kind, material, surface) = match file {
        ShapeFile::Sphere { center, radius, material, surface } => {
            let kind = ShapeKind::Sphere { center: center.into(), radius: radius.0 };
            (kind, material, surface)
        }
        ShapeFile::Rectangle { origin, u, v, material, surface } => {
            let (u, v) = (DVec3::from(u), DVec3::from(v));
            let least = (LEAST_SINE * u.length() * v.length()).max(SMALLEST * SMALLEST);
            if u.cross(v).length() <= least {
                let message = format!("{} has no area: `u` and `v` are parallel or 0", item.path);
                let label = "expected an edge in another direction than `u`";
                loader.report.error(item.node.span_of("v"), message, label, None);
            }
            (ShapeKind::Rectangle { origin: origin.into(), u, v }, material, surface)
        }
        ShapeFile::Disc { center, normal, radius, material, surface } => {
            let normal = unit(loader, item, "normal", normal)?;
            let kind = ShapeKind::Disc { center: center.into(), normal, radius: radius.0 };
            (kind, material, surface)
        }
        ShapeFile::Plane { point, normal, material, surface } => {
            if surface.emission.rgb() != [0.0; 3] {
                let message = "an infinite plane cannot emit: its power would be infinite";
                let help = Some("use a rectangle or an [environment]".to_owned());
                let label = "expected no emission here";
                loader.report.error(item.node.span_of("emission"), message, label, help);
            }
            let normal = unit(loader, item, "normal", normal)?;
            (ShapeKind::Plane { point: point.into(), normal }, material, surface)
        }
        ShapeFile::Box { min, max, material, surface } => {
            if let Some(axis) = (0..3).find(|&axis| max[axis] - min[axis] < SMALLEST) {
                let name = ["x", "y", "z"][axis];
                let message = format!(
                    "{} is empty: min.{name} = {}, max.{name} = {}",
                    item.path, min[axis], max[axis]
                );
                let label = format!("expected {name} greater than {}", min[axis]);
                loader.report.error(item.node.span_of("max"), message, label, None);
            }
            (ShapeKind::Cuboid { min: min.into(), max: max.into() }, material, surface)
        }
        ShapeFile::Revolution { profile, segments, material, transform, surface } => {
            let segments = profile::segments(loader.report, item, profile, segments);
            let transform = placed(loader.report, item, &transform)?;
            let segments = segments?;
            let reach = segments
                .iter()
                .flatten()
                .map(|point| point.abs().max_element())
                .fold(0.0, f64::max);
            within_reach(loader.report, item, reach * transform.scale);
            let kind = ShapeKind::Revolution { segments, transform, newton_tolerance: 0.0 };
            (kind, material, surface)
        }
        ShapeFile::Mesh { file, smooth, material, transform, surface } => {
            let transform = placed(loader.report, item, &transform)?;
            let material = material.map(|name| loader.index("materials", &name));
            let emits = surface.emission.rgb() == [0.0; 3];
            let request = mesh::Request { file: &file, smooth, material, transform, emits };
            let parts = mesh::load(loader, item, &request, textures, materials)?;
            let positions = parts.iter().flat_map(|part| &part.mesh.positions);
            let reach = positions.map(|position| position.abs().max_element()).fold(0.0, f64::max);
            within_reach(loader.report, item, reach);
            let shapes = parts.into_iter().map(|part| {
                let own = surface.emission.rgb();
                let emission = if own == [0.0; 3] { part.emission } else { own };
                shape(ShapeKind::Mesh(part.mesh), part.material, emission, &surface)
            });
            return Some(shapes.collect());
        }
    };
    let material = loader.index("materials", &material);
    Some(vec![shape(kind, material, surface.emission.rgb(), &surface)])
}

fn shape(kind: ShapeKind, material: usize, emission: [f64; 3], surface: &SurfaceFile) -> Shape {
    Shape { kind, material, emission, planar_uv: surface.uv.is_some() }
}

/// Reports a shape whose transform enlarges it beyond the range of renderers.
fn within_reach(report: &mut Report, item: &Item, reach: f64) {
    if reach > LARGEST {
        let message =
            format!("{} reaches to {reach:.1e}, too large for single precision", item.path);
        let label = format!("expected coordinates of at most {LARGEST:e} after the transform");
        report.error(item.node.span_of("transform"), message, label, None);
    }
}

/// Converts a transform; reports a rotation axis without a direction.
pub(super) fn placed(report: &mut Report, item: &Item, file: &TransformFile) -> Option<Transform> {
    let rotation = match &file.rotate {
        None => DMat3::IDENTITY,
        Some(rotate) => {
            let Some(axis) = DVec3::from(rotate.axis).try_normalize() else {
                let message = format!("`{}` has no direction", item.key("transform.rotate.axis"));
                let node = item.node.get("transform").and_then(|node| node.get("rotate"));
                let span = node.map_or(item.node.span(), |node| node.span_of("axis"));
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
