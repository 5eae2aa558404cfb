//! Area lights: shapes that emit evenly from the side of their normal. `color` is the radiance and
//! `reference` the shape. Twin: `shaders/lights/area.wgsl`.

use super::emission::Emission;
use super::light::LightSample;
use super::math::sampling::{sample_cosine, sample_sphere};
use super::math::{EPS, FAR, PI, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::share_of;
use super::shape::{
    pdf_shape, pdf_sphere_cone, sample_shape, sample_sphere_cone, sample_sphere_facing,
};
use super::shapes::ray::Ray;
use super::tables::*;

/// Samples the light at `position`: the cone that a sphere subtends, or the area of another shape.
#[inline(always)]
pub fn light_from_area(
    scene: &SceneTables,
    light: &Light,
    share: Real,
    position: Vec3,
    u: Vec4,
) -> LightSample {
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = &scene.spheres[index_of(light.reference) as usize];
        if pdf_sphere_cone(sphere, position) > 0.0 {
            let p = sample_sphere_cone(sphere, position, Vec2::new(u.y, u.z));
            let to = p.position + p.normal * p.error - position;
            let dist_sq = to.dot(to);
            // on the lamp itself
            if dist_sq == 0.0 {
                return LightSample::NONE;
            }
            let distance = dist_sq.sqrt();
            return LightSample {
                direction: to * (1.0 / distance),
                distance: distance * (1.0 - 16.0 * EPS),
                radiance: light.color,
                pdf: p.pdf * share,
                extended: true,
            };
        }
    }
    let p = sample_shape(scene, light, Vec2::new(u.y, u.z), u.w);
    let to = p.position + p.normal * p.error - position;
    let dist_sq = to.dot(to);
    if dist_sq == 0.0 {
        return LightSample::NONE;
    }
    let distance = dist_sq.sqrt();
    let direction = to * (1.0 / distance);
    let cos = -direction.dot(p.normal);
    if cos <= 0.0 {
        return LightSample::NONE;
    }
    LightSample {
        direction,
        distance: distance * (1.0 - 16.0 * EPS),
        radiance: light.color,
        pdf: p.pdf * dist_sq / cos * share,
        extended: true,
    }
}

/// Density per solid angle with which [`sample_light`](super::light::sample_light) at `from`
/// samples `direction` on area light `index`, hit at distance `t` at a point with unit normal
/// `normal` and profile parameter `v`.
pub fn pdf_area(
    scene: &SceneTables,
    shares: u32,
    index: u32,
    from: Vec3,
    direction: Vec3,
    t: Real,
    normal: Vec3,
    v: Real,
) -> Real {
    let light = &scene.lights[index as usize];
    let share = share_of(scene, shares, index);
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = &scene.spheres[index_of(light.reference) as usize];
        let pdf = pdf_sphere_cone(sphere, from);
        if pdf > 0.0 {
            return pdf * share;
        }
    }
    let cos = direction.dot(normal).abs();
    pdf_shape(scene, light, v) * t * t / cos.max(1e-12) * share
}

/// Emits a photon from the light; `across` determines its direction.
#[inline(always)]
pub fn emit_area(scene: &SceneTables, light: &Light, u: Vec4, across: Vec2) -> Emission {
    let mut ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Z, t_max: FAR };
    if kind_of(light.reference) == KIND_SPHERE {
        // sample the direction first, then a point of the hemisphere that faces it: the same
        // density, and `across` determines where in the scene the photon goes
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(scene, light, Vec2::new(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission::unguided(ray, flux);
    }
    let p = sample_shape(scene, light, Vec2::new(u.y, u.z), u.w);
    ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
    ray.origin = p.position + p.normal * p.error;
    let flux = light.color * (PI / (p.pdf * light.selection));
    Emission::unguided(ray, flux)
}
