// Samples for the start of an eye path: its pixel, the position in the pixel and on the lens. Twin:
// src/kernels/eye_sample.rs.

fn window_pixel(camera: Camera, place: u32) -> u32 {
    let row = place / dispatch.window_width;
    return dispatch.window_first + row * camera.width + (place - row * dispatch.window_width);
}

fn stratified(u: vec4f, k: u32, pixel: u32) -> vec4f {
    if dispatch.eye_samples == 1u {
        return u;
    }
    let columns = dispatch.strata;
    let rows = dispatch.eye_samples / columns;
    // random per pixel and seed, so that no pixel pairs the same parts of pixel and lens in every
    // render
    let shift = pcg4d(vec4u(pixel, 0u, STREAM_STRATA, dispatch.seed)).x % dispatch.eye_samples;
    let lens = (k + shift) % dispatch.eye_samples;
    return vec4f(
        (f32(k % columns) + u.x) / f32(columns),
        (f32(k / columns) + u.y) / f32(rows),
        (f32(lens % columns) + u.z) / f32(columns),
        (f32(lens / columns) + u.w) / f32(rows),
    );
}

fn start_radius(footprint: f32) -> f32 {
    if dispatch.radius_pixels > 0.0 {
        return min(dispatch.radius_pixels * footprint, dispatch.radius_max);
    }
    return dispatch.radius_units;
}
