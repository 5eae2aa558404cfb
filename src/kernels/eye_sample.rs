//! Samples for the start of an eye path: its pixel, the position in the pixel and on the lens, and
//! its weight in the pixel's filter.
//! Twin: `shaders/kernels/eye_sample.wgsl`.

use super::math::pixel_filter::{
    FilterKind, in_lobe, sample_box, sample_cubic, sample_gaussian, sample_tent,
};
use super::math::rng::{STREAM_STRATA, pcg4d, rng_eye, rng_next};
use super::math::trig::kept;
use super::real::{Real, Vec2, Vec4};
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

/// Turns the random numbers of the pixel, u.x and u.y, into the position that its filter draws.
#[inline(always)]
pub fn filtered(camera: &Camera, u: Vec4) -> Vec4 {
    if camera.filter_kind == FilterKind::Pixel as u32 { u } else { filtered_by(camera, u) }
}

#[inline(never)]
fn filtered_by(camera: &Camera, u: Vec4) -> Vec4 {
    let size = camera.filter_size;
    let offset = match FilterKind::of(camera.filter_kind) {
        FilterKind::Pixel => return u,
        FilterKind::Box => Vec2::new(sample_box(u.x, size), sample_box(u.y, size)),
        FilterKind::Tent => Vec2::new(sample_tent(u.x, size), sample_tent(u.y, size)),
        FilterKind::Gaussian => sample_gaussian(Vec2::new(u.x, u.y), size, camera.filter_b),
        FilterKind::Mitchell => {
            let (b, c) = (camera.filter_b, camera.filter_c);
            Vec2::new(sample_cubic(u.x, b, c, size), sample_cubic(u.y, b, c, size))
        }
    };
    Vec4::new(kept(0.5 + offset.x), kept(0.5 + offset.y), u.z, u.w)
}

/// Sign of the filter where [`filtered`] moves `u`.
fn filter_sign(camera: &Camera, u: Vec4) -> Real {
    let negative = in_lobe(u.x, camera.filter_size) != in_lobe(u.y, camera.filter_size);
    if negative { -1.0 } else { 1.0 }
}

/// Weight of a sample of `pixel`, filter over density, where `u` are its numbers before
/// [`filtered`]. Its mean is one; only a filter with negative lobes has weights other than one.
#[inline(always)]
pub fn filter_weight(camera: &Camera, u: Vec4, pixel: u32, dispatch: &Dispatch) -> Real {
    match FilterKind::of(camera.filter_kind) {
        FilterKind::Pixel | FilterKind::Box | FilterKind::Tent | FilterKind::Gaussian => 1.0,
        FilterKind::Mitchell => signed_weight(camera, u, pixel, dispatch),
    }
}

/// [`filter_weight`] of a filter with negative lobes. If no other samples follow, the weights of a
/// pixel are divided by their mean, so that a constant image stays constant; if too many samples
/// fall into negative lobes for that, all count alike.
#[inline(never)]
fn signed_weight(camera: &Camera, u: Vec4, pixel: u32, dispatch: &Dispatch) -> Real {
    let sign = filter_sign(camera, u);
    if dispatch.fixed_points == 0 {
        // integral of the absolute value over x and y
        let across = camera.filter_size * (1.0 / 3.0);
        return sign * (across * across);
    }
    let samples = dispatch.eye_samples;
    let mut sum = 0.0;
    for j in 0..samples {
        let index = pixel * samples + j;
        let mut rng = rng_eye(index, dispatch.pass_number, dispatch.seed, dispatch.points);
        sum += filter_sign(camera, stratified(rng_next(&mut rng), j, pixel, dispatch));
    }
    if 2.0 * sum > samples as Real { sign * (samples as Real / sum) } else { 1.0 }
}

/// Start radius (scene units) at a visible point whose pixel covers `footprint` scene units.
pub fn start_radius(dispatch: &Dispatch, footprint: Real) -> Real {
    if dispatch.radius_pixels > 0.0 {
        return (dispatch.radius_pixels * footprint).min(dispatch.radius_max);
    }
    dispatch.radius_units
}
