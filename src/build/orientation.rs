//! Which side of a closed body its surface faces.
//!
//! The winding of a mesh's faces, and the direction of a profile, say where outside is. Of a closed body
//! the signed volume tells whether that is so.

use super::parts::{TRIANGLES, parts};
use crate::scene::{Mesh, ShapeKind};
use glam::DVec2;

/// Points of a profile's segment.
const STEPS: u32 = 64;

/// Whether a shape is a closed body, or has one, that faces inward and lies in no other.
pub fn faces_inward(kind: &ShapeKind) -> bool {
    match kind {
        ShapeKind::Mesh(mesh) => mesh_faces_inward(mesh),
        ShapeKind::Revolution { segments, .. } => profile_faces_inward(segments),
        ShapeKind::Sphere { .. }
        | ShapeKind::Rectangle { .. }
        | ShapeKind::Disc { .. }
        | ShapeKind::Plane { .. }
        | ShapeKind::Cuboid { .. } => false,
    }
}

/// A profile that begins and ends on the axis, or where it began, encloses `pi` times the integral of
/// `r^2 dy`: above zero where it is drawn upward on its outer side.
fn profile_faces_inward(segments: &[Vec<DVec2>]) -> bool {
    let ends = segments.first().and_then(|s| s.first()).zip(segments.last().and_then(|s| s.last()));
    let closed = ends.is_some_and(|(a, b)| (a.x == 0.0 && b.x == 0.0) || a == b);
    let volume = |segment: &Vec<DVec2>| {
        let points: Vec<DVec2> =
            (0..=STEPS).map(|k| de_casteljau(segment, f64::from(k) / f64::from(STEPS))).collect();
        let slice = |pair: &[DVec2]| {
            let (a, b) = (pair[0], pair[1]);
            (b.y - a.y) * (a.x * a.x + a.x * b.x + b.x * b.x) / 3.0
        };
        points.windows(2).map(slice).sum::<f64>()
    };
    closed && segments.iter().map(volume).sum::<f64>() < 0.0
}

fn de_casteljau(points: &[DVec2], t: f64) -> DVec2 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|pair| pair[0].lerp(pair[1], t)).collect();
    }
    points.first().copied().unwrap_or_default()
}

fn mesh_faces_inward(mesh: &Mesh) -> bool {
    if mesh.triangles.len() > TRIANGLES {
        return false;
    }
    let (parts, _) = parts(mesh);
    // a shell within another one may face inward: the wall of a hollow body
    parts.iter().any(|part| {
        part.closed && part.volume < 0.0 && !parts.iter().any(|other| other.closed && other.holds(part))
    })
}
