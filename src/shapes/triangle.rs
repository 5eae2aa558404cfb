//! Triangles: the watertight test of Woop, Benthin & Wald (JCGT 2013) in f32. Twin:
//! `shaders/shapes/triangle.wgsl`.
//!
//! Vertices are sheared so that the ray runs along +z; three edge functions then say on which side
//! of each edge the ray passes. An edge function is a difference of two rounded products. Rounding
//! is monotone, so its sign is right or it is 0, and it is the exact negative seen from the
//! triangle on the other side: no ray slips between. Where the triangle is thin as the ray sees it,
//! the rounding of the products (Dekker 1971) is added, which makes the signs exact and the weights
//! accurate.

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
    /// Third vertex; counter-clockwise seen from the side that the normal points to.
    pub p2: Vec3,
    /// Index of its normals and texture coordinates, or [`NONE`](super::table::NONE).
    pub attributes: u32,
}

/// What the triangle test needs to know of a ray: axis permutation and shear that turn its
/// direction to +z.
#[derive(Clone, Copy, Debug)]
pub struct RayShear {
    /// `(d_x / d_z, d_y / d_z, 1 / d_z)` after the permutation.
    pub shear: Vec3,
    /// The direction's largest component, which becomes z.
    pub axis: u32,
}

impl RayShear {
    /// For tests of other shapes.
    pub const NONE: RayShear = RayShear { shear: Vec3::ZERO, axis: 0 };

    /// Once per ray.
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

/// `v` with its components turned so that `axis` comes last.
#[inline(always)]
pub(super) fn permuted(v: Vec3, axis: u32) -> Vec3 {
    match axis {
        0 => Vec3::new(v.y, v.z, v.x),
        1 => Vec3::new(v.z, v.x, v.y),
        _ => v,
    }
}

/// `p` in the ray's space: (0, 0, t) lies on the ray. The same for every triangle with this vertex.
#[inline]
fn sheared(p: Vec3, shear: &RayShear, ray: &Ray) -> Vec3 {
    let q = permuted(p - ray.origin, shear.axis);
    Vec3::new(q.x - shear.shear.x * q.z, q.y - shear.shear.y * q.z, shear.shear.z * q.z)
}

/// `a * b - p` exactly, where `p` is the rounded product (Dekker 1971, with the halves cut by a
/// mask).
fn product_error(a: Real, b: Real, p: Real) -> Real {
    let a_high = Real::from_bits(a.to_bits() & LEADING);
    let b_high = Real::from_bits(b.to_bits() & LEADING);
    let a_low = a - a_high;
    let b_low = b - b_high;
    ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// `a * d - b * c` with the right sign and a few correct digits at least.
fn exact_cross(a: Real, b: Real, c: Real, d: Real) -> Real {
    let p = a * d;
    let q = b * c;
    (p - q) + (product_error(a, d, p) - product_error(b, c, q))
}

/// Replaces `hit` if the ray meets the triangle, from either side, in `(t_min, hit.t)`. Edges
/// belong to both sides.
#[inline]
pub fn intersect_triangle(
    triangle: &Triangle,
    reference: u32,
    shear: &RayShear,
    ray: &Ray,
    hit: &mut Hit,
) {
    let a = sheared(triangle.p0, shear, ray);
    let b = sheared(triangle.p1, shear, ray);
    let c = sheared(triangle.p2, shear, ray);
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
    // Thin: the rounding of the products would move the hit by more than about 8 roundings of the
    // triangle's size.
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
        // Not negative; this settles the sign of zero.
        *hit = Hit { t, reference, u: (v / det).abs(), v: (w / det).abs() };
    }
}

/// Unit geometric normal: along `(p1 - p0) x (p2 - p0)`; +z where rounding leaves no direction.
pub fn triangle_normal(triangle: &Triangle) -> Vec3 {
    let n = (triangle.p1 - triangle.p0).cross(triangle.p2 - triangle.p0);
    let size = n.abs().x.max(n.abs().y).max(n.abs().z);
    let m = if size > 0.0 { n / size } else { Vec3::Z };
    m * (1.0 / m.dot(m).sqrt())
}

/// The point with barycentric weights `(1 - u - v, u, v)`.
pub fn triangle_point(triangle: &Triangle, u: Real, v: Real) -> Vec3 {
    triangle.p0 + (triangle.p1 - triangle.p0) * u + (triangle.p2 - triangle.p0) * v
}

/// How far (scene units) a new ray must start from [`triangle_point`] along the normal so as not to
/// meet the triangle again: 16 roundings of the largest coordinate. The point itself is off by less
/// than 6 of them, the moved origin by 2 more.
pub fn triangle_error(triangle: &Triangle) -> Real {
    let m = triangle.p0.abs().max(triangle.p1.abs()).max(triangle.p2.abs());
    16.0 * EPS * m.x.max(m.y).max(m.z)
}
