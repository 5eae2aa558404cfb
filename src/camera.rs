//! Camera rays: projections and thin lens. Twin: `shaders/camera.wgsl`.

use super::math::sampling::sample_disc;
use super::math::trig::sin_cos;
use super::math::{FAR, PI, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::shapes::ray::Ray;
use super::tables::Camera;

/// Kind of a camera's projection, stored as a number in [`Camera::projection`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ProjectionKind {
    /// Central projection onto a plane.
    Perspective,
    /// Parallel projection.
    Orthographic,
    /// All directions, equirectangular.
    Panorama,
    /// Equidistant fisheye.
    Fisheye,
}

impl ProjectionKind {
    /// Kind with the number `kind`.
    #[inline(always)]
    pub const fn of(kind: u32) -> Self {
        match kind {
            0 => Self::Perspective,
            1 => Self::Orthographic,
            2 => Self::Panorama,
            _ => Self::Fisheye,
        }
    }
}

/// Ray through pixel (x, y), row 0 at the top; (u.x, u.y) is the position in the pixel, relative to
/// its upper left corner, (u.z, u.w) the sample of the lens. A ray with `t_max` 0 means that the
/// camera sees nothing there.
#[inline(always)]
pub fn camera_ray(camera: &Camera, x: u32, y: u32, u: Vec4) -> Ray {
    let px = 2.0 * (x as Real + u.x) / camera.width as Real - 1.0;
    let py = 1.0 - 2.0 * (y as Real + u.y) / camera.height as Real;
    match ProjectionKind::of(camera.projection) {
        ProjectionKind::Perspective => {
            let d = camera.center + camera.right * px + camera.up * py;
            through_lens(camera, camera.position, d, u)
        }
        ProjectionKind::Orthographic => {
            let origin = camera.position + camera.right * px + camera.up * py;
            through_lens(camera, origin, camera.forward, u)
        }
        ProjectionKind::Panorama => panorama_ray(camera, px, py),
        ProjectionKind::Fisheye => fisheye_ray(camera, px, py),
    }
}

/// Ray whose part along `forward` is one in `d`, through the lens about `origin` to the plane of
/// focus.
#[inline(always)]
fn through_lens(camera: &Camera, origin: Vec3, d: Vec3, u: Vec4) -> Ray {
    let mut from = origin;
    let mut direction = d;
    if camera.aperture > 0.0 {
        let lens = sample_disc(Vec2::new(u.z, u.w)) * camera.aperture;
        let right = camera.lens_right * lens.x;
        let up = camera.lens_up * lens.y;
        from = origin + right + up;
        direction = d * camera.focus - right - up;
    }
    Ray { origin: from, t_min: 0.0, direction: unit(direction), t_max: FAR }
}

/// Ray to longitude `pi px` and latitude `pi/2 py`.
#[inline(never)]
fn panorama_ray(camera: &Camera, px: Real, py: Real) -> Ray {
    let (sin_x, cos_x) = sin_cos(PI * px);
    let (sin_y, cos_y) = sin_cos(0.5 * PI * py);
    let across = camera.forward * cos_x + camera.lens_right * sin_x;
    let direction = across * cos_y + camera.lens_up * sin_y;
    Ray { origin: camera.position, t_min: 0.0, direction: unit(direction), t_max: FAR }
}

/// Ray whose angle from `forward` is its distance from the centre of the image.
#[inline(never)]
fn fisheye_ray(camera: &Camera, px: Real, py: Real) -> Ray {
    let v = camera.right * px + camera.up * py;
    let angle = v.dot(v).sqrt();
    let (sin, cos) = sin_cos(angle);
    let share = if angle > 0.0 { sin / angle } else { 1.0 };
    let direction = camera.forward * cos + v * share;
    let t_max = if angle > camera.focus { 0.0 } else { FAR };
    Ray { origin: camera.position, t_min: 0.0, direction: unit(direction), t_max }
}

/// Height of a pixel's footprint, scene units, where an eye path has this length.
#[inline(always)]
pub fn footprint(camera: &Camera, length: Real) -> Real {
    match ProjectionKind::of(camera.projection) {
        ProjectionKind::Orthographic => camera.pixel,
        ProjectionKind::Perspective | ProjectionKind::Panorama | ProjectionKind::Fisheye => {
            camera.pixel * length
        }
    }
}

/// Returns whether depth is the distance from the camera, not the distance along `forward`.
pub fn sees_around(camera: &Camera) -> bool {
    match ProjectionKind::of(camera.projection) {
        ProjectionKind::Perspective | ProjectionKind::Orthographic => false,
        ProjectionKind::Panorama | ProjectionKind::Fisheye => true,
    }
}
