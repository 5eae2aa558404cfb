//! AOVs of a pixel, from the same eye path as a visible point: values at the first hit, at the
//! first hit beyond mirrors and glass, and along the whole path. Run by one invocation per pixel
//! for one of its samples; reads the scene, updates `aovs`. Twin: `shaders/kernels/aov_trace.wgsl`.

use super::camera::{camera_ray, footprint, sees_around};
use super::direct::{direct_light, next_event};
use super::eye_path::{EyePath, LastLobe, Turn};
use super::eye_sample::{filter_weight, filtered, start_radius, stratified, window_pixel};
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::surface_at;
use super::materials::shading::{RADIANCE, shading_point};
use super::materials::{choose_layer, scatter_specular};
use super::math::rng::{rng_eye, rng_next};
use super::math::{is_finite, max_component};
use super::real::{Plain, Real, Vec3, Vec4};
use super::records::Dispatch;
use super::tables::*;
use bytemuck::Zeroable;

/// AOVs of a pixel: means over its samples, in scene space and scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct AovPixel {
    /// Reflectance of the first hit that is neither mirror nor glass, times the throughput before
    /// it; 0 if there is none.
    pub albedo: Vec3,
    /// Distance of the first hit along the view direction; mean over the samples that hit anything.
    pub depth: Real,
    /// Shading normal, on the viewer's side, of the first hit that is neither mirror nor glass; 0
    /// if there is none.
    pub normal: Vec3,
    /// Number of samples that hit anything.
    pub hits: Real,
    /// Position of the first hit; mean over the samples that hit anything.
    pub position: Vec3,
    /// Number of samples that end at a visible point.
    pub points: Real,
    /// Emission and environment along the path, times throughput, without those that shadow rays
    /// can find.
    pub emission: Vec3,
    /// Start radius; mean over the samples that end at a visible point.
    pub radius: Real,
    /// Direct light at the path's rough hits, times throughput: that of shadow rays, and that of
    /// scattered rays which shadow rays could have found.
    pub direct: Vec3,
    /// Reference of the shape hit by the ray through the centres of pixel and lens, or [`NONE`].
    pub reference: u32,
    /// Material index at that hit, or [`NONE`].
    pub material: u32,
    /// [`super::records::STOPPED`] if a sample must be traced again, or 0.
    pub state: u32,
    /// Padding to 16 bytes.
    pub pad: [u32; 2],
}

/// Adds the next sample, number `passes_done`, to pixel `id` of the chunk. `sampled` as in
/// `eye_trace`; `lit` includes that direct light.
pub fn aov_trace(
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    lit: bool,
    id: u32,
    aov: &mut AovPixel,
) {
    let camera = &scene.camera;
    let pixel = window_pixel(dispatch, camera, dispatch.chunk_first / dispatch.eye_samples + id);
    let x = pixel % camera.width;
    let y = pixel / camera.width;
    let mut next = *aov;
    // shape and material at the pixel's centre, once
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
    let u = stratified(rng_next(&mut rng), k, pixel, dispatch);
    let ray = camera_ray(camera, x, y, filtered(camera, u));
    // follow the same path as `eye_trace`
    let mut path = EyePath::new(scene, ray);
    let mut last = LastLobe::NONE;
    let mut featured = false;
    let mut albedo = Vec3::ZERO;
    let mut normal = Vec3::ZERO;
    let mut emission = Vec3::ZERO;
    let mut direct = Vec3::ZERO;
    while path.continues(dispatch) {
        let hit = path.trace(scene);
        if hit.reference == NONE {
            let found = path.found_environment(scene, &last);
            if last.pdf > 0.0 {
                direct += found;
            } else {
                emission += found;
            }
            break;
        }
        let first = path.bounce == 0 && path.hidden == 0;
        let ray = path.ray;
        let s = path.arrive(scene, &hit);
        if first {
            next.hits += 1.0;
            let share = 1.0 / next.hits;
            let mut depth = (s.position - camera.position).dot(camera.forward);
            if sees_around(camera) {
                depth = hit.t;
            }
            next.depth += (depth - next.depth) * share;
            next.position += (s.position - next.position) * share;
        }
        let found = path.found_emission(scene, &last, &ray, &s, hit.t);
        if last.pdf > 0.0 {
            direct += found;
        } else {
            emission += found;
        }
        if path.passes(scene, &s) {
            last.pdf = 0.0;
            continue;
        }
        let mut p = shading_point(scene, &hit, &s, -path.ray.direction, &path.interior);
        if p.lobe.bsdf.is_layered() {
            let u = rng_next(&mut rng);
            path.throughput *= choose_layer(scene, &hit, &mut p, u.x);
        }
        if !featured && !p.lobe.bsdf.is_specular() {
            albedo = path.throughput * p.lobe.reflectance;
            normal = p.n;
            featured = true;
        }
        // as in `eye_trace`, with the same random numbers
        let mut only_focused = false;
        if path.turns_at(dispatch, &p.lobe) {
            if sampled {
                let u = rng_next(&mut rng);
                if lit {
                    let (radiance, _) = next_event(scene, &p, &path.interior, true, u);
                    direct += path.throughput * radiance;
                }
            }
            match path.turn(scene, dispatch, sampled, &p, &mut last, rng_next(&mut rng)) {
                Turn::Continues => continue,
                Turn::GathersFocused => only_focused = true,
                Turn::Ends => break,
            }
        }
        if !p.lobe.bsdf.is_specular() {
            if max_component(p.lobe.reflectance) > 0.0 {
                next.points += 1.0;
                let radius = start_radius(dispatch, footprint(camera, path.length));
                next.radius += (radius - next.radius) * (1.0 / next.points);
                if sampled && lit && !only_focused {
                    let (radiance, _) = direct_light(scene, &p, &path.interior, &mut rng);
                    direct += path.throughput * radiance;
                }
            }
            break;
        }
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
    if !is_finite(emission) {
        emission = Vec3::ZERO;
    }
    if !is_finite(albedo) {
        albedo = Vec3::ZERO;
    }
    if !is_finite(direct) {
        direct = Vec3::ZERO;
    }
    // parts of the image have its weights
    let weight = filter_weight(camera, u, pixel, dispatch);
    if weight != 1.0 {
        emission *= weight;
        direct *= weight;
    }
    // add to the running means
    let share = 1.0 / (dispatch.passes_done + 1) as Real;
    next.albedo += (albedo - next.albedo) * share;
    next.normal += (normal - next.normal) * share;
    next.emission += (emission - next.emission) * share;
    next.direct += (direct - next.direct) * share;
    *aov = next;
}
