//! Path tracing with next-event estimation and multiple importance sampling: the independent check
//! that photon mapping converges to the right picture wherever path tracing gets there. CPU engine
//! only.

use super::camera::camera_ray;
use super::direct::{next_event, transmittance};
use super::eye_sample::window_pixel;
use super::lights::light::{eval_environment, pdf_environment, pdf_light};
use super::lights::select::{share_of, shares_at};
use super::materials::enclosing::interior_at;
use super::materials::interior::{interior_before, medium_of, passes_hidden};
use super::materials::scatter::{
    RADIANCE, is_specular, pdf_rough, reflectance_at, scatter_rough, scatter_specular,
    shading_normal, toward,
};
use super::math::rng::{rng_eye, rng_next};
use super::math::sampling::balance;
use super::math::{FAR, max_component, offset_origin};
use super::real::{Vec2, Vec3};
use super::records::{Dispatch, HIDDEN_FACES};
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;

/// One path through the pixel at place `place` of the window: its radiance and the number of rays.
/// `sampled`: next-event estimation.
pub fn path_trace(scene: &Scene, dispatch: &Dispatch, sampled: bool, place: u32) -> (Vec3, u32) {
    let camera = &scene.camera;
    let pixel = window_pixel(dispatch, camera, place);
    let mut rng = rng_eye(pixel, dispatch.pass_number, dispatch.seed, dispatch.points);
    let mut ray =
        camera_ray(camera, pixel % camera.width, pixel / camera.width, rng_next(&mut rng));
    let mut radiance = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    let mut interior = interior_at(scene, camera.medium, ray.origin);
    let mut hidden = 0;
    let mut bounce = 0;
    let mut rays = 0;
    // density of the last scattering; 0 where next-event estimation could not have found what is
    // met now
    let mut pdf = 0.0;
    // where the probabilities of the lights at that place begin
    let mut shares = 0;
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        rays += 1;
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            if scene.world.environment != NONE {
                let sky = scene.world.environment;
                let light = &scene.lights[sky as usize];
                let other =
                    pdf_environment(scene, light, ray.direction) * share_of(scene, shares, sky);
                let weight = if pdf > 0.0 { balance(pdf, other) } else { 1.0 };
                radiance += throughput * eval_environment(scene, light, ray.direction) * weight;
            }
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        let wo = -ray.direction;
        interior = interior_before(scene, &s, wo, &interior);
        throughput *= transmittance(scene, medium_of(&interior), hit.t);
        if s.light != NONE && wo.dot(s.normal) > 0.0 {
            let from = ray.origin;
            let other =
                pdf_light(scene, shares, s.light, from, ray.direction, hit.t, s.normal, s.v);
            let weight = if pdf > 0.0 { balance(pdf, other) } else { 1.0 };
            radiance += throughput * scene.lights[s.light as usize].color * weight;
        }
        if passes_hidden(scene, &s, &mut ray, &mut interior) {
            hidden += 1;
            pdf = 0.0;
            continue;
        }
        if bounce == dispatch.max_bounces {
            break;
        }
        let kind = scene.materials[s.material as usize].kind;
        let scattered = if is_specular(kind) {
            pdf = 0.0;
            let u = rng_next(&mut rng);
            scatter_specular(scene, &s, wo, &interior, u.x, RADIANCE)
        } else {
            let alpha = scene.materials[s.material as usize].alpha;
            let reflectance = reflectance_at(scene, s.material, s.uv);
            let ng = toward(s.normal, wo);
            let n = shading_normal(scene, &s, wo);
            if sampled {
                shares = shares_at(scene, s.position);
                let u = rng_next(&mut rng);
                let (direct, spent) =
                    next_event(scene, &s, wo, n, ng, reflectance, &interior, true, u);
                radiance += throughput * direct;
                rays += spent;
            }
            let u = rng_next(&mut rng);
            let scattered = scatter_rough(scene, &s, wo, &interior, Vec2::new(u.x, u.y), RADIANCE);
            pdf = if sampled { pdf_rough(kind, alpha, n, wo, scattered.direction) } else { 0.0 };
            scattered
        };
        throughput *= scattered.weight;
        interior = scattered.interior;
        // as on eye paths: glass dims the throughput on the way in and undoes it on the way out
        let survival = (4.0 * max_component(throughput)).min(1.0);
        if rng_next(&mut rng).x >= survival {
            break;
        }
        throughput *= 1.0 / survival;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
        bounce += 1;
    }
    (radiance, rays)
}
