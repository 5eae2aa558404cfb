//! Counter-based random numbers: an integer hash of (index, pass, dimension, seed), the same in
//! every engine. Twin: `shaders/math/rng.wgsl`.

use super::real::{Real, Vec4};

/// Stream of eye paths.
pub const STREAM_EYE: u32 = 0x8000_0000;
/// Stream of photon paths.
pub const STREAM_PHOTON: u32 = 0;
/// Stream of the numbers that the visible points of a pixel share.
pub const STREAM_STRATA: u32 = 0x4000_0000;

/// State of one path's random sequence.
#[derive(Clone, Copy, Debug)]
pub struct Rng {
    /// Index of the pixel sample or photon.
    pub index: u32,
    /// Pass number.
    pub pass_number: u32,
    /// Next dimension; the top bits identify the stream.
    pub dimension: u32,
    /// Seed.
    pub seed: u32,
    /// Sobol point of the pass for the first dimensions of eye paths (see [`crate::math::sobol`]).
    pub points: Points,
}

/// Sixteen coordinates with their bits reversed.
pub type Points = [[u32; 4]; 4];

/// Purely random sequence of path `index` in a pass.
pub fn rng_new(index: u32, pass_number: u32, stream: u32, seed: u32) -> Rng {
    Rng { index, pass_number, dimension: stream, seed, points: [[0; 4]; 4] }
}

/// Sequence of eye path `index` in a pass, which starts with a Sobol point.
pub fn rng_eye(index: u32, pass_number: u32, seed: u32, points: Points) -> Rng {
    Rng { index, pass_number, dimension: STREAM_EYE, seed, points }
}

/// Hash pcg4d (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering").
#[inline(always)]
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

/// Owen scrambling of a digital net by a hash in which each bit depends only on those above it.
/// `reversed` is a coordinate with its bits reversed (Laine & Karras 2011, "Stratified Sampling for
/// Stochastic Transparency"; Burley 2020, "Practical Hash-based Owen Scrambling"; constants of
/// Vegdahl 2021).
#[inline(always)]
fn scrambled(reversed: u32, seed: u32) -> u32 {
    let mut x = reversed;
    x ^= x.wrapping_mul(0x3d20adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x05526c56);
    x ^= x.wrapping_mul(0x53a22864);
    x.reverse_bits()
}

/// Returns four uniform numbers in [0, 1), multiples of 2^-24. The first sixteen of an eye path are
/// the pass's Sobol point, scrambled for each visible point: the numbers of each pass are uniform,
/// and those of all passes together cover the pixel, the lens, the paths through glass and the
/// lights more evenly than random numbers.
#[inline(always)]
pub fn rng_next(rng: &mut Rng) -> Vec4 {
    let k = rng.dimension.wrapping_sub(STREAM_EYE);
    let h = if k < 4 {
        let seeds = pcg4d([rng.index, 0, rng.dimension, rng.seed]);
        let point = rng.points[k as usize];
        std::array::from_fn(|i| scrambled(point[i], seeds[i]))
    } else {
        pcg4d([rng.index, rng.pass_number, rng.dimension, rng.seed])
    };
    rng.dimension += 1;
    Vec4::new((h[0] >> 8) as Real, (h[1] >> 8) as Real, (h[2] >> 8) as Real, (h[3] >> 8) as Real)
        * (1.0 / 16777216.0)
}
