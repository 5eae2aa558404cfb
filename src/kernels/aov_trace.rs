//! What a pixel shows beside radiance, from the same eye path as a visible point: at the first hit,
//! and beyond mirrors and glass at the first hit that is neither. Run by one invocation per pixel
//! for one of its samples; reads the scene, updates `aovs`. Twin: `shaders/kernels/aov_trace.wgsl`.

use super::camera::camera_ray;
use super::direct::{direct_light, transmittance};
use super::eye_sample::{start_radius, stratified, window_pixel};
use super::lights::light::eval_environment;
use super::materials::enclosing::interior_at;
use super::materials::interior::{interior_before, medium_of, passes_hidden};
use super::materials::scatter::{
    RADIANCE, is_specular, reflectance_at, scatter_specular, shading_normal, toward,
};
use super::math::rng::{rng_eye, rng_next};
use super::math::{FAR, is_finite, max_component, offset_origin};
use super::real::{Plain, Real, Vec3, Vec4};
use super::records::{Dispatch, HIDDEN_FACES};
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;
use bytemuck::Zeroable;

/// Means over a pixel's samples, in scene space and scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct AovPixel {
    /// Reflectance of the first hit that is neither mirror nor glass times the throughput before
    /// it; 0 where there is none.
    pub albedo: Vec3,
    /// Distance of the first hit along the view direction, over the samples that hit anything.
    pub depth: Real,
    /// Shading normal toward the viewer of the first hit that is neither mirror nor glass; 0 where
    /// there is none.
    pub normal: Vec3,
    /// Samples that hit anything.
    pub hits: Real,
    /// The first hit, over the samples that hit anything.
    pub position: Vec3,
    /// Samples that end at a visible point.
    pub points: Real,
    /// Emission and environment met on the way, times throughput.
    pub emission: Vec3,
    /// Start radius, over the samples that end at a visible point.
    pub radius: Real,
    /// Sampled direct light, times throughput.
    pub direct: Vec3,
    /// What the ray through the middles of pixel and lens hits; [`NONE`] for nothing.
    pub reference: u32,
    /// Its material or [`NONE`].
    pub material: u32,
    /// [`super::records::STOPPED`] where a sample is still to be taken, or 0.
    pub state: u32,
    /// Padding.
    pub pad: [u32; 2],
}

/// Adds to pixel `id` of the chunk the sample after the `passes_done` that it holds. `sampled`:
/// with direct light by shadow rays.
pub fn aov_trace(scene: &Scene, dispatch: &Dispatch, sampled: bool, id: u32, aov: &mut AovPixel) {
    let camera = &scene.camera;
    let pixel = window_pixel(dispatch, camera, dispatch.chunk_first / dispatch.eye_samples + id);
    let x = pixel % camera.width;
    let y = pixel / camera.width;
    let mut next = *aov;
    if dispatch.passes_done == 0 {
        let ray = camera_ray(camera, x, y, Vec4::splat(0.5));
        let hit = intersect_scene(scene, &ray);
        next.reference = hit.reference;
        next.material = NONE;
        if hit.reference != NONE {
            next.material = surface_at(scene, &ray, &hit).material;
        }
    }
    let k = dispatch.passes_done % dispatch.eye_samples;
    let mut rng = rng_eye(
        pixel * dispatch.eye_samples + k,
        dispatch.pass_number,
        dispatch.seed,
        dispatch.points,
    );
    let mut ray = camera_ray(camera, x, y, stratified(rng_next(&mut rng), k, pixel, dispatch));
    let mut throughput = Vec3::ONE;
    let mut interior = interior_at(scene, camera.medium, ray.origin);
    let mut hidden = 0;
    let mut bounce = 0;
    let mut length = 0.0;
    let mut albedo = Vec3::ZERO;
    let mut normal = Vec3::ZERO;
    let mut emission = Vec3::ZERO;
    let mut direct = Vec3::ZERO;
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            if scene.world.environment != NONE {
                let light = &scene.lights[scene.world.environment as usize];
                emission += throughput * eval_environment(scene, light, ray.direction);
            }
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        let wo = -ray.direction;
        length += hit.t;
        if bounce == 0 && hidden == 0 {
            next.hits += 1.0;
            let share = 1.0 / next.hits;
            next.depth += ((s.position - camera.position).dot(camera.forward) - next.depth) * share;
            next.position += (s.position - next.position) * share;
        }
        interior = interior_before(scene, &s, wo, &interior);
        throughput *= transmittance(scene, medium_of(&interior), hit.t);
        if s.light != NONE && wo.dot(s.normal) > 0.0 {
            emission += throughput * scene.lights[s.light as usize].color;
        }
        if passes_hidden(scene, &s, &mut ray, &mut interior) {
            hidden += 1;
            continue;
        }
        if !is_specular(scene.materials[s.material as usize].kind) {
            let reflectance = reflectance_at(scene, s.material, s.uv);
            albedo = throughput * reflectance;
            normal = shading_normal(scene, &s, wo);
            if max_component(reflectance) > 0.0 {
                next.points += 1.0;
                next.radius += (start_radius(dispatch, camera.pixel * length) - next.radius)
                    * (1.0 / next.points);
                if sampled {
                    let ng = toward(s.normal, wo);
                    let (radiance, _) =
                        direct_light(scene, &s, wo, normal, ng, reflectance, &interior, &mut rng);
                    direct = throughput * radiance;
                }
            }
            break;
        }
        if bounce == dispatch.max_bounces {
            break;
        }
        // as in `eye_trace`, with the same numbers
        let v = rng_next(&mut rng);
        let scattered = scatter_specular(scene, &s, wo, &interior, v.x, RADIANCE);
        throughput *= scattered.weight;
        interior = scattered.interior;
        let survival = (4.0 * max_component(throughput)).min(1.0);
        if v.y >= survival {
            break;
        }
        throughput *= 1.0 / survival;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
        bounce += 1;
    }
    if !is_finite(emission) {
        emission = Vec3::ZERO;
    }
    if !is_finite(albedo) {
        albedo = Vec3::ZERO;
    }
    if !is_finite(direct) {
        direct = Vec3::ZERO;
    }
    let share = 1.0 / (dispatch.passes_done + 1) as Real;
    next.albedo += (albedo - next.albedo) * share;
    next.normal += (normal - next.normal) * share;
    next.emission += (emission - next.emission) * share;
    next.direct += (direct - next.direct) * share;
    *aov = next;
}
