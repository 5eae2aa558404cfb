//! Eye path of one visible point: samples pixel and lens, follows mirrors and glass to the first
//! non-specular hit. Run by one invocation per visible point; reads the scene, writes
//! `visible_points`. Twin: `shaders/kernels/eye_trace.wgsl`.

use super::camera::camera_ray;
use super::direct::direct_light;
use super::eye_path::EyePath;
use super::eye_sample::{start_radius, stratified, window_pixel};
use super::materials::shading::{RADIANCE, shading_point};
use super::materials::{Bsdf, scatter_specular};
use super::math::rng::{rng_eye, rng_next};
use super::math::{INV_PI, is_finite, max_component, oct_encode};
use super::real::Vec3;
use super::records::{BAD_DIRECT, BAD_EYE, Dispatch, VisiblePoint};
use super::tables::*;
use bytemuck::Zeroable;

/// Traces visible point `id` of the chunk; also returns the number of rays. `sampled` adds direct
/// light by shadow rays.
#[inline(always)]
pub fn eye_trace(
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    id: u32,
) -> (VisiblePoint, u32) {
    // sample the pixel and the lens
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
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, u);
    let mut path = EyePath::new(scene, ray);
    let mut point = VisiblePoint::zeroed();
    while path.continues(dispatch) {
        let hit = path.trace(scene);
        if hit.reference == NONE {
            point.radiance += path.environment(scene);
            break;
        }
        if path.passes_unseen(scene, &hit) {
            continue;
        }
        let s = path.arrive(scene, &hit);
        point.radiance += path.emission(scene, &s);
        if path.passes(scene, &s) {
            continue;
        }
        let p = shading_point(scene, &s, -path.ray.direction);
        // store the visible point at the first non-specular hit
        if !p.lobe.bsdf.is_specular() {
            if max_component(p.lobe.reflectance) <= 0.0 {
                break;
            }
            point.position = s.position;
            point.outline = s.outline;
            point.radius = start_radius(dispatch, camera.pixel * path.length);
            point.normal = oct_encode(p.ng);
            point.shading = oct_encode(p.n);
            point.bsdf = p.lobe.bsdf as u32;
            point.weight = path.throughput * INV_PI * p.lobe.reflectance;
            if p.lobe.bsdf != Bsdf::Diffuse {
                point.weight = path.throughput;
                point.reflectance = p.lobe.reflectance;
                point.alpha = p.lobe.alpha;
                point.wo = oct_encode(p.wo);
            }
            if sampled {
                let (radiance, spent) = direct_light(scene, &p, &path.interior, &mut rng);
                let direct = path.throughput * radiance;
                path.rays += spent;
                if is_finite(direct) {
                    point.radiance += direct;
                } else {
                    point.state |= BAD_DIRECT;
                }
            }
            break;
        }
        // scatter at mirrors and glass
        if path.bounce == dispatch.max_bounces {
            break;
        }
        let v = rng_next(&mut rng);
        let scattered = scatter_specular(scene, &p, &path.interior, v.x, RADIANCE);
        if !path.scatter(&s, &scattered, v.y) {
            break;
        }
    }
    if !is_finite(point.radiance) {
        point.radiance = Vec3::ZERO;
        point.state |= BAD_EYE;
    }
    (point, path.rays)
}
