// Samples of pixel filters: offsets from a pixel's centre, in pixels. Twin:
// src/math/pixel_filter.rs, which states densities and sources.

const HALVINGS: u32 = 22u;

const FILTER_BOX: u32 = 1u;
const FILTER_TENT: u32 = 2u;
const FILTER_GAUSSIAN: u32 = 3u;
const FILTER_MITCHELL: u32 = 4u;

fn sample_box(u: f32, radius: f32) -> f32 {
    return radius * (2.0 * u - 1.0);
}

fn sample_tent(u: f32, radius: f32) -> f32 {
    let v = 2.0 * u - 1.0;
    let x = 1.0 - sqrt(1.0 - abs(v));
    return radius * select(x, -x, v < 0.0);
}

fn sample_gaussian(u: vec2f, sigma: f32, inside: f32) -> vec2f {
    let r = sigma * sqrt(max(-2.0 * logarithm(1.0 - u.x * inside), 0.0));
    let sc = sin_cos(TAU * u.y);
    return vec2f(r * sc.y, r * sc.x);
}

fn cubic_tail(s: f32, b: f32, c: f32, half: f32) -> f32 {
    let slope = b + 6.0 * c;
    let found = s * s * s * (2.0 * c - 0.25 * slope * s);
    if slope * s > 6.0 * c {
        return (half - 3.0) - found;
    }
    return found;
}

fn cubic_integral(x: f32, b: f32, c: f32, half: f32) -> f32 {
    if x >= 1.0 {
        return half - cubic_tail(2.0 - x, b, c, half);
    }
    let square = 2.0 * (2.0 * b + c) - 6.0;
    let cube = 3.0 - 0.75 * (3.0 * b + 2.0 * c);
    return x * ((6.0 - 2.0 * b) + x * x * (square + cube * x));
}

fn sample_cubic(u: f32, b: f32, c: f32, half: f32) -> f32 {
    let v = 2.0 * u - 1.0;
    let wanted = abs(v) * half;
    // bisection: exact, with the same bits everywhere
    var x = 0.0;
    var width = 1.0;
    for (var i = 0u; i < HALVINGS; i++) {
        if cubic_integral(x + width, b, c, half) <= wanted {
            x += width;
        }
        width *= 0.5;
    }
    return select(x, -x, v < 0.0);
}

fn in_lobe(u: f32, half: f32) -> bool {
    return abs(2.0 * u - 1.0) * half > half - 0.5 * (half - 3.0);
}
