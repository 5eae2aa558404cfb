//! Eye path of one visible point: lens and pixel sample, through mirrors and glass, to the first
//! non-specular hit. Run by one invocation per visible point; reads the scene, writes
//! `visible_points`. Twin: `shaders/kernels/eye_trace.wgsl`.

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
use super::math::{FAR, INV_PI, is_finite, max_component, oct_encode, offset_origin};
use super::real::Vec3;
use super::records::{BAD_DIRECT, BAD_EYE, Dispatch, HIDDEN_FACES, VisiblePoint};
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;
use bytemuck::Zeroable;

/// Traces visible point `id` of the chunk; also returns the number of rays. `sampled`: direct light
/// by shadow rays.
#[inline(always)]
pub fn eye_trace(
    scene: &Scene,
    dispatch: &Dispatch,
    sampled: bool,
    id: u32,
) -> (VisiblePoint, u32) {
    let camera = &scene.camera;
    let place = (dispatch.chunk_first + id) / dispatch.eye_samples;
    let k = dispatch.chunk_first + id - place * dispatch.eye_samples;
    let pixel = window_pixel(dispatch, camera, place);
    let mut rng = rng_eye(
        pixel * dispatch.eye_samples + k,
        dispatch.pass_number,
        dispatch.seed,
        dispatch.points,
    );
    let u = stratified(rng_next(&mut rng), k, pixel, dispatch);
    let mut ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, u);
    let mut throughput = Vec3::ONE;
    let mut interior = interior_at(scene, camera.medium, ray.origin);
    let mut hidden = 0;
    let mut bounce = 0;
    let mut length = 0.0;
    let mut rays = 0;
    let mut point = VisiblePoint::zeroed();
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        rays += 1;
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            if scene.world.environment != NONE {
                let light = &scene.lights[scene.world.environment as usize];
                point.radiance += throughput * eval_environment(scene, light, ray.direction);
            }
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        let wo = -ray.direction;
        length += hit.t;
        interior = interior_before(scene, &s, wo, &interior);
        throughput *= transmittance(scene, medium_of(&interior), hit.t);
        if s.light != NONE && wo.dot(s.normal) > 0.0 {
            point.radiance += throughput * scene.lights[s.light as usize].color;
        }
        if passes_hidden(scene, &s, &mut ray, &mut interior) {
            hidden += 1;
            continue;
        }
        let kind = scene.materials[s.material as usize].kind;
        if !is_specular(kind) {
            let reflectance = reflectance_at(scene, s.material, s.uv);
            if max_component(reflectance) <= 0.0 {
                break;
            }
            let ng = toward(s.normal, wo);
            let n = shading_normal(scene, &s, wo);
            point.position = s.position;
            point.facet = s.facet;
            point.radius = start_radius(dispatch, camera.pixel * length);
            point.normal = oct_encode(ng);
            point.shading = oct_encode(n);
            point.weight = throughput * INV_PI * reflectance;
            if kind == MATERIAL_METAL {
                point.weight = throughput;
                point.reflectance = reflectance;
                point.alpha = scene.materials[s.material as usize].alpha;
                point.wo = oct_encode(wo);
            }
            if sampled {
                let (radiance, spent) =
                    direct_light(scene, &s, wo, n, ng, reflectance, &interior, &mut rng);
                let direct = throughput * radiance;
                rays += spent;
                if is_finite(direct) {
                    point.radiance += direct;
                } else {
                    point.state |= BAD_DIRECT;
                }
            }
            break;
        }
        if bounce == dispatch.max_bounces {
            break;
        }
        let v = rng_next(&mut rng);
        let scattered = scatter_specular(scene, &s, wo, &interior, v.x, RADIANCE);
        throughput *= scattered.weight;
        interior = scattered.interior;
        // roulette only where little is left to lose
        let survival = (4.0 * max_component(throughput)).min(1.0);
        if v.y >= survival {
            break;
        }
        throughput *= 1.0 / survival;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
        bounce += 1;
    }
    if !is_finite(point.radiance) {
        point.radiance = Vec3::ZERO;
        point.state |= BAD_EYE;
    }
    (point, rays)
}
