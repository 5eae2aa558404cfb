// Counter-based random numbers: twin of src/math/rng.rs.

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

fn rng_step(k: u32) -> vec4u {
    switch k {
        case 0u: {
            return vec4u(0x6a09e667u, 0xbb67ae85u, 0x3c6ef372u, 0xa54ff53au);
        }
        case 1u: {
            return vec4u(0x510e527fu, 0x9b05688cu, 0x1f83d9abu, 0x5be0cd19u);
        }
        case 2u: {
            return vec4u(0xcbbb9d5du, 0x629a292au, 0x9159015au, 0x152fecd8u);
        }
        default: {
            return vec4u(0x67332667u, 0x8eb44a87u, 0xdb0c2e0du, 0x47b5481du);
        }
    }
}

fn rng_next(rng: ptr<function, Rng>) -> vec4f {
    let k = (*rng).dimension - STREAM_EYE;
    var h: vec4u;
    if k < 4u {
        h = pcg4d(vec4u((*rng).index, 0u, (*rng).dimension, (*rng).seed));
        h += rng_step(k) * (*rng).pass_number;
    } else {
        h = pcg4d(vec4u((*rng).index, (*rng).pass_number, (*rng).dimension, (*rng).seed));
    }
    (*rng).dimension += 1u;
    return vec4f(h >> vec4u(8u)) * (1.0 / 16777216.0);
}
