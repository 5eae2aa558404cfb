// Counter-based random numbers: an integer hash of (index, pass, dimension, seed), the same in
// every engine. Twin: src/math/rng.rs.

const STREAM_EYE: u32 = 0x80000000u;
const STREAM_PHOTON: u32 = 0u;
const STREAM_STRATA: u32 = 0x40000000u;

struct Rng {
    index: u32,
    pass_number: u32,
    dimension: u32,
    seed: u32,
}

fn rng_new(index: u32, pass_number: u32, stream: u32, seed: u32) -> Rng {
    return Rng(index, pass_number, stream, seed);
}

// Sequence of an eye path; its Sobol points are in `dispatch`.
fn rng_eye(index: u32, pass_number: u32, seed: u32) -> Rng {
    return Rng(index, pass_number, STREAM_EYE, seed);
}

// Hash pcg4d (Jarzynski & Olano 2020).
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

// Owen scrambling of a digital net.
fn scrambled(reversed: vec4u, seeds: vec4u) -> vec4u {
    var x = reversed;
    x ^= x * 0x3d20adeau;
    x += seeds;
    x *= (seeds >> vec4u(16u)) | vec4u(1u);
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reverseBits(x);
}

fn rng_next(rng: ptr<function, Rng>) -> vec4f {
    let k = (*rng).dimension - STREAM_EYE;
    var h: vec4u;
    if k < 4u {
        h = scrambled(
            dispatch.points[k], pcg4d(vec4u((*rng).index, 0u, (*rng).dimension, (*rng).seed))
        );
    } else {
        h = pcg4d(vec4u((*rng).index, (*rng).pass_number, (*rng).dimension, (*rng).seed));
    }
    (*rng).dimension += 1u;
    return vec4f(h >> vec4u(8u)) * (1.0 / 16777216.0);
}
