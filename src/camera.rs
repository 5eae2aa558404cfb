//! Pinhole and thin-lens camera. Twin: `shaders/camera.wgsl`.

use crate::math::sampling::sample_disc;
use crate::math::{FAR, unit};
use crate::shapes::ray::Ray;
use crate::tables::Camera;
use glam::{Vec2, Vec4};

/// A ray through pixel (x, y), row 0 on top: (u.x, u.y) is the place in the pixel, (u.z, u.w) that on the lens.
pub fn camera_ray(camera: &Camera, x: u32, y: u32, u: Vec4) -> Ray {
    let px = 2.0 * (x as f32 + u.x) / camera.width as f32 - 1.0;
    let py = 1.0 - 2.0 * (y as f32 + u.y) / camera.height as f32;
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
