// Packed directions in records. Twin: src/math/octahedral.rs.

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
    return unit(oct_vector(code));
}

fn oct_vector(code: u32) -> vec3f {
    let x = (f32(code & 0xffffu) - 32768.0) * (1.0 / 32767.0);
    let y = (f32(code >> 16u) - 32768.0) * (1.0 / 32767.0);
    var v = vec3f(x, y, 1.0 - abs(x) - abs(y));
    if v.z < 0.0 {
        v.x = (1.0 - abs(y)) * select(-1.0, 1.0, x >= 0.0);
        v.y = (1.0 - abs(x)) * select(-1.0, 1.0, y >= 0.0);
    }
    return v;
}
