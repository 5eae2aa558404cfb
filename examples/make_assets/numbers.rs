//! Arithmetic that gives the same bits on every machine: only + - * / and square roots, no system
//! `sin`.

use std::f64::consts::PI;

/// Sine and cosine of `x` radians, by Taylor series after reduction to [-pi/4, pi/4]; error below
/// 1e-15.
pub fn sin_cos(x: f64) -> (f64, f64) {
    let quarter = (x / (PI / 2.0)).round();
    let r = x - quarter * (PI / 2.0);
    let r2 = r * r;
    let (mut s, mut c) = (0.0, 0.0);
    for k in (0..9).rev() {
        let k = f64::from(k);
        s = 1.0 - s * r2 / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
        c = 1.0 - c * r2 / ((2.0 * k + 1.0) * (2.0 * k + 2.0));
    }
    let s = s * r;
    match (quarter as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// 0 below `a`, 1 above `b`, a smooth cubic between.
pub fn smoothstep(a: f64, b: f64, x: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear interpolation.
pub fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// A bump of height 1 at 0 that has fallen to a half at `width`.
pub fn bump(x: f64, width: f64) -> f64 {
    1.0 / (1.0 + (x / width) * (x / width))
}

/// The integer hash "pcg" (Jarzynski & Olano 2020) of two coordinates and a seed, as a number in
/// [0, 1).
pub fn hash(x: i64, y: i64, seed: u32) -> f64 {
    let mut h = seed;
    for word in [x as u32, y as u32] {
        h = (h ^ word).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        h = ((h >> ((h >> 28) + 4)) ^ h).wrapping_mul(277_803_737);
        h ^= h >> 22;
    }
    f64::from(h) / 4_294_967_296.0
}

/// Value noise in [0, 1] on a lattice that repeats every `period` cells along each axis.
pub fn noise(x: f64, y: f64, period: (i64, i64), seed: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (smoothstep(0.0, 1.0, x - i), smoothstep(0.0, 1.0, y - j));
    let at = |a: i64, b: i64| {
        hash((i as i64 + a).rem_euclid(period.0), (j as i64 + b).rem_euclid(period.1), seed)
    };
    lerp(lerp(at(0, 0), at(1, 0), u), lerp(at(0, 1), at(1, 1), u), v)
}

/// Four octaves of [`noise`], in [0, 1].
pub fn fbm(x: f64, y: f64, period: (i64, i64), seed: u32) -> f64 {
    let (mut sum, mut scale) = (0.0, 1.0);
    for octave in 0..4_u32 {
        let p = (period.0 << octave, period.1 << octave);
        sum += noise(x * scale, y * scale, p, seed + octave) / (2.0 * scale);
        scale *= 2.0;
    }
    sum / 0.9375
}
