//! Triangles: watertight ray-triangle test of Woop, Benthin & Wald (JCGT 2013) in f32. Twin:
//! `shaders/shapes/triangle.wgsl`.
//!
//! Vertices are sheared so that the ray runs along +z; the signs of three edge functions then give
//! the side of each edge on which the ray passes. An edge function is a difference of two rounded
//! products. Rounding is monotone, so its sign is either correct or 0, and the adjacent triangle
//! computes its exact negative: no ray slips between the two. For triangles that are thin in
//! projection, the test adds the rounding errors of the products (Dekker 1971), which makes the
//! signs exact and the weights accurate.

use super::math::EPS;
use super::ray::{Hit, Ray};
use super::real::{LEADING, Plain, Real, Vec3};
use bytemuck::Zeroable;

/// A triangle in scene space.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Triangle {
    /// First vertex.
    pub p0: Vec3,
    /// Material index.
    pub material: u32,
    /// Second vertex.
    pub p1: Vec3,
    /// Light index or [`NONE`](super::table::NONE).
    pub light: u32,
    /// Third vertex; the vertices are counter-clockwise seen from the side the normal points to.
    pub p2: Vec3,
    /// Index of its normals and texture coordinates in the attribute table, or
    /// [`NONE`](super::table::NONE).
    pub attributes: u32,
}

/// Per-ray constants of the triangle test: the axis permutation and the shear that map the ray's
/// direction to +z.
#[derive(Clone, Copy, Debug)]
pub struct RayShear {
    /// `(d_x / d_z, d_y / d_z, 1 / d_z)` after the permutation.
    pub shear: Vec3,
    /// Axis of the direction's largest component, which becomes z.
    pub axis: u32,
}

impl RayShear {
    /// Placeholder for tests of other shapes, which ignore it.
    pub const NONE: RayShear = RayShear { shear: Vec3::ZERO, axis: 0 };

    /// Computes the constants for `ray`, once per ray.
    #[inline]
    pub fn new(ray: &Ray) -> RayShear {
        let a = ray.direction.abs();
        let axis = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        let d = permuted(ray.direction, axis);
        RayShear { shear: Vec3::new(d.x / d.z, d.y / d.z, 1.0 / d.z), axis }
    }
}

/// Rotates the components of `v` cyclically so that `axis` comes last.
#[inline(always)]
pub(super) fn permuted(v: Vec3, axis: u32) -> Vec3 {
    match axis {
        0 => Vec3::new(v.y, v.z, v.x),
        1 => Vec3::new(v.z, v.x, v.y),
        _ => v,
    }
}

/// Maps `p` to the ray's space, where the ray is (0, 0, t). Deterministic, so triangles that share
/// a vertex get the same result.
#[inline]
fn sheared(p: Vec3, shear: &RayShear, ray: &Ray) -> Vec3 {
    let q = permuted(p - ray.origin, shear.axis);
    Vec3::new(q.x - shear.shear.x * q.z, q.y - shear.shear.y * q.z, shear.shear.z * q.z)
}

/// Returns `a * b - p` exactly, where `p` is the rounded product (Dekker 1971, splitting the
/// factors with a bit mask).
fn product_error(a: Real, b: Real, p: Real) -> Real {
    let a_high = Real::from_bits(a.to_bits() & LEADING);
    let b_high = Real::from_bits(b.to_bits() & LEADING);
    let a_low = a - a_high;
    let b_low = b - b_high;
    ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// Returns `a * d - b * c` with the exact sign and at least a few correct digits.
fn exact_cross(a: Real, b: Real, c: Real, d: Real) -> Real {
    let p = a * d;
    let q = b * c;
    (p - q) + (product_error(a, d, p) - product_error(b, c, q))
}

/// Replaces `hit` if the ray meets the triangle, from either side, in `(t_min, hit.t)`. Edges
/// belong to both of the triangles that share them.
#[inline]
pub fn intersect_triangle(
    triangle: &Triangle,
    reference: u32,
    shear: &RayShear,
    ray: &Ray,
    hit: &mut Hit,
) {
    // shear the vertices into the ray's space
    let a = sheared(triangle.p0, shear, ray);
    let b = sheared(triangle.p1, shear, ray);
    let c = sheared(triangle.p2, shear, ray);
    // edge functions; the ray misses if their signs differ
    let cb0 = c.x * b.y;
    let cb1 = c.y * b.x;
    let ac0 = a.x * c.y;
    let ac1 = a.y * c.x;
    let ba0 = b.x * a.y;
    let ba1 = b.y * a.x;
    let mut u = cb0 - cb1;
    let mut v = ac0 - ac1;
    let mut w = ba0 - ba1;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return;
    }
    let mut det = u + v + w;
    // Thin in projection: the rounding of the products would move the hit by more than about 8
    // roundings of the triangle's size.
    let products =
        cb0.abs().max(cb1.abs()).max(ac0.abs()).max(ac1.abs()).max(ba0.abs()).max(ba1.abs());
    if det.abs() < 0.5 * products {
        u = exact_cross(c.x, c.y, b.x, b.y);
        v = exact_cross(a.x, a.y, c.x, c.y);
        w = exact_cross(b.x, b.y, a.x, a.y);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return;
        }
        det = u + v + w;
    }
    if det == 0.0 {
        return;
    }
    let t = (u * a.z + v * b.z + w * c.z) / det;
    if t > ray.t_min && t < hit.t {
        // `abs` only fixes the sign of zero: the quotient is never negative
        *hit = Hit { t, reference, u: (v / det).abs(), v: (w / det).abs(), ..*hit };
    }
}

/// Unit geometric normal along `(p1 - p0) x (p2 - p0)`; +z if the cross product rounds to zero.
pub fn triangle_normal(triangle: &Triangle) -> Vec3 {
    let n = (triangle.p1 - triangle.p0).cross(triangle.p2 - triangle.p0);
    let size = n.abs().x.max(n.abs().y).max(n.abs().z);
    let m = if size > 0.0 { n / size } else { Vec3::Z };
    m * (1.0 / m.dot(m).sqrt())
}

/// Point with barycentric weights `(1 - u - v, u, v)`.
pub fn triangle_point(triangle: &Triangle, u: Real, v: Real) -> Vec3 {
    triangle.p0 + (triangle.p1 - triangle.p0) * u + (triangle.p2 - triangle.p0) * v
}

/// Offset (scene units) along the normal from [`triangle_point`] at which a new ray must start so
/// that it does not hit the triangle again: 16 EPS times the largest coordinate. The error of the
/// point itself is below 6 EPS, that of the offset origin at most 2 EPS more.
pub fn triangle_error(triangle: &Triangle) -> Real {
    let m = triangle.p0.abs().max(triangle.p1.abs()).max(triangle.p2.abs());
    16.0 * EPS * m.x.max(m.y).max(m.z)
}
