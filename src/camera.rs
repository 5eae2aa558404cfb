//! Pinhole and thin-lens camera. Twin: `shaders/camera.wgsl`.

use super::math::sampling::sample_disc;
use super::math::{FAR, unit};
use super::real::{Real, Vec2, Vec4};
use super::shapes::ray::Ray;
use super::tables::Camera;

/// Ray through pixel (x, y), row 0 at the top; (u.x, u.y) in [0, 1)^2 is the position in the pixel,
/// (u.z, u.w) the sample of the lens.
#[inline(always)]
pub fn camera_ray(camera: &Camera, x: u32, y: u32, u: Vec4) -> Ray {
    let px = 2.0 * (x as Real + u.x) / camera.width as Real - 1.0;
    let py = 1.0 - 2.0 * (y as Real + u.y) / camera.height as Real;
    let d = camera.forward + camera.right * px + camera.up * py;
    let mut origin = camera.position;
    let mut direction = d;
    if camera.aperture > 0.0 {
        let lens = sample_disc(Vec2::new(u.z, u.w)) * camera.aperture;
        let right = camera.lens_right * lens.x;
        let up = camera.lens_up * lens.y;
        origin = camera.position + right + up;
        direction = d * camera.focus - right - up;
    }
    Ray { origin, t_min: 0.0, direction: unit(direction), t_max: FAR }
}
