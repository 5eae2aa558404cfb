//! Sampling of points on emitting shapes. Twin: `shaders/lights/shape.wgsl`.

use super::math::sampling::{sample_cone, sample_disc, sample_sphere, sample_triangle};
use super::math::{FAR, PI, TAU, basis, from_frame, unit};
use super::real::{Real, Vec2, Vec3};
use super::select::find_interval;
use super::shapes::cuboid::{cuboid_error, cuboid_normal};
use super::shapes::disc::disc_error;
use super::shapes::rectangle::{rectangle_error, rectangle_point};
use super::shapes::revolution::{revolution_surface, ring_point};
use super::shapes::sphere::{sphere_error, sphere_project};
use super::shapes::triangle::{triangle_error, triangle_normal, triangle_point};
use super::tables::*;

/// Sampled point on a shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapePoint {
    /// Position in scene space.
    pub position: Vec3,
    /// Bound on the distance from the true surface, scene units.
    pub error: Real,
    /// Unit normal on the emitting side.
    pub normal: Vec3,
    /// Density per area.
    pub pdf: Real,
}

/// Samples a point on the shape of an area light, uniform by area except on surfaces of revolution.
/// `w` is a third uniform number, which chooses a face or a patch.
pub fn sample_shape(scene: &SceneTables, light: &Light, u: Vec2, w: Real) -> ShapePoint {
    let index = index_of(light.reference) as usize;
    let pdf = 1.0 / light.area;
    match kind_of(light.reference) {
        KIND_TRIANGLE => {
            let triangle = &scene.triangles[index];
            let b = sample_triangle(u);
            ShapePoint {
                position: triangle_point(triangle, b.x, b.y),
                error: triangle_error(triangle),
                normal: triangle_normal(triangle),
                pdf,
            }
        }
        KIND_SPHERE => {
            let sphere = &scene.spheres[index];
            let n = sample_sphere(u);
            let center = sphere.anchor - sphere.normal * sphere.radius;
            let p = sphere_project(sphere, center + n * sphere.radius);
            ShapePoint { position: p, error: sphere_error(sphere, p), normal: n, pdf }
        }
        KIND_RECTANGLE => {
            let rectangle = &scene.rectangles[index];
            ShapePoint {
                position: rectangle_point(rectangle, u.x, u.y),
                error: rectangle_error(rectangle),
                normal: rectangle.normal,
                pdf,
            }
        }
        KIND_DISC => {
            let disc = &scene.discs[index];
            let d = sample_disc(u) * disc.radius;
            let (t, b) = basis(disc.normal);
            ShapePoint {
                position: disc.center + t * d.x + b * d.y,
                error: disc_error(disc),
                normal: disc.normal,
                pdf,
            }
        }
        KIND_CUBOID => {
            let cuboid = &scene.cuboids[index];
            let e = cuboid.upper - cuboid.lower;
            let x = e.y * e.z;
            let y = e.z * e.x;
            // choose a pair of opposite faces by area, then one of the two
            let pick = w * light.area;
            let upper = if u.x < 0.5 { 3.0 } else { 0.0 };
            let s = if u.x < 0.5 { 2.0 * u.x } else { 2.0 * u.x - 1.0 };
            let axis = if pick < 2.0 * x {
                0.0
            } else if pick < 2.0 * (x + y) {
                1.0
            } else {
                2.0
            };
            let n = cuboid_normal(axis + upper);
            let face = upper * (1.0 / 3.0);
            let mut q = Vec3::new(s, u.y, face);
            if axis == 0.0 {
                q = Vec3::new(face, u.y, s);
            } else if axis == 1.0 {
                q = Vec3::new(s, face, u.y);
            }
            ShapePoint {
                position: cuboid.lower + e * q,
                error: cuboid_error(cuboid),
                normal: n,
                pdf,
            }
        }
        _ => {
            let k = find_interval(scene, light.first + light.patch_count, light.patch_count, w);
            let start = scene.distributions[(light.first + k) as usize];
            let end = if k + 1 < light.patch_count {
                scene.distributions[(light.first + k + 1) as usize]
            } else {
                1.0
            };
            let v = start + (end - start) * u.x;
            let r = patch_point(scene, light, k, v, TAU * u.y - PI);
            ShapePoint {
                position: r.position,
                error: r.error,
                normal: r.normal,
                pdf: pdf_patch(scene, light, k, end - start) / r.stretch.max(1e-30),
            }
        }
    }
}

/// Samples a point on the hemisphere of a spherical light that faces `direction`, uniform on the
/// disc visible from there.
pub fn sample_sphere_facing(
    scene: &SceneTables,
    light: &Light,
    u: Vec2,
    direction: Vec3,
) -> ShapePoint {
    let sphere = &scene.spheres[index_of(light.reference) as usize];
    let d = sample_disc(u);
    let n = unit(from_frame(direction, Vec3::new(d.x, d.y, (1.0 - u.x).sqrt())));
    let center = sphere.anchor - sphere.normal * sphere.radius;
    let p = sphere_project(sphere, center + n * sphere.radius);
    ShapePoint { position: p, error: sphere_error(sphere, p), normal: n, pdf: 1.0 / light.area }
}

/// Point of a surface of revolution, and its area per unit of v for a full turn (`stretch`).
struct PatchPoint {
    position: Vec3,
    error: Real,
    normal: Vec3,
    stretch: Real,
}

/// Point of a revolution light at profile parameter `v` in its patch `k` and angle `theta`.
fn patch_point(scene: &SceneTables, light: &Light, k: u32, v: Real, theta: Real) -> PatchPoint {
    let patch = &scene.patches[(light.patch_first + k) as usize];
    let revolution = &scene.revolutions[patch.revolution as usize];
    let t = v * revolution.segments as Real - patch.segment as Real;
    let tau = ((t - patch.t0) / (patch.t1 - patch.t0)).clamp(0.0, 1.0);
    let s = revolution_surface(&scene.profile_points, revolution, patch, theta, tau);
    let ring = ring_point(&scene.profile_points, patch, theta, tau);
    let by_v = ring.d_tau * (revolution.segments as Real / (patch.t1 - patch.t0));
    let stretch = ring.d_theta.cross(by_v);
    PatchPoint {
        position: s.position,
        error: s.error,
        normal: s.normal,
        stretch: stretch.dot(stretch).sqrt() * (TAU * revolution.scale * revolution.scale),
    }
}

/// Density per unit of v in the part of patch `k`, which has length `width`.
fn pdf_patch(scene: &SceneTables, light: &Light, k: u32, width: Real) -> Real {
    let at = light.first + light.patch_count + k;
    let low = if k > 0 { scene.distributions[(at - 1) as usize] } else { 0.0 };
    (scene.distributions[at as usize] - low) / width
}

/// Density in bin `bin` of `count` equal bins on [0, 1), from the cumulative values at `first`.
pub fn pdf_bin(scene: &SceneTables, first: u32, bin: u32, count: u32) -> Real {
    let high = scene.distributions[(first + bin) as usize];
    let low = if bin > 0 { scene.distributions[(first + bin - 1) as usize] } else { 0.0 };
    (high - low) * count as Real
}

/// Density per area of [`sample_shape`] at a point with profile parameter `v` (used only for
/// surfaces of revolution).
pub fn pdf_shape(scene: &SceneTables, light: &Light, v: Real) -> Real {
    if kind_of(light.reference) == KIND_REVOLUTION {
        // last patch whose part starts at or before v
        let k = find_interval(scene, light.first, light.patch_count, v);
        let k =
            if k > 0 && scene.distributions[(light.first + k) as usize] > v { k - 1 } else { k };
        let start = scene.distributions[(light.first + k) as usize];
        let end = if k + 1 < light.patch_count {
            scene.distributions[(light.first + k + 1) as usize]
        } else {
            1.0
        };
        let r = patch_point(scene, light, k, v, 0.0);
        return pdf_patch(scene, light, k, end - start) / r.stretch.max(1e-30);
    }
    1.0 / light.area
}

/// Samples a point on an emitting sphere, uniform in the cone that it subtends at `from`, which is
/// outside. `pdf` is per solid angle here.
pub fn sample_sphere_cone(sphere: &Sphere, from: Vec3, u: Vec2) -> ShapePoint {
    let center = sphere.anchor - sphere.normal * sphere.radius;
    let d = center - from;
    let dist_sq = d.dot(d);
    let sin_sq = sphere.radius * sphere.radius / dist_sq;
    let one_minus_cos = cone_one_minus_cos(sin_sq);
    let local = sample_cone(u, one_minus_cos);
    let w = from_frame(unit(d), local);
    // nearest crossing of the ray with the sphere, clamped at the tangent; computed from the sine,
    // since the distances to the centre and the rim of a small sphere differ by less than a
    // rounding
    let along = dist_sq.sqrt() * local.z;
    let off_sq = (local.x * local.x + local.y * local.y) / sin_sq;
    let half = sphere.radius * (1.0 - off_sq).max(0.0).sqrt();
    let p = sphere_project(sphere, from + w * (along - half));
    ShapePoint {
        position: p,
        error: sphere_error(sphere, p),
        normal: unit(p - center),
        pdf: 1.0 / (TAU * one_minus_cos),
    }
}

/// `1 - cos` of the half-angle whose squared sine is `sin_sq`.
pub fn cone_one_minus_cos(sin_sq: Real) -> Real {
    sin_sq / (1.0 + (1.0 - sin_sq).max(0.0).sqrt())
}

/// Density per solid angle of [`sample_sphere_cone`] in a direction towards the sphere from `from`;
/// 0 if `from` is inside.
pub fn pdf_sphere_cone(sphere: &Sphere, from: Vec3) -> Real {
    let d = sphere.anchor - sphere.normal * sphere.radius - from;
    let sin_sq = sphere.radius * sphere.radius / d.dot(d);
    if sin_sq >= 1.0 {
        return 0.0;
    }
    1.0 / (TAU * cone_one_minus_cos(sin_sq)).max(1.0 / FAR)
}
