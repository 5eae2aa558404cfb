//! Counter-based random numbers: an integer hash of (index, pass, dimension, seed), the same in every engine.

use super::real::{Real, Vec4};

/// Stream of eye paths.
pub const STREAM_EYE: u32 = 0x8000_0000;
/// Stream of photon paths.
pub const STREAM_PHOTON: u32 = 0;
/// Stream of what a pixel's visible points have in common.
pub const STREAM_STRATA: u32 = 0x4000_0000;

/// The position of one path in its sequence.
#[derive(Clone, Copy, Debug)]
pub struct Rng {
    /// Pixel sample or photon.
    pub index: u32,
    /// Pass.
    pub pass_number: u32,
    /// Next dimension; the top bit tells the stream.
    pub dimension: u32,
    /// Seed.
    pub seed: u32,
}

/// The sequence of path `index` in a pass.
pub fn rng_new(index: u32, pass_number: u32, stream: u32, seed: u32) -> Rng {
    Rng { index, pass_number, dimension: stream, seed }
}

/// pcg4d (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering").
pub fn pcg4d(mut v: [u32; 4]) -> [u32; 4] {
    for x in &mut v {
        *x = x.wrapping_mul(1664525).wrapping_add(1013904223);
    }
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
    for x in &mut v {
        *x ^= *x >> 16;
    }
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
    v
}

/// How far the first dimensions of an eye path move from pass to pass: the fractional parts of the square roots of
/// the first primes, in units of 2^-32 (Richtmyer 1951).
const STEPS: [[u32; 4]; 4] = [
    [0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a],
    [0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19],
    [0xcbbb9d5d, 0x629a292a, 0x9159015a, 0x152fecd8],
    [0x67332667, 0x8eb44a87, 0xdb0c2e0d, 0x47b5481d],
];

/// Four uniform numbers in [0, 1), multiples of 2^-24. The first sixteen of an eye path are a random point per
/// visible point that walks a fixed step each pass: every pass is uniform by itself, and the passes together
/// cover the pixel, the lens and the lights more evenly than chance.
pub fn rng_next(rng: &mut Rng) -> Vec4 {
    let k = rng.dimension.wrapping_sub(STREAM_EYE);
    let mut h;
    if k < 4 {
        h = pcg4d([rng.index, 0, rng.dimension, rng.seed]);
        for (x, step) in h.iter_mut().zip(STEPS[k as usize]) {
            *x = x.wrapping_add(step.wrapping_mul(rng.pass_number));
        }
    } else {
        h = pcg4d([rng.index, rng.pass_number, rng.dimension, rng.seed]);
    }
    rng.dimension += 1;
    Vec4::new((h[0] >> 8) as Real, (h[1] >> 8) as Real, (h[2] >> 8) as Real, (h[3] >> 8) as Real)
        * (1.0 / 16777216.0)
}
