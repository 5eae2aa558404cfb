//! Axis-parallel box, intersected by slabs. Twin: `shaders/shapes/cuboid.wgsl`.

use super::math::{EPS, FAR, max_abs};
use super::ray::{Hit, Ray};
use super::real::{Real, Vec2, Vec3};
use super::table::Cuboid;

/// Finds the nearest crossing in `(t_min, hit.t)`; `hit.u` is the face: its axis, plus 3 for the
/// upper side.
pub fn intersect_cuboid(cuboid: &Cuboid, reference: u32, ray: &Ray, hit: &mut Hit) {
    let mut near = -FAR;
    let mut far = FAR;
    let mut near_face = 0.0;
    let mut far_face = 0.0;
    for axis in 0..3 {
        let v = ray.direction[axis];
        let a = cuboid.lower[axis] - ray.origin[axis];
        let b = cuboid.upper[axis] - ray.origin[axis];
        if v == 0.0 {
            if a > 0.0 || b < 0.0 {
                return;
            }
            continue;
        }
        let upward = v > 0.0;
        let t0 = if upward { a } else { b } / v;
        let t1 = if upward { b } else { a } / v;
        let face = axis as Real;
        if t0 > near {
            near = t0;
            near_face = if upward { face } else { face + 3.0 };
        }
        if t1 < far {
            far = t1;
            far_face = if upward { face + 3.0 } else { face };
        }
    }
    if near > far {
        return;
    }
    let from_outside = near > ray.t_min;
    let t = if from_outside { near } else { far };
    if t > ray.t_min && t < hit.t {
        *hit = Hit {
            t,
            reference,
            u: if from_outside { near_face } else { far_face },
            v: 0.0,
            ..*hit
        };
    }
}

/// Axis that a face is perpendicular to.
pub fn cuboid_axis(face: Real) -> u32 {
    face as u32 % 3
}

/// Outward normal of a face.
pub fn cuboid_normal(face: Real) -> Vec3 {
    let s = if face >= 3.0 { 1.0 } else { -1.0 };
    let axis = if face >= 3.0 { face - 3.0 } else { face };
    Vec3::new(
        if axis == 0.0 { s } else { 0.0 },
        if axis == 1.0 { s } else { 0.0 },
        if axis == 2.0 { s } else { 0.0 },
    )
}

/// Projects `position` onto a face.
pub fn cuboid_project(cuboid: &Cuboid, position: Vec3, face: Real) -> Vec3 {
    let n = cuboid_normal(face);
    let corner = if face >= 3.0 { cuboid.upper } else { cuboid.lower };
    position + (corner - position) * n.abs()
}

/// Bound on the distance between a projected point and its face, scene units.
pub fn cuboid_error(cuboid: &Cuboid) -> Real {
    16.0 * EPS * max_abs(cuboid.lower).max(max_abs(cuboid.upper))
}

/// Texture coordinates: each face is the unit square, upright and not mirrored as seen from
/// outside. On the sides v runs along +y, on the top along -z, on the bottom along +z.
pub fn cuboid_uv(cuboid: &Cuboid, position: Vec3, face: Real) -> Vec2 {
    let q = (position - cuboid.lower) / (cuboid.upper - cuboid.lower);
    let n = cuboid_normal(face);
    if n.x != 0.0 {
        return Vec2::new(if n.x > 0.0 { 1.0 - q.z } else { q.z }, q.y);
    }
    if n.y != 0.0 {
        return Vec2::new(q.x, if n.y > 0.0 { 1.0 - q.z } else { q.z });
    }
    Vec2::new(if n.z > 0.0 { q.x } else { 1.0 - q.x }, q.y)
}
