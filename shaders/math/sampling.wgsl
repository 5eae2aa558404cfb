// Maps from uniform numbers to discs, spheres, hemispheres and triangles. Twin:
// src/math/sampling.rs.

fn sample_disc(u: vec2f) -> vec2f {
    let r = sqrt(u.x);
    let sc = sin_cos(TAU * u.y);
    return vec2f(r * sc.y, r * sc.x);
}

fn sample_cosine(u: vec2f) -> vec3f {
    let d = sample_disc(u);
    return vec3f(d.x, d.y, sqrt(1.0 - u.x));
}

fn sample_sphere(u: vec2f) -> vec3f {
    let z = 1.0 - 2.0 * u.x;
    let r = sqrt(4.0 * u.x * (1.0 - u.x));
    let sc = sin_cos(TAU * u.y);
    return vec3f(r * sc.y, r * sc.x, z);
}

fn sample_cone(u: vec2f, one_minus_cos: f32) -> vec3f {
    let h = u.x * one_minus_cos;
    let r = sqrt(h * (2.0 - h));
    let sc = sin_cos(TAU * u.y);
    return vec3f(r * sc.y, r * sc.x, 1.0 - h);
}

fn sample_triangle(u: vec2f) -> vec2f {
    let r = sqrt(u.x);
    return vec2f(r * (1.0 - u.y), r * u.y);
}

fn balance(a: f32, b: f32) -> f32 {
    return a / (a + b);
}

const PDF_SPHERE: f32 = 0.0795774715459477;
