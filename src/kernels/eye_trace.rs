//! Eye path of one visible point: samples pixel and lens, follows mirrors, glass and narrow lobes
//! to the first wide one. Run by one invocation per visible point; reads the scene, writes
//! `visible_points`. Twin: `shaders/kernels/eye_trace.wgsl`.

use super::camera::{camera_ray, footprint};
use super::direct::{direct_light, next_event};
use super::eye_path::{EyePath, LastLobe, Turn};
use super::eye_sample::{filter_weight, filtered, start_radius, stratified, window_pixel};
use super::materials::shading::{RADIANCE, shading_point};
use super::materials::{Bsdf, choose_layer, scatter_specular};
use super::math::rng::{rng_eye, rng_next};
use super::math::{INV_PI, is_finite, max_component, oct_encode};
use super::real::Vec3;
use super::records::{BAD_DIRECT, BAD_EYE, BSDF_BITS, Dispatch, ONLY_FOCUSED, VisiblePoint};
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
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, filtered(camera, u));
    let mut path = EyePath::new(scene, ray);
    let mut last = LastLobe::NONE;
    let mut point = VisiblePoint::zeroed();
    while path.continues(dispatch) {
        let hit = path.trace(scene);
        if hit.reference == NONE {
            point.radiance += path.found_environment(scene, &last);
            break;
        }
        let ray = path.ray;
        let s = path.arrive(scene, &hit);
        point.radiance += path.found_emission(scene, &last, &ray, &s, hit.t);
        if path.passes(scene, &s) {
            last.pdf = 0.0;
            continue;
        }
        let mut p = shading_point(scene, &hit, &s, -path.ray.direction, &path.interior);
        if p.lobe.bsdf.is_layered() {
            let u = rng_next(&mut rng);
            path.throughput *= choose_layer(scene, &hit, &mut p, u.x);
        }
        // continue at a narrow lobe, or gather there the photons that a continued path cannot find
        let mut only_focused = false;
        if path.turns_at(dispatch, &p.lobe) {
            if sampled {
                let u = rng_next(&mut rng);
                let (radiance, spent) = next_event(scene, &p, &path.interior, true, u);
                add_direct(&mut point, path.throughput * radiance);
                path.rays += spent;
            }
            match path.turn(scene, dispatch, sampled, &p, &mut last, rng_next(&mut rng)) {
                Turn::Continues => continue,
                Turn::GathersFocused => only_focused = true,
                Turn::Ends => break,
            }
        }
        // store the visible point at the first wide hit
        if !p.lobe.bsdf.is_specular() {
            if max_component(p.lobe.reflectance) <= 0.0 {
                break;
            }
            point.position = s.position;
            point.outline = s.outline;
            point.radius = start_radius(dispatch, footprint(camera, path.length));
            point.normal = oct_encode(p.ng);
            point.shading = oct_encode(p.n);
            point.bsdf = p.lobe.bsdf as u32;
            if p.lobe.bsdf.reads_table(p.lobe.m) {
                point.bsdf |= p.lobe.material << BSDF_BITS;
            }
            point.weight = path.throughput * INV_PI * p.lobe.reflectance;
            if p.lobe.bsdf != Bsdf::Diffuse {
                point.weight = path.throughput;
                point.reflectance = p.lobe.reflectance;
                point.alpha = p.lobe.alpha;
                point.wo = oct_encode(p.wo);
            }
            if only_focused {
                point.state |= ONLY_FOCUSED;
            } else if sampled {
                let (radiance, spent) = direct_light(scene, &p, &path.interior, &mut rng);
                add_direct(&mut point, path.throughput * radiance);
                path.rays += spent;
            }
            break;
        }
        // scatter at mirrors and glass
        if path.bounce == dispatch.max_bounces {
            break;
        }
        last.pdf = 0.0;
        let v = rng_next(&mut rng);
        let scattered = scatter_specular(scene, &p, &path.interior, v.x, RADIANCE);
        if !path.scatter(&s, &scattered, v.y) {
            break;
        }
    }
    let weight = filter_weight(camera, u, pixel, dispatch);
    if weight != 1.0 {
        point.radiance *= weight;
        point.weight *= weight;
    }
    if !is_finite(point.radiance) {
        point.radiance = Vec3::ZERO;
        point.state |= BAD_EYE;
    }
    (point, path.rays)
}

/// Adds sampled direct light, unless it is not finite.
#[inline(always)]
fn add_direct(point: &mut VisiblePoint, direct: Vec3) {
    if is_finite(direct) {
        point.radiance += direct;
    } else {
        point.state |= BAD_DIRECT;
    }
}
