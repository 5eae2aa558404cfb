// Counter-based random numbers: twin of src/math/rng.rs.

const STREAM_EYE: u32 = 0x80000000u;
const STREAM_PHOTON: u32 = 0u;

struct Rng {
    index: u32,
    pass_number: u32,
    dimension: u32,
    seed: u32,
}

fn rng_new(index: u32, pass_number: u32, stream: u32, seed: u32) -> Rng {
    return Rng(index, pass_number, stream, seed);
}

// pcg4d (Jarzynski & Olano 2020).
fn pcg4d(p: vec4u) -> vec4u {
    var v = p * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> vec4u(16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

fn rng_next(rng: ptr<function, Rng>) -> vec4f {
    let h = pcg4d(vec4u((*rng).index, (*rng).pass_number, (*rng).dimension, (*rng).seed));
    (*rng).dimension += 1u;
    return vec4f(h >> vec4u(8u)) * (1.0 / 16777216.0);
}
