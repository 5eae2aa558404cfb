//! Flat disc and infinite plane. Twin: `shaders/shapes/disc.wgsl`.

use super::math::{EPS, basis, max_abs};
use super::ray::{Hit, Ray};
use super::real::{Real, Vec2, Vec3};
use super::table::{Disc, Plane};

/// Finds the crossing in `(t_min, hit.t)`.
pub fn intersect_disc(disc: &Disc, reference: u32, ray: &Ray, hit: &mut Hit) {
    let d = ray.origin - disc.center;
    let slope = ray.direction.dot(disc.normal);
    if slope == 0.0 {
        return;
    }
    let t = -d.dot(disc.normal) / slope;
    if !(t > ray.t_min && t < hit.t) {
        return;
    }
    let p = d + ray.direction * t;
    if p.dot(p) <= disc.radius * disc.radius {
        *hit = Hit { t, reference, u: 0.0, v: 0.0, ..*hit };
    }
}

/// Bound on the distance between a projected point and the disc's plane, scene units.
pub fn disc_error(disc: &Disc) -> Real {
    16.0 * EPS * (max_abs(disc.center) + disc.radius)
}

/// Texture coordinates: the disc's bounding square in the tangents of its normal, [0, 1]^2.
pub fn disc_uv(disc: &Disc, position: Vec3) -> Vec2 {
    let (t, b) = basis(disc.normal);
    let d = (position - disc.center) * (0.5 / disc.radius);
    Vec2::new(0.5 + d.dot(t), 0.5 + d.dot(b))
}

/// Finds the crossing in `(t_min, hit.t)`.
pub fn intersect_plane(plane: &Plane, reference: u32, ray: &Ray, hit: &mut Hit) {
    let slope = ray.direction.dot(plane.normal);
    if slope == 0.0 {
        return;
    }
    let t = -(ray.origin - plane.point).dot(plane.normal) / slope;
    if t > ray.t_min && t < hit.t {
        *hit = Hit { t, reference, u: 0.0, v: 0.0, ..*hit };
    }
}

/// Projects `position` onto the plane through `point` with unit normal `normal`.
pub fn plane_project(position: Vec3, point: Vec3, normal: Vec3) -> Vec3 {
    position - normal * (position - point).dot(normal)
}

/// Bound on the distance between a projected point and the plane, scene units.
pub fn plane_error(plane: &Plane, position: Vec3) -> Real {
    16.0 * EPS * (max_abs(plane.point) + max_abs(position))
}
