//! Direct light at a rough surface, and absorption along a ray. One shadow ray goes to a sampled
//! light and, if the material's lobe is narrow, one ray is sampled from the lobe; multiple
//! importance sampling combines both (Veach & Guibas 1995). Twin: `shaders/kernels/direct.wgsl`.

use super::geometry::intersect::{intersect_scene, occluded};
use super::geometry::surface::surface_at;
use super::lights::area::pdf_area;
use super::lights::environment::{eval_environment, pdf_environment};
use super::lights::light::sample_light;
use super::lights::select::{share_of, shares_at};
use super::lights::sun_disc::{in_sun_disc, pdf_sun_disc};
use super::materials::interior::{Interior, interior_beyond, medium_of};
use super::materials::shading::{RADIANCE, ShadingPoint};
use super::materials::{eval_rough, pdf_rough, scatter_rough};
use super::math::rng::{Rng, rng_next};
use super::math::sampling::balance;
use super::math::trig::exponential;
use super::math::{FAR, max_component, offset_origin};
use super::real::{Real, Vec3, Vec4};
use super::shapes::ray::Ray;
use super::tables::*;

/// Beer-Lambert transmittance over `distance` (scene units) in a medium.
#[inline(always)]
pub fn transmittance(scene: &SceneTables, medium: u32, distance: Real) -> Vec3 {
    if medium == NONE {
        return Vec3::ONE;
    }
    let depth = scene.materials[medium as usize].absorption * -distance;
    Vec3::new(exponential(depth.x), exponential(depth.y), exponential(depth.z))
}

/// Radiance towards the path from one sampled light, and the number of shadow rays. `mis` weights
/// it against scattered rays that could hit the same light.
#[inline(always)]
pub fn next_event(
    scene: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    mis: bool,
    u: Vec4,
) -> (Vec3, u32) {
    let mut origin = p.s.position + p.ng * p.s.error;
    let light = sample_light(scene, shares_at(scene, p.s.position), origin, u);
    let behind = light.direction.dot(p.ng) <= 0.0;
    if (behind && !p.lobe.bsdf.transmits()) || max_component(light.radiance) <= 0.0 {
        return (Vec3::ZERO, 0);
    }
    let f = eval_rough(&p.lobe, p.n, p.wo, light.direction);
    if max_component(f) <= 0.0 {
        return (Vec3::ZERO, 0);
    }
    if behind {
        origin = p.s.position - p.ng * p.s.error;
    }
    let ray = Ray { origin, t_min: 0.0, direction: light.direction, t_max: light.distance };
    if occluded(scene, &ray) {
        return (Vec3::ZERO, 1);
    }
    let mut weight = 1.0 / light.pdf;
    if mis && light.extended {
        weight *= balance(light.pdf, pdf_rough(&p.lobe, p.n, p.wo, light.direction));
    }
    let mut radiance = f * light.radiance * weight;
    if light.distance < FAR {
        let mut medium = medium_of(interior);
        if behind && p.lobe.bsdf.is_body() {
            medium = medium_of(&interior_beyond(scene, &p.s, p.wo, interior));
        }
        radiance *= transmittance(scene, medium, light.distance);
    }
    (radiance, 1)
}

/// Radiance towards the path from all lights, and the number of rays traced.
#[inline(always)]
pub fn direct_light(
    scene: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    rng: &mut Rng,
) -> (Vec3, u32) {
    // for narrow lobes, scattered rays find large lights with less noise
    let narrow = !p.lobe.bsdf.is_wide();
    let (mut radiance, mut rays) = next_event(scene, p, interior, narrow, rng_next(rng));
    if narrow {
        let u = rng_next(rng);
        let scattered = scatter_rough(scene, p, interior, u.truncate(), RADIANCE);
        if max_component(scattered.weight) > 0.0 {
            rays += 1;
            let pdf = pdf_rough(&p.lobe, p.n, p.wo, scattered.direction);
            let origin = offset_origin(p.s.position, p.s.error, p.ng, scattered.direction);
            let ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
            let hit = intersect_scene(scene, &ray);
            let shares = shares_at(scene, p.s.position);
            if hit.reference == NONE {
                if scene.world.environment != NONE {
                    let sky = scene.world.environment;
                    let light = &scene.lights[sky as usize];
                    let share = share_of(scene, shares, sky);
                    let other = pdf_environment(scene, light, ray.direction) * share;
                    let seen = eval_environment(scene, light, ray.direction);
                    radiance += scattered.weight * seen * balance(pdf, other);
                }
                let mut sun = scene.world.sun_discs;
                while sun != NONE {
                    let light = &scene.lights[sun as usize];
                    if in_sun_disc(light, ray.direction) {
                        let other = pdf_sun_disc(light) * share_of(scene, shares, sun);
                        radiance += scattered.weight * light.color * balance(pdf, other);
                    }
                    sun = light.reference;
                }
            } else {
                let at = surface_at(scene, &ray, &hit);
                if at.light != NONE && ray.direction.dot(at.normal) < 0.0 {
                    let light = &scene.lights[at.light as usize];
                    let other = pdf_area(
                        scene,
                        shares,
                        at.light,
                        origin,
                        ray.direction,
                        hit.t,
                        at.normal,
                        at.v,
                    );
                    let medium = medium_of(&scattered.interior);
                    let seen = light.color * transmittance(scene, medium, hit.t);
                    radiance += scattered.weight * seen * balance(pdf, other);
                }
            }
        }
    }
    (radiance, rays)
}
