//! Bounding boxes of shapes.

use glam::{DAffine3, DVec3};

use super::{Group, Shape, ShapeKind};

/// Bounding box of a finite shape in world space; `None` for planes and empty meshes.
pub fn extent(kind: &ShapeKind) -> Option<(DVec3, DVec3)> {
    let hull = |points: &[DVec3]| {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        (low, high)
    };
    Some(match kind {
        ShapeKind::Sphere { center, radius } | ShapeKind::Disc { center, radius, .. } => {
            (*center - DVec3::splat(*radius), *center + DVec3::splat(*radius))
        }
        ShapeKind::Rectangle { origin, u, v } => {
            hull(&[*origin, *origin + *u, *origin + *v, *origin + *u + *v])
        }
        ShapeKind::Cuboid { min, max } => (*min, *max),
        ShapeKind::Mesh(mesh) if mesh.positions.is_empty() => return None,
        ShapeKind::Mesh(mesh) => hull(&mesh.positions),
        ShapeKind::Revolution { segments, transform, .. } => {
            let points = || segments.iter().flatten();
            let r = points().map(|p| p.x.abs()).fold(0.0, f64::max);
            let bottom = points().map(|p| p.y).fold(f64::INFINITY, f64::min);
            let top = points().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
            let corners: Vec<DVec3> = (0..8)
                .map(|k| {
                    let side = |bit: u32| if k >> bit & 1 == 1 { r } else { -r };
                    let y = if k >> 1 & 1 == 1 { top } else { bottom };
                    transform.point(DVec3::new(side(0), y, side(2)))
                })
                .collect();
            hull(&corners)
        }
        ShapeKind::Instance { group, map } => return instance_extent(group, map),
        ShapeKind::Plane { .. } => return None,
    })
}

/// Bounding box of an instance: exact for a single sphere, otherwise that of the corners of its
/// shapes' boxes.
fn instance_extent(group: &Group, map: &DAffine3) -> Option<(DVec3, DVec3)> {
    if let [Shape { kind: ShapeKind::Sphere { center, radius }, .. }] = group.shapes()[..] {
        let rows = map.matrix3.transpose();
        let half = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        let (center, half) = (map.transform_point3(center), half * radius);
        return Some((center - half, center + half));
    }
    let (low, high) = group.bounds()?;
    let (center, half) = (0.5 * (low + high), map.matrix3.abs() * (0.5 * (high - low)));
    let center = map.transform_point3(center);
    Some((center - half, center + half))
}
