//! Parallelogram. Twin: `shaders/shapes/rectangle.wgsl`.

use super::math::{EPS, max_abs};
use super::ray::{Hit, Ray};
use super::real::{Real, Vec3};
use super::table::Rectangle;

/// Distance past its edges, in edge lengths, at which a parallelogram is still hit, so that
/// neighbours that share an edge leave no gap.
pub const EDGE: Real = 8.0 * EPS;

/// Finds the crossing in `(t_min, hit.t)`; `hit.u`, `hit.v` are s and t.
pub fn intersect_rectangle(rectangle: &Rectangle, reference: u32, ray: &Ray, hit: &mut Hit) {
    let d = ray.origin - rectangle.origin;
    let slope = ray.direction.dot(rectangle.normal);
    if slope == 0.0 {
        return;
    }
    let t = -d.dot(rectangle.normal) / slope;
    if !(t > ray.t_min && t < hit.t) {
        return;
    }
    let p = d + ray.direction * t;
    let s = p.dot(rectangle.dual_u);
    let r = p.dot(rectangle.dual_v);
    let inside = -EDGE..=1.0 + EDGE;
    if inside.contains(&s) && inside.contains(&r) {
        *hit = Hit { t, reference, u: s, v: r, ..*hit };
    }
}

/// Point at (s, t).
pub fn rectangle_point(rectangle: &Rectangle, s: Real, t: Real) -> Vec3 {
    rectangle.origin + rectangle.u * s + rectangle.v * t
}

/// Bound on the distance between [`rectangle_point`] and the plane, scene units.
pub fn rectangle_error(rectangle: &Rectangle) -> Real {
    16.0 * EPS * (max_abs(rectangle.origin) + max_abs(rectangle.u) + max_abs(rectangle.v))
}
