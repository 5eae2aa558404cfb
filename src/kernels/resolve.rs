//! One pixel's estimate of the pass into the film, and the local rule's statistics. Run by one invocation per
//! pixel; reads `visible_points` and `gathered`, updates `statistics` and `film`. Twin:
//! `shaders/kernels/resolve.wgsl`.
//!
//! Under every rule the film holds the mean over passes of `radiance + flux / (M pi r^2)`. For the local rule
//! this is the paper's `tau / (N_emitted pi R^2)`: tau and R^2 shrink by the same factor, so that
//! `tau_P / R_P^2 = tau_{P-1} / R_{P-1}^2 + Phi_P / R_{P-1}^2`.

use super::gather::scale_sq;
use super::math::PI;
use super::real::{EXPONENT, Real, Vec3};
use super::records::{Dispatch, FilmPixel, Gathered, Statistics, VisiblePoint};

/// `drop` is taken from `scale_sq` when it exceeds this share of it.
const DROP_SHARE: Real = 1.0 / 4096.0;

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

/// Whether every component is a number (told from the bits, since a shader compiler may assume it).
pub fn is_finite(v: Vec3) -> bool {
    [v.x, v.y, v.z].iter().all(|x| x.to_bits() & EXPONENT != EXPONENT)
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
    for k in 0..dispatch.eye_samples as usize {
        let mut scale = dispatch.scale_sq;
        if let Some(all) = &mut statistics {
            scale = scale_sq(dispatch, true, &all[k]);
            update_statistics(&mut all[k], gathered[k].count, dispatch.alpha);
        }
        sum += pass_radiance(&points[k], &gathered[k], scale, dispatch.photons);
    }
    fold(dispatch, sum * (1.0 / dispatch.eye_samples as Real), film);
}

/// Adds one pass's value to a pixel's mean.
pub fn fold(dispatch: &Dispatch, value: Vec3, film: &mut FilmPixel) {
    if !is_finite(value) {
        film.rejected += 1;
        return;
    }
    let n = (dispatch.passes_done + 1 - film.rejected) as Real;
    film.mean += (value - film.mean) * (1.0 / n);
}
