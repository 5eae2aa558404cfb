//! Which ray an eye path begins with: the pixel, the place in it and on the lens. Twin:
//! `shaders/kernels/eye_sample.wgsl`.

use super::math::rng::{STREAM_STRATA, pcg4d};
use super::real::{Real, Vec4};
use super::records::Dispatch;
use super::tables::Camera;

/// The picture's pixel at place `place` of the window that is rendered.
pub fn window_pixel(dispatch: &Dispatch, camera: &Camera, place: u32) -> u32 {
    let row = place / dispatch.window_width;
    dispatch.window_first + row * camera.width + (place - row * dispatch.window_width)
}

/// Sample `k` of a pixel in its stratum of the pixel and, shuffled, of the lens square.
pub fn stratified(u: Vec4, k: u32, pixel: u32, dispatch: &Dispatch) -> Vec4 {
    if dispatch.eye_samples == 1 {
        return u;
    }
    let columns = dispatch.strata;
    let rows = dispatch.eye_samples / columns;
    // by chance, so that no pixel looks through the same parts of the lens in every render
    let shift = pcg4d([pixel, 0, STREAM_STRATA, dispatch.seed])[0] % dispatch.eye_samples;
    let lens = (k + shift) % dispatch.eye_samples;
    Vec4::new(
        ((k % columns) as Real + u.x) / columns as Real,
        ((k / columns) as Real + u.y) / rows as Real,
        ((lens % columns) as Real + u.z) / columns as Real,
        ((lens / columns) as Real + u.w) / rows as Real,
    )
}

/// Start radius at a visible point whose pixel covers `footprint`.
pub fn start_radius(dispatch: &Dispatch, footprint: Real) -> Real {
    if dispatch.radius_pixels > 0.0 {
        return (dispatch.radius_pixels * footprint).min(dispatch.radius_max);
    }
    dispatch.radius_units
}
