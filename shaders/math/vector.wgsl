// Vector functions and constants. Twin: src/math/vector.rs.

const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;
const INV_PI: f32 = 0.318309886183791;
const FAR: f32 = 1e30;
const EPS: f32 = 5.9604645e-8;
const LUMINANCE = vec3f(0.2126, 0.7152, 0.0722);

fn unit(v: vec3f) -> vec3f {
    return v * (1.0 / sqrt(dot(v, v)));
}

fn max_component(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn max_abs(v: vec3f) -> f32 {
    return max_component(abs(v));
}

fn luminance(v: vec3f) -> f32 {
    return dot(v, LUMINANCE);
}

struct Basis {
    t: vec3f,
    b: vec3f,
}

fn basis(n: vec3f) -> Basis {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return Basis(
        vec3f(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3f(b, s + n.y * n.y * a, -n.y)
    );
}

fn from_frame(n: vec3f, local: vec3f) -> vec3f {
    let f = basis(n);
    return f.t * local.x + f.b * local.y + n * local.z;
}

fn mirrored(w: vec3f, n: vec3f) -> vec3f {
    return n * (2.0 * dot(w, n)) - w;
}

fn offset_origin(position: vec3f, error: f32, normal: vec3f, direction: vec3f) -> vec3f {
    if dot(direction, normal) >= 0.0 {
        return position + normal * error;
    }
    return position - normal * error;
}

// tested on the bits, since shader compilers may assume finite numbers
fn is_finite(v: vec3f) -> bool {
    let mask = vec3u(0x7f800000u);
    return all((bitcast<vec3u>(v) & mask) != mask);
}
