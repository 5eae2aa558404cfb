// Samples for the start of an eye path: its pixel, the position in the pixel and on the lens, and
// its weight in the pixel's filter. Twin: src/kernels/eye_sample.rs.

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

//#if filter
fn filtered(camera: Camera, u: vec4f) -> vec4f {
    let size = camera.filter_size;
    var offset = vec2f(0.0);
    switch camera.filter_kind {
        case FILTER_BOX: {
            offset = vec2f(sample_box(u.x, size), sample_box(u.y, size));
        }
        case FILTER_TENT: {
            offset = vec2f(sample_tent(u.x, size), sample_tent(u.y, size));
        }
        case FILTER_GAUSSIAN: {
            offset = sample_gaussian(vec2f(u.x, u.y), size, camera.filter_b);
        }
        case FILTER_MITCHELL: {
            let b = camera.filter_b;
            let c = camera.filter_c;
            offset = vec2f(sample_cubic(u.x, b, c, size), sample_cubic(u.y, b, c, size));
        }
        default: {
            return u;
        }
    }
    return vec4f(kept(0.5 + offset.x), kept(0.5 + offset.y), u.z, u.w);
}
//#end

//#if signed_filter
fn filter_sign(camera: Camera, u: vec4f) -> f32 {
    let negative = in_lobe(u.x, camera.filter_size) != in_lobe(u.y, camera.filter_size);
    return select(1.0, -1.0, negative);
}

fn signed_weight(camera: Camera, u: vec4f, pixel: u32) -> f32 {
    let sign = filter_sign(camera, u);
    if dispatch.fixed_points == 0u {
        // integral of the absolute value over x and y
        let across = camera.filter_size * 0.33333334;
        return sign * (across * across);
    }
    let samples = dispatch.eye_samples;
    var sum = 0.0;
    for (var j = 0u; j < samples; j++) {
        var rng = rng_eye(pixel * samples + j, dispatch.pass_number, dispatch.seed);
        sum += filter_sign(camera, stratified(rng_next(&rng), j, pixel));
    }
    return select(1.0, sign * (f32(samples) / sum), 2.0 * sum > f32(samples));
}
//#end

fn start_radius(footprint: f32) -> f32 {
    if dispatch.radius_pixels > 0.0 {
        return min(dispatch.radius_pixels * footprint, dispatch.radius_max);
    }
    return dispatch.radius_units;
}
