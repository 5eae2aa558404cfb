//! One pixel's estimate of the pass into the film, and the local rule's statistics. Run by one invocation per
//! pixel; reads `visible_points` and `gathered`, updates `statistics` and `film`. Twin:
//! `shaders/kernels/resolve.wgsl`.
//!
//! Under every rule the film holds the mean over passes of `radiance + flux / (M pi r^2)`. For the local rule
//! this is the paper's `tau / (N_emitted pi R^2)`: tau and R^2 shrink by the same factor, so that
//! `tau_P / R_P^2 = tau_{P-1} / R_{P-1}^2 + Phi_P / R_{P-1}^2`.

use super::gather::scale_sq;
use super::math::{PI, is_finite, max_abs};
use super::real::{Real, Vec3};
use super::records::*;

/// `drop` is taken from `scale_sq` when it exceeds this share of it.
const DROP_SHARE: Real = 1.0 / 256.0;

/// `carry` is put into `mean` when it exceeds this share of it.
const CARRY_SHARE: Real = 1.0 / 256.0;

/// Radiance that one visible point found in this pass.
pub fn pass_radiance(point: &VisiblePoint, gathered: &Gathered, scale_sq: Real, photons: Real) -> Vec3 {
    if gathered.count == 0 {
        return point.radiance;
    }
    let area = PI * point.radius * point.radius * scale_sq;
    point.radiance + gathered.flux * (1.0 / (photons * area))
}

/// Hachisuka's rule with `N = alpha T`, T photons so far: `R'^2 = R^2 alpha (T + m) / (alpha T + m)`.
pub fn update_statistics(statistics: &mut Statistics, m: u32, alpha: Real) {
    if statistics.scale_sq == 0.0 {
        statistics.scale_sq = 1.0;
    }
    if m == 0 {
        return;
    }
    let t = statistics.count_high as Real * 4294967296.0 + statistics.count_low as Real;
    let scale_sq = statistics.scale_sq - statistics.drop;
    statistics.drop += scale_sq * ((1.0 - alpha) * m as Real / (alpha * t + m as Real));
    if statistics.drop > DROP_SHARE * statistics.scale_sq {
        statistics.scale_sq -= statistics.drop;
        statistics.drop = 0.0;
    }
    let low = statistics.count_low.wrapping_add(m);
    if low < m {
        statistics.count_high += 1;
    }
    statistics.count_low = low;
}

/// Folds a pixel's visible points of this pass into `film`. `statistics` holds one entry per visible point under
/// the local rule.
pub fn resolve(
    dispatch: &Dispatch,
    points: &[VisiblePoint],
    gathered: &[Gathered],
    mut statistics: Option<&mut [Statistics]>,
    film: &mut FilmPixel,
) {
    let mut sum = Vec3::ZERO;
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
        sum += pass_radiance(&points[k], &gathered[k], scale, dispatch.photons);
    }
    fold(dispatch, cause(state, photons_finite), sum * (1.0 / dispatch.eye_samples as Real), film);
}

/// Why a pass cannot count, as far as its parts show.
pub fn cause(state: u32, photons_finite: bool) -> u32 {
    if state & BAD_EYE != 0 {
        return REJECTED_EYE;
    }
    if state & BAD_DIRECT != 0 {
        return REJECTED_DIRECT;
    }
    if photons_finite { ACCEPTED } else { REJECTED_PHOTONS }
}

/// Adds one pass's value to a pixel's mean, or counts it under its cause.
pub fn fold(dispatch: &Dispatch, cause: u32, value: Vec3, film: &mut FilmPixel) {
    let found = if cause == ACCEPTED && !is_finite(value) { REJECTED_ESTIMATE } else { cause };
    if found != ACCEPTED {
        film.rejected[found as usize] += 1;
        return;
    }
    let r = film.rejected;
    let n = (dispatch.passes_done + 1 - (r[0] + r[1] + r[2] + r[3])) as Real;
    film.carry += (value - (film.mean + film.carry)) * (1.0 / n);
    if max_abs(film.carry) > CARRY_SHARE * max_abs(film.mean) {
        film.mean += film.carry;
        film.carry = Vec3::ZERO;
    }
}
