//! Orientation of closed bodies.
//!
//! The winding of a mesh's faces, or the direction of a profile, defines the outside. The sign of a
//! closed body's volume shows whether that definition is right.

use super::parts::{TRIANGLES, parts};
use crate::scene::{Mesh, ShapeKind};
use glam::{DVec2, DVec3};

/// A large mesh whose summed area vector is shorter than this fraction of its area counts as
/// closed.
const LEAST_FACING: f64 = 1e-3;
/// Number of steps along a profile segment.
const STEPS: u32 = 64;

/// Returns whether a shape is, or contains, a closed body that faces inward and lies in no other.
pub fn faces_inward(kind: &ShapeKind) -> bool {
    match kind {
        ShapeKind::Mesh(mesh) => mesh_faces_inward(mesh),
        ShapeKind::Revolution { segments, .. } => profile_faces_inward(segments),
        ShapeKind::Instance { group, .. } => {
            group.shapes().iter().any(|shape| faces_inward(&shape.kind))
        }
        ShapeKind::Sphere { .. }
        | ShapeKind::Rectangle { .. }
        | ShapeKind::Disc { .. }
        | ShapeKind::Plane { .. }
        | ShapeKind::Cuboid { .. } => false,
    }
}

/// A profile that begins and ends on the axis, or ends where it began, encloses `pi` times the
/// integral of `r^2 dy`, which is positive if its outer side is drawn upward.
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
        return large_mesh_faces_inward(mesh);
    }
    let (parts, _) = parts(mesh);
    // a shell inside another one may face inward: it is the wall of a hollow body
    parts.iter().any(|part| {
        part.closed
            && part.volume < 0.0
            && !parts.iter().any(|other| other.closed && other.holds(part))
    })
}

/// Like [`mesh_faces_inward`], for a mesh that is too large to split: treats it as one body, which
/// is closed if its area vectors cancel.
fn large_mesh_faces_inward(mesh: &Mesh) -> bool {
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let (mut volume, mut facing, mut area) = (0.0, DVec3::ZERO, 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.position.map(|i| mesh.positions[i as usize] - origin);
        let across = (b - a).cross(c - a);
        volume += a.dot(across);
        facing += across;
        area += across.length();
    }
    volume < 0.0 && facing.length() <= LEAST_FACING * area
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Triangle;

    /// Theory: a closed body whose triangles are listed clockwise faces inward, whatever their
    /// number; an open sheet has no orientation.
    #[test]
    fn large_meshes() {
        let n = 400;
        let at = |i: usize, j: usize| {
            let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
            let (phi, theta) = (std::f64::consts::TAU * u, std::f64::consts::PI * v);
            DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
        };
        let mut mesh = Mesh {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: Vec::new(),
        };
        for j in 0..=n {
            mesh.positions.extend((0..=n).map(|i| at(i, j)));
        }
        let quad = |i: usize, j: usize| {
            let a = (j * (n + 1) + i) as u32;
            let b = a + n as u32 + 1;
            [[a, a + 1, b], [b, a + 1, b + 1]]
        };
        let faces = (0..n * n).flat_map(|k| quad(k % n, k / n));
        mesh.triangles.extend(faces.map(|position| Triangle { position, uv: None, normal: None }));
        assert!(mesh.triangles.len() > TRIANGLES);
        assert!(!mesh_faces_inward(&mesh));
        mesh.triangles.iter_mut().for_each(|t| t.position.swap(0, 1));
        assert!(mesh_faces_inward(&mesh));
        mesh.triangles.truncate(TRIANGLES + 1);
        assert!(!mesh_faces_inward(&mesh));
    }
}
