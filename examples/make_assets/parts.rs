//! Parts of buildings.

use crate::assets::mesh::Mesh;
use crate::assets::numbers::sin_cos;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::PI;

/// A bar with a rectangular section from `a` to `b`: `high` to both sides of the line, `out` before
/// and behind.
pub fn beam(mesh: &mut Mesh, a: DVec3, b: DVec3, up: DVec3, high: f64, out: f64) {
    let along = b - a;
    let across = along.normalize().cross(up);
    let frame = [along, up * (2.0 * high), across * (2.0 * out)];
    let origin = a - up * high - across * out;
    let mut bar = Mesh::default();
    bar.cuboid(DVec3::ZERO, DVec3::ONE, |p, n| {
        let size = DVec3::from_array(frame.map(|edge| edge.length()));
        metres(p * size, n) / 1.2
    });
    let [fx, fy, fz] = frame;
    for p in &mut bar.positions {
        *p = fx * p.x + fy * p.y + fz * p.z;
    }
    let axes = frame.map(DVec3::normalize);
    for n in &mut bar.normals {
        *n = axes[0] * n.x + axes[1] * n.y + axes[2] * n.z;
    }
    mesh.append(&bar, DMat3::IDENTITY, origin);
}

/// `mesh.append`, keeping the other's materials.
pub fn append_with_materials(mesh: &mut Mesh, other: &Mesh, rotate: DMat3, translate: DVec3) {
    let first = mesh.triangles.len();
    mesh.groups.extend(other.groups.iter().map(|&(material, start)| (material, first + start)));
    mesh.append(other, rotate, translate);
}

/// The upper half of a tube, for ridge tiles.
pub fn half_pipe(mesh: &mut Mesh, a: DVec3, b: DVec3, radius: f64) {
    let forward = (b - a).normalize();
    let across = forward.cross(DVec3::Y);
    mesh.grid(2, 9, |row, col| {
        let (s, c) = sin_cos(PI * (col as f64 / 8.0 * 1.2 - 0.1));
        let out = DVec3::Y * s - across * c;
        (if row == 0 { a } else { b } + out * radius, out, DVec2::ZERO)
    });
    for (end, turn) in [(a, 1.0), (b, -1.0)] {
        let rim = (0..9).map(|k| {
            let (s, c) = sin_cos(PI * (f64::from(k) / 8.0 * 1.2 - 0.1));
            (end + (DVec3::Y * s + across * (c * turn)) * radius, DVec2::ZERO)
        });
        mesh.polygon(&rim.collect::<Vec<_>>());
    }
}

/// World metres along a flat side with this normal: across and up on walls, x and z on what is
/// level.
pub fn metres(p: DVec3, normal: DVec3) -> DVec2 {
    if normal.y.abs() > 0.5 {
        DVec2::new(p.x, -p.z)
    } else if normal.x.abs() > 0.5 {
        DVec2::new(-p.z * normal.x.signum(), p.y)
    } else {
        DVec2::new(p.x * normal.z.signum(), p.y)
    }
}
