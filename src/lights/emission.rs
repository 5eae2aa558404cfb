//! Photon emission from every kind of light. Twin: `shaders/lights/emission.wgsl`.

use super::guide::guided;
use super::light::{choose_light, eval_environment, pdf_environment, sample_environment, spot_falloff};
use super::math::rng::{Rng, rng_next};
use super::math::sampling::{sample_cone, sample_cosine, sample_disc, sample_sphere};
use super::math::{EPS, FAR, PI, TAU, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::shape::{sample_shape, sample_sphere_facing};
use super::shapes::ray::Ray;
use super::tables::*;

/// A photon as it leaves its light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Its first ray.
    pub ray: Ray,
    /// Flux in W times the number of photons emitted in the pass.
    pub flux: Vec3,
    /// Flux over that of the same photon if no map had sent it and it went through the narrowest emission disc.
    pub excess: Real,
    /// The glass material that it starts in, or [`NONE`].
    pub medium: u32,
}

/// The next photon.
#[inline(always)]
pub fn emit_photon(scene: &Scene, rng: &mut Rng) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    let light = &scene.lights[choose_light(scene, u.x) as usize];
    let (across, scale) = guided(scene, light, Vec2::new(v.x, v.y), v.w);
    let mut emission = emit_from(scene, light, u, v, across);
    emission.flux *= scale;
    emission.excess *= scale;
    emission
}

/// A photon of one light; `across` are the two numbers that matter most for where it goes.
#[inline(always)]
pub fn emit_from(scene: &Scene, light: &Light, u: Vec4, v: Vec4, across: Vec2) -> Emission {
    let mut ray = Ray { origin: light.position, t_min: 0.0, direction: Vec3::Z, t_max: FAR };
    if light.kind == LIGHT_AREA && light.reference >> REFERENCE_BITS == KIND_SPHERE {
        // first the direction, then the point on the disc that is seen from there: the same density, and `across` says
        // where in the scene the photon goes
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(scene, light, Vec2::new(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission { ray, flux, excess: 1.0, medium: light.medium };
    }
    if light.kind == LIGHT_AREA {
        let p = sample_shape(scene, light, Vec2::new(u.y, u.z), u.w);
        ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission { ray, flux, excess: 1.0, medium: light.medium };
    }
    if light.kind == LIGHT_POINT {
        ray.direction = unit(sample_sphere(across));
        let flux = light.color * (2.0 * TAU / light.selection);
        return Emission { ray, flux, excess: 1.0, medium: light.medium };
    }
    if light.kind == LIGHT_SPOT {
        let local = sample_cone(across, 1.0 - light.cos_outer);
        ray.direction = unit(from_frame(light.direction, local));
        let solid_angle = TAU * (1.0 - light.cos_outer);
        let flux = light.color * (spot_falloff(light, local.z) * solid_angle / light.selection);
        return Emission { ray, flux, excess: 1.0, medium: light.medium };
    }
    // from infinity: through one of a row of discs, each twice as wide as the one before and half as likely
    ray.direction = light.direction;
    let mut radiance = light.color;
    if light.kind != LIGHT_SUN {
        let w = sample_environment(scene, light, u);
        ray.direction = -w;
        radiance = eval_environment(scene, light, w) * (1.0 / pdf_environment(scene, light, w));
    }
    let mut radius = scene.world.near_radius;
    let mut x = v.z;
    for _ in 1..scene.world.disc_levels {
        if x >= 0.5 {
            break;
        }
        x *= 2.0;
        radius *= 2.0;
    }
    let d = sample_disc(across) * radius;
    ray.origin = from_frame(ray.direction, Vec3::new(d.x, d.y, 0.0));
    ray.t_min = -4.0 * disc_radius_max(scene);
    let pdf = pdf_discs(scene, d.dot(d));
    let flux = radiance * (1.0 / (pdf * light.selection));
    Emission { ray, flux, excess: pdf_discs(scene, 0.0) / pdf, medium: light.medium }
}

/// Radius of the widest emission disc.
pub fn disc_radius_max(scene: &Scene) -> Real {
    let mut radius = scene.world.near_radius;
    for _ in 1..scene.world.disc_levels {
        radius *= 2.0;
    }
    radius
}

/// Density per area, at squared distance `r_sq` from the middle, of a point on a disc so chosen.
pub fn pdf_discs(scene: &Scene, r_sq: Real) -> Real {
    let mut radius = scene.world.near_radius;
    let mut probability = 0.5;
    let mut sum = 0.0;
    for level in 1..scene.world.disc_levels + 1 {
        if level == scene.world.disc_levels {
            probability *= 2.0;
        }
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += probability / (PI * radius * radius);
        }
        probability *= 0.5;
        radius *= 2.0;
    }
    sum
}
