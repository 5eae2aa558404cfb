//! Area lights: shapes that emit from the side of their normal, or from both sides. `color` is the
//! radiance, which a texture may scale (see `glow`), and `reference` the shape. Twin:
//! `shaders/lights/area.wgsl`.

use super::emission::Emission;
use super::geometry::surface::Surface;
use super::glow::{glow_at_sample, glow_at_surface, pdf_map, warped};
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
                radiance: glow_at_sample(scene, light, &p, Vec2::ZERO, 0.0),
                pdf: p.pdf * share,
                extended: true,
            };
        }
    }
    let w = warped(scene, light, u);
    let mut p = sample_shape(scene, light, w.across, w.pick);
    p.pdf *= w.pdf;
    let radiance = glow_at_sample(scene, light, &p, w.across, w.pick);
    if light.flags & LIGHT_TWO_SIDED != 0 && (position - p.position).dot(p.normal) < 0.0 {
        p.normal = -p.normal;
    }
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
        radiance,
        pdf: p.pdf * dist_sq / cos * share,
        extended: true,
    }
}

/// Radiance that leaves the emitting surface `s` against `direction`.
#[inline(always)]
pub fn eval_area(scene: &SceneTables, s: &Surface, direction: Vec3) -> Vec3 {
    let light = &scene.lights[s.light as usize];
    if light.flags & LIGHT_TWO_SIDED == 0 && direction.dot(s.normal) >= 0.0 {
        return Vec3::ZERO;
    }
    glow_at_surface(scene, light, s)
}

/// Density per solid angle with which [`sample_light`](super::light::sample_light) at `from`
/// samples `direction` on the emitting surface `s`, hit at distance `t`.
pub fn pdf_area(
    scene: &SceneTables,
    shares: u32,
    from: Vec3,
    direction: Vec3,
    t: Real,
    s: &Surface,
) -> Real {
    let light = &scene.lights[s.light as usize];
    let share = share_of(scene, shares, s.light);
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = &scene.spheres[index_of(light.reference) as usize];
        let pdf = pdf_sphere_cone(sphere, from);
        if pdf > 0.0 {
            return pdf * share;
        }
    }
    let cos = direction.dot(s.normal).abs();
    pdf_shape(scene, light, s.v) * pdf_map(scene, light, s.uv) * t * t / cos.max(1e-12) * share
}

/// Emits a photon from the light; `across` determines its direction, and `side` the side of a
/// two-sided light.
#[inline(always)]
pub fn emit_area(
    scene: &SceneTables,
    light: &Light,
    u: Vec4,
    across: Vec2,
    side: Real,
) -> Emission {
    let two_sided = light.flags & LIGHT_TWO_SIDED != 0;
    let behind = two_sided && side < 0.5;
    let sides = if two_sided { 2.0 } else { 1.0 };
    let mut ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Z, t_max: FAR };
    if kind_of(light.reference) == KIND_SPHERE {
        // sample the direction first, then a point of the hemisphere that faces it: the same
        // density, and `across` determines where in the scene the photon goes
        ray.direction = sample_sphere(across);
        let facing = if behind { -ray.direction } else { ray.direction };
        let p = sample_sphere_facing(scene, light, Vec2::new(u.y, u.z), facing);
        ray.origin = p.position + if behind { -p.normal } else { p.normal } * p.error;
        let radiance = glow_at_sample(scene, light, &p, Vec2::ZERO, 0.0);
        let flux = radiance * (sides * PI / (p.pdf * light.selection));
        return Emission::unguided(ray, flux);
    }
    let w = warped(scene, light, u);
    let mut p = sample_shape(scene, light, w.across, w.pick);
    p.pdf *= w.pdf;
    let radiance = glow_at_sample(scene, light, &p, w.across, w.pick);
    if behind {
        p.normal = -p.normal;
    }
    ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
    ray.origin = p.position + p.normal * p.error;
    let flux = radiance * (sides * PI / (p.pdf * light.selection));
    Emission::unguided(ray, flux)
}
