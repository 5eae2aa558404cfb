//! Samples for the start of an eye path: its pixel, the position in the pixel and on the lens.
//! Twin: `shaders/kernels/eye_sample.wgsl`.

use super::math::rng::{STREAM_STRATA, pcg4d};
use super::real::{Real, Vec4};
use super::records::Dispatch;
use super::tables::Camera;

/// Returns the image's pixel at position `place` of the render window, both in row-major order.
pub fn window_pixel(dispatch: &Dispatch, camera: &Camera, place: u32) -> u32 {
    let row = place / dispatch.window_width;
    dispatch.window_first + row * camera.width + (place - row * dispatch.window_width)
}

/// Maps the random numbers of sample `k` of a pixel to its stratum of the pixel (x, y) and of the
/// lens square (z, w). The lens strata are shifted cyclically.
pub fn stratified(u: Vec4, k: u32, pixel: u32, dispatch: &Dispatch) -> Vec4 {
    if dispatch.eye_samples == 1 {
        return u;
    }
    let columns = dispatch.strata;
    let rows = dispatch.eye_samples / columns;
    // random per pixel and seed, so that no pixel pairs the same parts of pixel and lens in every
    // render
    let shift = pcg4d([pixel, 0, STREAM_STRATA, dispatch.seed])[0] % dispatch.eye_samples;
    let lens = (k + shift) % dispatch.eye_samples;
    Vec4::new(
        ((k % columns) as Real + u.x) / columns as Real,
        ((k / columns) as Real + u.y) / rows as Real,
        ((lens % columns) as Real + u.z) / columns as Real,
        ((lens / columns) as Real + u.w) / rows as Real,
    )
}

/// Start radius (scene units) at a visible point whose pixel covers `footprint` scene units.
pub fn start_radius(dispatch: &Dispatch, footprint: Real) -> Real {
    if dispatch.radius_pixels > 0.0 {
        return (dispatch.radius_pixels * footprint).min(dispatch.radius_max);
    }
    dispatch.radius_units
}
