//! Adds one pass's estimate of a pixel to the film and updates the local rule's statistics. Run by
//! one invocation per pixel; reads `visible_points` and `gathered`, updates `statistics` and
//! `film`. Twin: `shaders/kernels/resolve.wgsl`.
//!
//! Under every rule the film stores the mean over passes of `radiance + flux / (M pi r^2)`. For the
//! local rule this equals the paper's `tau / (N_emitted pi R^2)`: tau and R^2 shrink by the same
//! factor, so `tau_P / R_P^2 = tau_{P-1} / R_{P-1}^2 + Phi_P / R_{P-1}^2`.

use super::gather::scale_sq;
use super::math::{PI, is_finite, luminance, max_abs};
use super::real::{Real, Vec3};
use super::records::*;

/// `drop` is subtracted from `scale_sq` when it exceeds this fraction of it.
const DROP_SHARE: Real = 1.0 / 256.0;

/// `carry` is added to `mean` when it exceeds this fraction of it.
const CARRY_SHARE: Real = 1.0 / 256.0;

/// Estimate of one pass.
#[derive(Clone, Copy)]
pub struct Estimate {
    /// Radiance, W sr^-1 m^-2 of scene units.
    pub radiance: Vec3,
    /// Luminance of the estimate from the whole disc less that from the inner half of its area.
    pub bias_probe: Real,
    /// Scaled luminance difference between two halves of the samples, see [`FilmPixel::halves`].
    pub halves: Real,
}

/// Estimate of one visible point in this pass; `halves` is 0.
pub fn pass_found(
    point: &VisiblePoint,
    gathered: &Gathered,
    scale_sq: Real,
    photons: Real,
) -> Estimate {
    if gathered.count == 0 {
        return Estimate { radiance: point.radiance, bias_probe: 0.0, halves: 0.0 };
    }
    let area = PI * point.radius * point.radius * scale_sq;
    let share = 1.0 / (photons * area);
    Estimate {
        radiance: point.radiance + gathered.flux * share,
        bias_probe: gathered.bias_probe * share,
        halves: 0.0,
    }
}

/// Weight of sample `k` of a pixel in [`Estimate::halves`]. The strata are split like the fields of
/// a chessboard, so that a gradient across the pixel affects both halves alike. With a and b
/// samples in them, the difference of their means times `sqrt(a b) / (a + b)` has the variance of
/// the mean over all samples.
pub fn half_weight(k: u32, eye_samples: u32, strata: u32) -> Real {
    if eye_samples == 1 {
        return 0.0;
    }
    // with an odd number of strata the first colour has one more; with an even number of columns
    // both have the same number
    let first = eye_samples.div_ceil(2) as Real;
    let second = (eye_samples / 2) as Real;
    let row = k / strata;
    let odd = (k - row * strata + row) & 1;
    let ratio = if odd == 0 { second / first } else { first / second };
    let size = ratio.sqrt() / (first + second);
    if odd == 0 { size } else { -size }
}

/// Updates the local statistics after `m` photons by Hachisuka's rule with `N = alpha T`, T the
/// photons so far: `R'^2 = R^2 alpha (T + m) / (alpha T + m)`.
pub fn update_statistics(statistics: &mut Statistics, m: u32, alpha: Real) {
    if statistics.scale_sq == 0.0 {
        statistics.scale_sq = 1.0;
    }
    if m == 0 {
        return;
    }
    let t = statistics.count_high as Real * 4294967296.0 + statistics.count_low as Real;
    // accumulate the small decreases in `drop`, so that rounding does not lose them
    let scale_sq = statistics.scale_sq - statistics.drop;
    statistics.drop += scale_sq * ((1.0 - alpha) * m as Real / (alpha * t + m as Real));
    if statistics.drop > DROP_SHARE * statistics.scale_sq {
        statistics.scale_sq -= statistics.drop;
        statistics.drop = 0.0;
    }
    // 64-bit count in two words
    let low = statistics.count_low.wrapping_add(m);
    if low < m {
        statistics.count_high += 1;
    }
    statistics.count_low = low;
}

/// Folds the visible points of a pixel in this pass into `film`. `statistics` has one entry per
/// visible point under the local rule.
pub fn resolve(
    dispatch: &Dispatch,
    points: &[VisiblePoint],
    gathered: &[Gathered],
    mut statistics: Option<&mut [Statistics]>,
    film: &mut FilmPixel,
) {
    // sum the estimates of the pixel's samples
    let mut sum = Estimate { radiance: Vec3::ZERO, bias_probe: 0.0, halves: 0.0 };
    let mut state = 0;
    let mut photons_finite = true;
    for k in 0..dispatch.eye_samples as usize {
        let mut scale = dispatch.scale_sq;
        if let Some(all) = &mut statistics {
            scale = scale_sq(dispatch, true, &all[k]);
            update_statistics(&mut all[k], gathered[k].count, dispatch.alpha);
        }
        state |= points[k].state;
        photons_finite &= is_finite(gathered[k].flux);
        let found = pass_found(&points[k], &gathered[k], scale, dispatch.photons);
        sum.radiance += found.radiance;
        sum.bias_probe += found.bias_probe;
        sum.halves += half_weight(k as u32, dispatch.eye_samples, dispatch.strata)
            * luminance(found.radiance);
    }
    let share = 1.0 / dispatch.eye_samples as Real;
    let mean = Estimate {
        radiance: sum.radiance * share,
        bias_probe: sum.bias_probe * share,
        halves: sum.halves,
    };
    fold(dispatch, cause(state, photons_finite), mean, film);
}

/// Reason to reject a pass, as far as its inputs show, or [`ACCEPTED`].
pub fn cause(state: u32, photons_finite: bool) -> u32 {
    if state & BAD_EYE != 0 {
        return REJECTED_EYE;
    }
    if state & BAD_DIRECT != 0 {
        return REJECTED_DIRECT;
    }
    if photons_finite { ACCEPTED } else { REJECTED_PHOTONS }
}

/// Adds the estimate of one pass to a pixel's means, or counts it under its reason for rejection.
///
/// The n-th pass deviates from the mean of the passes before it by delta. `sqrt((n - 1) / n) delta`
/// has mean zero and the variance of a pass, and is uncorrelated with its predecessors (Helmert
/// 1876).
pub fn fold(dispatch: &Dispatch, cause: u32, found: Estimate, film: &mut FilmPixel) {
    let value = found.radiance;
    let counted = if cause == ACCEPTED && !is_finite(value) { REJECTED_ESTIMATE } else { cause };
    if counted != ACCEPTED {
        film.rejected[counted as usize] += 1;
        return;
    }
    // number of accepted passes; record the mean when it is a power of two
    let r = film.rejected;
    let before = dispatch.passes_done - (r[0] + r[1] + r[2] + r[3]);
    if before & before.wrapping_sub(1) == 0 {
        film.mean_at_half_pow2 = film.mean_at_pow2;
        film.mean_at_pow2 = luminance(film.mean + film.carry);
    }
    // running means; the mean itself is updated through `carry`, so that rounding does not lose
    // small changes
    let n = (before + 1) as Real;
    let share = 1.0 / n;
    let delta = value - (film.mean + film.carry);
    let deviation = luminance(delta) * ((n - 1.0) * share).sqrt();
    let sign = if dispatch.passes_done & 1 == 0 { 1.0 } else { -1.0 };
    film.spread += (deviation * deviation - film.spread) * share;
    film.bias_probe += (found.bias_probe - film.bias_probe) * share;
    film.bias_probe_alternating += (sign * found.bias_probe - film.bias_probe_alternating) * share;
    film.halves += (found.halves - film.halves) * share;
    film.carry += delta * share;
    if max_abs(film.carry) > CARRY_SHARE * max_abs(film.mean) {
        film.mean += film.carry;
        film.carry = Vec3::ZERO;
    }
}
