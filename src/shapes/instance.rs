//! Instances: groups of shapes in object space, placed by affine maps. Twin:
//! `shaders/shapes/instance.wgsl`.
//!
//! A ray is transformed to the group's space, where its direction is again a unit vector and a
//! distance is `length` times that in scene space. The origin of a ray from afar is first moved to
//! the instance's bounding sphere, so that rounding does not grow with the distance.

use super::math::{FAR, unit};
use super::ray::Ray;
use super::real::{LEADING, Plain, Real, Vec3};
use bytemuck::Zeroable;

/// A group at one place. A scene point p is `(row_x . q, row_y . q, row_z . q)` in the group's
/// space, with q = p - center; `column_x`, `column_y`, `column_z` are the inverse matrix.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Instance {
    /// First row of the matrix to the group's space.
    pub row_x: Vec3,
    /// Index of the group.
    pub group: u32,
    /// Second row.
    pub row_y: Vec3,
    /// Material index that replaces those of the group's shapes, or
    /// [`NONE`](super::table::NONE).
    pub material: u32,
    /// Third row.
    pub row_z: Vec3,
    /// [`UV_PLANAR`](super::table::UV_PLANAR) if (u, v) are world coordinates, else
    /// [`UV_NATURAL`](super::table::UV_NATURAL).
    pub uv: u32,
    /// Origin of the group's space, the middle of its bounding box, in scene space.
    pub center: Vec3,
    /// Twice the radius of a sphere about `center` that contains all shapes, scene units.
    pub reach: Real,
    /// First column of the matrix to scene space.
    pub column_x: Vec3,
    /// Bound on the rounding error of a position in scene space, scene units.
    pub rounding: Real,
    /// Second column.
    pub column_y: Vec3,
    /// Padding to 16 bytes.
    pub pad0: u32,
    /// Third column.
    pub column_z: Vec3,
    /// Padding to 16 bytes.
    pub pad1: u32,
    /// Bounds on the rounding errors of a nearby ray in the group's space, along its axes.
    pub slack: Vec3,
    /// Padding to 16 bytes.
    pub pad2: u32,
}

/// A group of shapes with a separate kd-tree.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Group {
    /// Least corner of the kd-tree's bounding box, in the group's space.
    pub bounds_min: Vec3,
    /// Index of the kd-tree's root among all nodes; its nodes count from there.
    pub root: u32,
    /// Greatest corner of that box.
    pub bounds_max: Vec3,
    /// Index of the kd-tree's first reference among all references.
    pub first_ref: u32,
    /// See [`Tree::primitive_size`](super::kdtree::Tree::primitive_size).
    pub primitive_size: Real,
    /// Padding to 16 bytes.
    pub pad: [u32; 3],
}

/// A ray in a group's space.
#[derive(Clone, Copy, Debug)]
pub struct ObjectRay {
    /// The ray.
    pub ray: Ray,
    /// Distance along the scene's ray at which it starts, scene units.
    pub start: Real,
    /// Length in the group's space of a scene unit along the ray.
    pub length: Real,
}

/// Clears the low half of the mantissa of `x`: products of two such numbers are exact.
fn leading_part(x: Real) -> Real {
    Real::from_bits(x.to_bits() & LEADING)
}

/// Transforms `ray`, up to `t_max`, to the space of the group that `instance` places.
#[inline]
pub fn object_ray(instance: &Instance, ray: &Ray, t_max: Real) -> ObjectRay {
    // move a distant origin in front of the bounding sphere: distance and direction are split so
    // that no product rounds
    let d = ray.direction;
    let high = Vec3::new(leading_part(d.x), leading_part(d.y), leading_part(d.z));
    let low = d - high;
    let ahead = leading_part((instance.center - ray.origin).dot(d));
    let near = leading_part(ahead - instance.reach);
    let moved = near > ray.t_min;
    let start = if moved { near } else { 0.0 };
    let p = ((ray.origin + high * start) - instance.center) + low * start;
    let origin = Vec3::new(instance.row_x.dot(p), instance.row_y.dot(p), instance.row_z.dot(p));
    let direction = Vec3::new(instance.row_x.dot(d), instance.row_y.dot(d), instance.row_z.dot(d));
    let length = direction.dot(direction).sqrt();
    let t_min = if moved { 0.0 } else { ray.t_min * length };
    let t_max = ((t_max - start) * length).min(FAR);
    ObjectRay {
        ray: Ray { origin, t_min, direction: direction * (1.0 / length), t_max },
        start,
        length,
    }
}

/// Normal of an instance, not normalized: the normal `n` in the group's space by the transposed
/// matrix to that space.
pub fn placed_normal(instance: &Instance, n: Vec3) -> Vec3 {
    instance.row_x * n.x + instance.row_y * n.y + instance.row_z * n.z
}

/// Shading normal of an instance, on the side of its unit `normal`.
pub fn placed_shading(instance: &Instance, shading: Vec3, normal: Vec3) -> Vec3 {
    let m = unit(placed_normal(instance, shading));
    if m.dot(normal) >= 0.0 { m } else { -m }
}

/// Scene point at `p` in the group's space.
pub fn placed_point(instance: &Instance, p: Vec3) -> Vec3 {
    ((instance.center + instance.column_x * p.x) + instance.column_y * p.y)
        + instance.column_z * p.z
}

/// Direction or derivative `d` of the group's space in scene space, not normalized.
pub fn placed_direction(instance: &Instance, d: Vec3) -> Vec3 {
    (instance.column_x * d.x + instance.column_y * d.y) + instance.column_z * d.z
}

/// Error bound along the normal in scene space (scene units): `error` along the unit normal `n` in
/// the group's space, whose [`placed_normal`] is `inverse_length` times a unit vector, with the
/// rounding of both transforms.
pub fn placed_error(instance: &Instance, error: Real, n: Vec3, inverse_length: Real) -> Real {
    let a = n.abs();
    let own = ((error + a.x * instance.slack.x) + a.y * instance.slack.y) + a.z * instance.slack.z;
    instance.rounding + own * inverse_length
}
