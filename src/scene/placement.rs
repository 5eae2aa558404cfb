//! Shapes moved by affine maps, where the result is again one of the shapes.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::{Mesh, ShapeKind, Transform, Triangle};

/// Relative difference up to which lengths count as equal and directions as perpendicular.
const EXACT: f64 = 1e-12;
/// Corners of a unit box by face: counter-clockwise from outside, starting where (u, v) = (0, 0).
const FACES: [[u8; 4]; 6] =
    [[0, 4, 6, 2], [5, 1, 3, 7], [0, 1, 5, 4], [6, 7, 3, 2], [1, 0, 2, 3], [4, 5, 7, 6]];

/// Moves a shape by `map`, which is invertible, or returns `None` if the result is not one of the
/// shapes. Normals follow the inverse transpose, so that a mirrored shape keeps its sides.
/// If `textured`, the texture coordinates matter and keep their place on the shape;
/// those of planes are always world units.
pub(crate) fn placed(kind: &ShapeKind, map: &DAffine3, textured: bool) -> Option<ShapeKind> {
    let linear = map.matrix3;
    let point = |p: DVec3| map.transform_point3(p);
    let mirrors = linear.determinant() < 0.0;
    // scale of a similar map that leaves the texture coordinates in place
    let scale = || {
        let (scale, rotation) = similar(linear)?;
        let turned = !near(rotation.to_cols_array(), DMat3::IDENTITY.to_cols_array(), 1.0);
        (!textured || !turned).then_some((scale, rotation))
    };
    Some(match kind {
        ShapeKind::Sphere { center, radius } => {
            ShapeKind::Sphere { center: point(*center), radius: radius * scale()?.0 }
        }
        ShapeKind::Rectangle { origin, u, v } => {
            let (origin, u, v) = (point(*origin), linear * *u, linear * *v);
            match (mirrors, textured) {
                (false, _) => ShapeKind::Rectangle { origin, u, v },
                (true, false) => ShapeKind::Rectangle { origin: origin + u, u: -u, v },
                (true, true) => ShapeKind::Mesh(parallelogram(origin, u, v)),
            }
        }
        ShapeKind::Disc { center, normal, radius } => {
            let (scale, rotation) = scale()?;
            let normal = (rotation * *normal).normalize();
            ShapeKind::Disc { center: point(*center), normal, radius: radius * scale }
        }
        ShapeKind::Plane { point: at, normal } => ShapeKind::Plane {
            point: point(*at),
            normal: (linear.inverse().transpose() * *normal).normalize(),
        },
        ShapeKind::Cuboid { min, max } => match straight(linear, textured) {
            true => {
                let (a, b) = (point(*min), point(*max));
                ShapeKind::Cuboid { min: a.min(b), max: a.max(b) }
            }
            false => ShapeKind::Mesh(moved_mesh(&cuboid_mesh(*min, *max, textured), map)),
        },
        ShapeKind::Mesh(mesh) => ShapeKind::Mesh(moved_mesh(mesh, map)),
        ShapeKind::Revolution { segments, transform, newton_tolerance } => {
            let (scale, height, rotation) = along_axis(linear * own_linear(transform), textured)?;
            let stretched = |p: &DVec2| DVec2::new(p.x, p.y * height);
            let segment = |points: &Vec<DVec2>| points.iter().map(stretched).collect();
            let transform =
                Transform { scale, rotation, translation: point(transform.translation) };
            ShapeKind::Revolution {
                segments: segments.iter().map(segment).collect(),
                transform,
                newton_tolerance: *newton_tolerance,
            }
        }
        ShapeKind::Instance { group, map: own } => {
            ShapeKind::Instance { group: group.clone(), map: *map * *own }
        }
    })
}

/// Returns whether numbers agree up to rounding of numbers of this `size`.
fn near<const N: usize>(a: [f64; N], b: [f64; N], size: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= EXACT * size)
}

/// Scale and orthogonal matrix of a similar map; `None` for any other map.
fn similar(linear: DMat3) -> Option<(f64, DMat3)> {
    let scale = linear.determinant().abs().cbrt();
    let rotation = linear * (1.0 / scale);
    let square = rotation.transpose() * rotation;
    let exact = near(square.to_cols_array(), DMat3::IDENTITY.to_cols_array(), 4.0);
    exact.then_some((scale, rotation))
}

/// Radial scale, stretch along the axis relative to it, and rotation of a map that leaves surfaces
/// about the y axis surfaces of revolution. A surface of revolution is its own mirror image, but
/// for its texture coordinates.
fn along_axis(linear: DMat3, textured: bool) -> Option<(f64, f64, DMat3)> {
    let DMat3 { x_axis, y_axis, mut z_axis } = linear;
    if linear.determinant() < 0.0 {
        if textured {
            return None;
        }
        z_axis = -z_axis;
    }
    let [x, y, z] = [x_axis, y_axis, z_axis].map(DVec3::length);
    let rotation = DMat3::from_cols(x_axis / x, y_axis / y, z_axis / z);
    let square = rotation.transpose() * rotation;
    let exact = near(square.to_cols_array(), DMat3::IDENTITY.to_cols_array(), 4.0)
        && near([x], [z], 4.0 * x);
    exact.then_some((x, if near([x], [y], 4.0 * x) { 1.0 } else { y / x }, rotation))
}

fn own_linear(transform: &Transform) -> DMat3 {
    transform.rotation * transform.scale
}

/// Returns whether a map leaves an axis-aligned box aligned: it scales the axes and, if the texture
/// coordinates do not matter, exchanges and mirrors them.
fn straight(linear: DMat3, textured: bool) -> bool {
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    columns.iter().enumerate().all(|(j, column)| {
        let longest = column.abs().max_position();
        let along = DVec3::AXES[longest] * column[longest];
        let aligned = near(column.to_array(), along.to_array(), column.length());
        aligned && (!textured || (longest == j && column[j] > 0.0))
    })
}

/// Normals keep the ratios of their lengths, so that interpolated ones are the images of those
/// before; the longest is a unit vector.
fn moved_mesh(mesh: &Mesh, map: &DAffine3) -> Mesh {
    let upright = map.matrix3.inverse().transpose();
    let longest = mesh.normals.iter().map(|n| (upright * *n).length()).fold(0.0, f64::max);
    let upright = if longest > 0.0 { upright * (1.0 / longest) } else { upright };
    let mirrors = map.matrix3.determinant() < 0.0;
    let turned = |mut corners: [u32; 3]| {
        if mirrors {
            corners.swap(1, 2);
        }
        corners
    };
    let triangle = |t: &Triangle| Triangle {
        position: turned(t.position),
        normal: t.normal.map(turned),
        uv: t.uv.map(turned),
    };
    Mesh {
        positions: mesh.positions.iter().map(|p| map.transform_point3(*p)).collect(),
        normals: mesh.normals.iter().map(|n| upright * *n).collect(),
        uvs: mesh.uvs.clone(),
        triangles: mesh.triangles.iter().map(triangle).collect(),
    }
}

/// Mirrored rectangle: the same points and texture coordinates, seen from the other side.
fn parallelogram(origin: DVec3, u: DVec3, v: DVec3) -> Mesh {
    let triangle = |position: [u32; 3]| Triangle { position, normal: None, uv: Some(position) };
    Mesh {
        positions: vec![origin, origin + u, origin + u + v, origin + v],
        normals: Vec::new(),
        uvs: vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
        triangles: vec![triangle([0, 2, 1]), triangle([0, 3, 2])],
    }
}

/// Closed mesh of an axis-aligned box, with its texture coordinates if they matter.
fn cuboid_mesh(min: DVec3, max: DVec3, textured: bool) -> Mesh {
    let corner = |k: u8| {
        let side = |axis: usize| if k >> axis & 1 == 1 { max[axis] } else { min[axis] };
        DVec3::new(side(0), side(1), side(2))
    };
    let half = |[a, b, c]: [usize; 3], face: &[u8; 4]| Triangle {
        position: [face[a], face[b], face[c]].map(u32::from),
        normal: None,
        uv: textured.then_some([a as u32, b as u32, c as u32]),
    };
    let face = |face: &[u8; 4]| [half([0, 1, 2], face), half([0, 2, 3], face)];
    Mesh {
        positions: (0..8).map(corner).collect(),
        normals: Vec::new(),
        uvs: vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
        triangles: FACES.iter().flat_map(face).collect(),
    }
}
