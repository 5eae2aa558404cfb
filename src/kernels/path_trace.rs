//! Path tracing with next-event estimation and multiple importance sampling: an independent
//! reference for photon mapping in scenes that path tracing can solve. CPU engine only.

use super::camera::camera_ray;
use super::direct::next_event;
use super::eye_path::{EyePath, LastLobe};
use super::eye_sample::{filter_weight, filtered, window_pixel};
use super::lights::select::shares_at;
use super::materials::shading::{RADIANCE, shading_point};
use super::materials::{choose_layer, pdf_rough, scatter_rough, scatter_specular};
use super::math::rng::{rng_eye, rng_next};
use super::real::Vec3;
use super::records::Dispatch;
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
    let u = rng_next(&mut rng);
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, filtered(camera, u));
    let mut path = EyePath::new(scene, ray);
    let mut radiance = Vec3::ZERO;
    let mut last = LastLobe::NONE;
    while path.continues(dispatch) {
        let hit = path.trace(scene);
        if hit.reference == NONE {
            radiance += path.found_environment(scene, &last);
            break;
        }
        let ray = path.ray;
        let s = path.arrive(scene, &hit);
        radiance += path.found_emission(scene, &last, &ray, &s, hit.t);
        if path.passes(scene, &s) {
            last.pdf = 0.0;
            continue;
        }
        if path.bounce == dispatch.max_bounces {
            break;
        }
        let mut p = shading_point(scene, &hit, &s, -ray.direction, &path.interior);
        if p.lobe.bsdf.is_layered() {
            let u = rng_next(&mut rng);
            path.throughput *= choose_layer(scene, &hit, &mut p, u.x);
        }
        let scattered = if p.lobe.bsdf.is_specular() {
            last.pdf = 0.0;
            let u = rng_next(&mut rng);
            scatter_specular(scene, &p, &path.interior, u.x, RADIANCE)
        } else {
            if sampled {
                last.shares = shares_at(scene, s.position);
                let u = rng_next(&mut rng);
                let (direct, spent) = next_event(scene, &p, &path.interior, true, u);
                radiance += path.throughput * direct;
                path.rays += spent;
            }
            let u = rng_next(&mut rng);
            let scattered = scatter_rough(scene, &p, &path.interior, u.truncate(), RADIANCE);
            if sampled {
                last.pdf = pdf_rough(&p.lobe, p.n, p.wo, scattered.direction);
            }
            scattered
        };
        if !path.scatter(&s, &scattered, rng_next(&mut rng).x) {
            break;
        }
    }
    (radiance * filter_weight(camera, u, pixel, dispatch), path.rays)
}
