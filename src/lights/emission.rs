//! Photon emission from all kinds of lights. Twin: `shaders/lights/emission.wgsl`.

use super::guide::{GUIDED, guided, pdf_guide};
use super::light::{
    eval_environment, find_interval, pdf_environment, sample_environment, spot_falloff,
};
use super::materials::enclosing::interior_at;
use super::materials::interior::{Interior, interior_from, interior_of};
use super::math::rng::{Rng, rng_next};
use super::math::sampling::{sample_cone, sample_cosine, sample_disc, sample_sphere};
use super::math::{EPS, FAR, PI, TAU, basis, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::{choose_light, share_of};
use super::shape::{sample_shape, sample_sphere_facing};
use super::shapes::ray::Ray;
use super::tables::*;

/// Photon as it leaves its light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// First ray.
    pub ray: Ray,
    /// Flux in W, times the number of photons emitted in the pass.
    pub flux: Vec3,
    /// Flux relative to that of the same photon emitted without a guide map; for light from
    /// infinity, of one that passes `near_center` at half of `near_radius`.
    pub relative_flux: Real,
    /// Media that the ray's origin lies in.
    pub interior: Interior,
}

/// Emits a photon from a randomly chosen light.
#[inline(always)]
pub fn emit_photon(scene: &Scene, rng: &mut Rng) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    emit_from(scene, &scene.lights[choose_light(scene, 0, u.x) as usize], u, v)
}

/// Emits a photon from `light`, by its guide map if it has one.
#[inline(always)]
pub fn emit_from(scene: &Scene, light: &Light, u: Vec4, v: Vec4) -> Emission {
    if light.kind >= LIGHT_SUN {
        return emit_from_infinity(scene, light, u, v);
    }
    let (across, scale) = guided(scene, light, Vec2::new(v.x, v.y), v.w);
    let mut emission = emit_nearby(scene, light, u, across);
    emission.flux *= scale;
    emission.relative_flux *= scale;
    emission.interior = interior_at(scene, light.medium, emission.ray.origin);
    emission
}

/// Emits a photon from a lamp; `across` are the two random numbers that determine its direction.
#[inline(always)]
fn emit_nearby(scene: &Scene, light: &Light, u: Vec4, across: Vec2) -> Emission {
    let mut ray = Ray { origin: light.position, t_min: 0.0, direction: Vec3::Z, t_max: FAR };
    if light.kind == LIGHT_AREA && kind_of(light.reference) == KIND_SPHERE {
        // sample the direction first, then a point of the hemisphere that faces it: the same
        // density, and `across` determines where in the scene the photon goes
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(scene, light, Vec2::new(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission { ray, flux, relative_flux: 1.0, interior: interior_of(NONE) };
    }
    if light.kind == LIGHT_AREA {
        let p = sample_shape(scene, light, Vec2::new(u.y, u.z), u.w);
        ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission { ray, flux, relative_flux: 1.0, interior: interior_of(NONE) };
    }
    if light.kind == LIGHT_SPOT {
        let local = sample_cone(across, light.outer);
        ray.direction = unit(from_frame(light.direction, local));
        let solid_angle = TAU * light.outer;
        let flux = light.color
            * (spot_falloff(light, across.x * light.outer) * solid_angle / light.selection);
        return Emission { ray, flux, relative_flux: 1.0, interior: interior_of(NONE) };
    }
    ray.direction = unit(sample_sphere(across));
    let flux = light.color * (2.0 * TAU / light.selection);
    Emission { ray, flux, relative_flux: 1.0, interior: interior_of(NONE) }
}

/// Emits a photon of light from infinity. It passes through one of the emission discs about what
/// the camera sees, each twice as wide as the one before; or, if the light has a guide map, with
/// probability [`GUIDED`] through a cell of the square about the near disc. The balance heuristic
/// combines both densities.
#[inline(always)]
fn emit_from_infinity(scene: &Scene, light: &Light, u: Vec4, v: Vec4) -> Emission {
    let near = scene.world.near_radius;
    let mut ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: light.direction, t_max: FAR };
    let mut radiance = light.color;
    if light.kind != LIGHT_SUN {
        let w = sample_environment(scene, light, u);
        ray.direction = -w;
        radiance = eval_environment(scene, light, w) * (1.0 / pdf_environment(scene, light, w));
    }
    // choose a point on a disc or in the map's square
    let across = Vec2::new(v.x, v.y);
    let level = find_interval(scene, scene.world.disc_first, scene.world.disc_levels, v.z);
    let mut d = sample_disc(across) * disc_radius(scene, level);
    if light.guide != 0 && v.w < GUIDED {
        d = guided(scene, light, across, v.w * (1.0 / GUIDED)).0;
        d = (d * 2.0 - Vec2::ONE) * near;
    }
    // density per area of that point
    let mut pdf = pdf_discs(scene, d.dot(d));
    if light.guide != 0 {
        let by_map =
            pdf_guide(scene, light, (d * (1.0 / near) + Vec2::ONE) * 0.5) / (4.0 * near * near);
        pdf = GUIDED * by_map + (1.0 - GUIDED) * pdf;
    }
    // start far behind the plane of the discs
    let (tangent, bitangent) = basis(ray.direction);
    ray.origin = scene.world.near_center + tangent * d.x + bitangent * d.y;
    ray.t_min = -4.0 * disc_radius(scene, scene.world.disc_levels - 1);
    let flux = radiance * (1.0 / (pdf * light.selection));
    let usual = pdf_discs(scene, 0.25 * near * near);
    Emission {
        ray,
        flux,
        relative_flux: usual / pdf,
        interior: interior_from(scene, ray.direction),
    }
}

/// Radius of emission disc `level`, which is at most 31, scene units.
pub fn disc_radius(scene: &Scene, level: u32) -> Real {
    scene.world.disc_radius * (1u32 << level) as Real
}

/// Density per area, at squared distance `r_sq` from the centre, of a point on a randomly chosen
/// emission disc.
pub fn pdf_discs(scene: &Scene, r_sq: Real) -> Real {
    let mut radius = scene.world.disc_radius;
    let mut sum = 0.0;
    for level in 0..scene.world.disc_levels {
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += share_of(scene, scene.world.disc_first, level) / (PI * radius * radius);
        }
        radius *= 2.0;
    }
    sum
}
