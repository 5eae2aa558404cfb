//! Path tracing with next-event estimation and multiple importance sampling: an independent
//! reference for photon mapping in scenes that path tracing can solve. CPU engine only.

use super::camera::camera_ray;
use super::direct::next_event;
use super::eye_path::EyePath;
use super::eye_sample::window_pixel;
use super::lights::area::pdf_area;
use super::lights::environment::{eval_environment, pdf_environment};
use super::lights::select::{share_of, shares_at};
use super::lights::sun_disc::{in_sun_disc, pdf_sun_disc};
use super::materials::shading::{RADIANCE, shading_point};
use super::materials::{pdf_rough, scatter_rough, scatter_specular};
use super::math::rng::{rng_eye, rng_next};
use super::math::sampling::balance;
use super::real::{Real, Vec2, Vec3};
use super::records::Dispatch;
use super::shapes::ray::Ray;
use super::tables::*;

/// Traces one path through the pixel at position `place` of the window; returns its radiance and
/// the number of rays. `sampled` enables next-event estimation.
pub fn path_trace(
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    place: u32,
) -> (Vec3, u32) {
    let camera = &scene.camera;
    let pixel = window_pixel(dispatch, camera, place);
    let mut rng = rng_eye(pixel, dispatch.pass_number, dispatch.seed, dispatch.points);
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, rng_next(&mut rng));
    let mut path = EyePath::new(scene, ray);
    let mut radiance = Vec3::ZERO;
    // density of the last scattered direction; 0 if next-event estimation cannot sample what that
    // ray hits
    let mut pdf = 0.0;
    // start of the light probabilities of the point that the ray leaves
    let mut shares = 0;
    while path.continues(dispatch) {
        let hit = path.trace(scene);
        if hit.reference == NONE {
            radiance += if pdf > 0.0 {
                weighted_environment(scene, &path, pdf, shares)
            } else {
                path.environment(scene)
            };
            break;
        }
        if path.passes_unseen(scene, &hit) {
            continue;
        }
        let Ray { origin: from, direction, .. } = path.ray;
        let s = path.arrive(scene, &hit);
        if pdf > 0.0 && s.light != NONE {
            let other = pdf_area(scene, shares, from, direction, hit.t, &s);
            radiance += path.emission(scene, &s) * balance(pdf, other);
        } else {
            radiance += path.emission(scene, &s);
        }
        if path.passes(scene, &s) {
            pdf = 0.0;
            continue;
        }
        if path.bounce == dispatch.max_bounces {
            break;
        }
        let p = shading_point(scene, &s, -direction);
        let scattered = if p.lobe.bsdf.is_specular() {
            pdf = 0.0;
            let u = rng_next(&mut rng);
            scatter_specular(scene, &p, &path.interior, u.x, RADIANCE)
        } else {
            if sampled {
                shares = shares_at(scene, s.position);
                let u = rng_next(&mut rng);
                let (direct, spent) = next_event(scene, &p, &path.interior, true, u);
                radiance += path.throughput * direct;
                path.rays += spent;
            }
            let u = rng_next(&mut rng);
            let scattered = scatter_rough(&p, &path.interior, Vec2::new(u.x, u.y), RADIANCE);
            pdf = if sampled { pdf_rough(&p.lobe, p.n, p.wo, scattered.direction) } else { 0.0 };
            scattered
        };
        if !path.scatter(&s, &scattered, rng_next(&mut rng).x) {
            break;
        }
    }
    (radiance, path.rays)
}

/// Radiance of the environment and of suns in the ray's direction, times throughput and the weight
/// of scattering, which found the direction with density `pdf`, against next-event estimation.
fn weighted_environment(scene: &SceneTables, path: &EyePath, pdf: Real, shares: u32) -> Vec3 {
    let mut radiance = Vec3::ZERO;
    let direction = path.ray.direction;
    if scene.world.environment != NONE {
        let sky = scene.world.environment;
        let light = &scene.lights[sky as usize];
        let other = pdf_environment(scene, light, direction) * share_of(scene, shares, sky);
        let seen = path.throughput * eval_environment(scene, light, direction);
        radiance = seen * balance(pdf, other);
    }
    let mut sun = scene.world.sun_discs;
    while sun != NONE {
        let light = &scene.lights[sun as usize];
        if in_sun_disc(light, direction) {
            let other = pdf_sun_disc(light) * share_of(scene, shares, sun);
            radiance += path.throughput * light.color * balance(pdf, other);
        }
        sun = light.reference;
    }
    radiance
}
