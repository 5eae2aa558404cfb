//! Sphere of any radius, described relative to an anchor on its surface so that f32 is accurate for
//! radii from 1e-6 to 1e8. With d = o - anchor and k = 1/R, a ray o + t v meets it where
//! `(k/2) t^2 + (v.n + k d.v) t + (d.n + k |d|^2 / 2) = 0`. Twin: `shaders/shapes/sphere.wgsl`.

use super::math::{EPS, PI, TAU, max_abs, trig::arctan2, unit};
use super::ray::{Hit, Ray};
use super::real::{Real, Vec2, Vec3};
use super::table::Sphere;

/// Finds the nearest crossing in `(t_min, hit.t)`.
pub fn intersect_sphere(sphere: &Sphere, reference: u32, ray: &Ray, hit: &mut Hit) {
    let k = sphere.curvature;
    let d0 = ray.origin - sphere.anchor;
    let side = d0.dot(sphere.normal) + 0.5 * k * d0.dot(d0);
    // rays from infinity start behind their origin, so the side of the origin is irrelevant
    let backward = ray.t_min < 0.0;
    if !backward
        && side >= 0.0
        && ray.direction.dot(sphere.normal) + k * d0.dot(ray.direction) >= 0.0
    {
        return;
    }
    // solve from the point of the ray nearest to the anchor: small numbers however distant the
    // origin
    let t0 = -d0.dot(ray.direction);
    let d = d0 + ray.direction * t0;
    let b = ray.direction.dot(sphere.normal) + k * d.dot(ray.direction);
    let c = d.dot(sphere.normal) + 0.5 * k * d.dot(d);
    // roots of the quadratic without cancellation
    let discriminant = b * b - 2.0 * k * c;
    if discriminant < 0.0 {
        return;
    }
    let root = discriminant.sqrt();
    let q = if b >= 0.0 { -(b + root) } else { root - b };
    let t1 = q / k;
    let t2 = if q == 0.0 { t1 } else { 2.0 * c / q };
    let near = t0 + t1.min(t2);
    let far = t0 + t1.max(t2);
    let from_outside = if backward { near > ray.t_min } else { side >= 0.0 };
    let t = if from_outside { near } else { far };
    if t > ray.t_min && t < hit.t {
        *hit = Hit { t, reference, u: 0.0, v: 0.0, ..*hit };
    }
}

/// Outward unit normal at a point on or near the sphere.
pub fn sphere_normal(sphere: &Sphere, position: Vec3) -> Vec3 {
    unit(sphere.normal + (position - sphere.anchor) * sphere.curvature)
}

/// Projects `position` onto the sphere, to first order in its distance.
pub fn sphere_project(sphere: &Sphere, position: Vec3) -> Vec3 {
    let d = position - sphere.anchor;
    let c = d.dot(sphere.normal) + 0.5 * sphere.curvature * d.dot(d);
    position - sphere_normal(sphere, position) * c
}

/// Bound on the distance between a projected point and the true sphere, scene units.
pub fn sphere_error(sphere: &Sphere, position: Vec3) -> Real {
    16.0 * EPS * (max_abs(sphere.anchor) + max_abs(position - sphere.anchor))
}

/// Texture coordinates: u = 0.5 - arctan2(z, x) / 2 pi; v, by angle, runs from the south pole (0)
/// to the north pole (1).
pub fn sphere_uv(n: Vec3) -> Vec2 {
    let r = (n.x * n.x + n.z * n.z).sqrt();
    Vec2::new(0.5 - arctan2(n.z, n.x) * (1.0 / TAU), 0.5 + arctan2(n.y, r) * (1.0 / PI))
}
