// Small vector functions: twin of src/math/vector.rs.

const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;
const INV_PI: f32 = 0.318309886183791;
const FAR: f32 = 1e30;
const EPS: f32 = 5.9604645e-8;

fn unit(v: vec3f) -> vec3f {
    return v * (1.0 / sqrt(dot(v, v)));
}

fn max_component(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn max_abs(v: vec3f) -> f32 {
    return max_component(abs(v));
}

struct Basis {
    t: vec3f,
    b: vec3f,
}

fn basis(n: vec3f) -> Basis {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return Basis(vec3f(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3f(b, s + n.y * n.y * a, -n.y));
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

fn oct_encode(v: vec3f) -> u32 {
    let s = 1.0 / (abs(v.x) + abs(v.y) + abs(v.z));
    let p = vec2f(v.x * s, v.y * s);
    var q = p;
    if v.z < 0.0 {
        q.x = (1.0 - abs(p.y)) * select(-1.0, 1.0, p.x >= 0.0);
        q.y = (1.0 - abs(p.x)) * select(-1.0, 1.0, p.y >= 0.0);
    }
    let x = u32(floor(q.x * 32767.0 + 32768.5));
    let y = u32(floor(q.y * 32767.0 + 32768.5));
    return x | (y << 16u);
}

fn oct_decode(code: u32) -> vec3f {
    let x = (f32(code & 0xffffu) - 32768.0) * (1.0 / 32767.0);
    let y = (f32(code >> 16u) - 32768.0) * (1.0 / 32767.0);
    var v = vec3f(x, y, 1.0 - abs(x) - abs(y));
    if v.z < 0.0 {
        v.x = (1.0 - abs(y)) * select(-1.0, 1.0, x >= 0.0);
        v.y = (1.0 - abs(x)) * select(-1.0, 1.0, y >= 0.0);
    }
    return unit(v);
}
