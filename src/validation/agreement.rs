//! Statistical agreement of a render with a reference, given the noise of both.
//!
//! For each block and channel, the difference `d` of the means is divided by `sigma`,
//!
//! ```text
//! sigma^2 = s^2 / K + SE^2 + (bias T)^2
//! ```
//!
//! computed from the standard deviation `s` over the render's `K` parts, the reference's standard
//! error `SE`, and an allowance for the bias of density estimation as a fraction of the reference
//! `T`. `s` is the larger of the block's own value and the root mean square over the surrounding
//! 3 x 3 blocks, since a few parts may all miss rare bright samples. If render and reference agree,
//! `d / sigma` approximately follows a Student t distribution with `K - 1` degrees of freedom, or a
//! narrower one. A block is an outlier if one of its channels is. The same test runs on regions of
//! 4 x 4 blocks, whose means are less noisy, to detect smaller but wider errors.

use super::reference::{BlockTruth, Blocks};
use super::student::{poisson_limit, two_sided_tail};
use crate::film::metrics::compare;

/// Absolute deviation, in sigma, above which a block is an outlier.
pub const LIMIT: f64 = 4.0;
/// Absolute deviation, in sigma, that no block may exceed.
pub const LIMIT_FAR: f64 = 8.0;
/// Maximum relative difference of a channel's mean over the image.
pub const MEAN_LIMIT: f64 = 0.005;
/// Number of combined standard errors of the mean ratio that are allowed in addition to
/// [`MEAN_LIMIT`].
pub const MEAN_ERRORS: f64 = 3.0;
/// Probability that a render that agrees has more outliers than allowed.
pub const CHANCE: f64 = 1e-3;
/// Edge of a region in blocks.
pub const REGION: u32 = 4;
/// Rounding error of f32 sums, as a fraction of the reference.
const ROUNDING: f64 = 1e-5;

/// Result of the comparison of a render with a reference.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Mean of the render divided by mean of the reference, per channel.
    pub mean_ratio: [f64; 3],
    /// Standard error of the ratio due to the render's noise.
    pub ratio_error: [f64; 3],
    /// Standard error of the ratio due to the reference's noise.
    pub truth_error: [f64; 3],
    /// relMSE of the block means (see [`crate::film::metrics`]).
    pub rel_mse: f64,
    /// Deviations of blocks.
    pub blocks: Deviations,
    /// Deviations of regions of [`REGION`] x [`REGION`] blocks.
    pub regions: Deviations,
}

/// Deviations of blocks or regions.
#[derive(Clone, Debug)]
pub struct Deviations {
    /// Deviation of the worst channel in sigma, row by row.
    pub values: Vec<f64>,
    /// Upper bound on the expected number of outliers of a render that agrees.
    pub expected: f64,
    /// Number of outliers that a render that agrees exceeds with probability [`CHANCE`] at most.
    pub allowed: usize,
}

impl Deviations {
    fn of(parts: &[Blocks], truth: &BlockTruth, bias: f64) -> Self {
        let squares = block_means(parts, truth);
        let values = (0..squares.len()).map(|i| {
            let (truth_value, truth_error) = (truth.mean.rgb[i], truth.standard_error.rgb[i]);
            let ((mean, own), around) = (&squares[i], neighbours(i, &truth.mean));
            (0..3).fold(0.0, |largest: f64, c| {
                let share = bias * bias + ROUNDING * ROUNDING;
                let pooled = around.iter().map(|&j| squares[j].1[c].powi(2)).sum::<f64>()
                    / around.len() as f64;
                let variance = own[c].powi(2).max(pooled)
                    + truth_error[c].powi(2)
                    + share * truth_value[c].powi(2);
                let deviation = (mean[c] - truth_value[c]) / (variance + f64::MIN_POSITIVE).sqrt();
                larger(largest, deviation)
            })
        });
        let expected = 3.0 * two_sided_tail(LIMIT, parts.len() as u32 - 1) * squares.len() as f64;
        Self { values: values.collect(), expected, allowed: poisson_limit(expected, CHANCE) }
    }

    /// Number of outliers, i.e. values beyond [`LIMIT`] or NaN.
    pub fn outside(&self) -> usize {
        self.values.iter().filter(|d| d.is_nan() || d.abs() > LIMIT).count()
    }

    /// Value of the largest magnitude, or NaN if there is one.
    pub fn worst(&self) -> f64 {
        self.values.iter().copied().fold(0.0, larger)
    }
}

/// Compares the mean of `parts` (at least two) with `truth`. `bias` is the allowed bias as a
/// fraction of a block's value.
pub fn hold(parts: &[Blocks], truth: &BlockTruth, bias: f64) -> Agreement {
    let (mean, error) = mean_and_error(parts.iter().map(Blocks::mean), parts.len() as f64);
    let (truth_mean, truth_error) = (truth.mean.mean(), truth.mean_error());
    let render = Blocks {
        rgb: block_means(parts, truth).iter().map(|(mean, _)| *mean).collect(),
        ..truth.mean
    };
    let coarse: Vec<_> = parts.iter().map(|part| part.coarser(REGION)).collect();
    Agreement {
        mean_ratio: [0, 1, 2].map(|c| mean[c] / truth_mean[c]),
        ratio_error: [0, 1, 2].map(|c| error[c] / truth_mean[c]),
        truth_error: [0, 1, 2].map(|c| truth_error[c] / truth_mean[c]),
        rel_mse: compare(&render.picture(), &truth.mean.picture()).map_or(f64::NAN, |c| c.rel_mse),
        blocks: Deviations::of(parts, truth, bias),
        regions: Deviations::of(&coarse, &truth.coarser(REGION), bias),
    }
}

/// Mean and standard error of each block over the parts.
fn block_means(parts: &[Blocks], truth: &BlockTruth) -> Vec<([f64; 3], [f64; 3])> {
    let block = |i: usize| mean_and_error(parts.iter().map(|part| part.rgb[i]), parts.len() as f64);
    (0..truth.mean.rgb.len()).map(block).collect()
}

impl Agreement {
    /// Names of the failed criteria; empty if the render agrees with the reference.
    pub fn faults(&self) -> Vec<&'static str> {
        let mean = (0..3).all(|c| {
            let error = self.truth_error[c].hypot(self.ratio_error[c]);
            (self.mean_ratio[c] - 1.0).abs() <= MEAN_LIMIT + MEAN_ERRORS * error
        });
        let found = [
            (!mean, "mean"),
            (self.blocks.outside() > self.blocks.allowed, "blocks"),
            (self.regions.outside() > self.regions.allowed, "regions"),
            (self.blocks.worst().is_nan() || self.blocks.worst().abs() > LIMIT_FAR, "one block"),
        ];
        found.into_iter().filter(|(fault, _)| *fault).map(|(_, name)| name).collect()
    }
}

/// Value of the larger magnitude; NaN is larger than any number.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.abs() <= a.abs() { a } else { b }
}

/// Indices of the 3 x 3 blocks around block `i`, fewer at the image border.
fn neighbours(i: usize, blocks: &Blocks) -> Vec<usize> {
    let (width, height) = (blocks.width as usize, blocks.height as usize);
    let (x, y) = (i % width, i / width);
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    rows.flat_map(|row| {
        (x.saturating_sub(1)..(x + 2).min(width)).map(move |column| row * width + column)
    })
    .collect()
}

/// Mean of `K` values per channel and its standard error.
fn mean_and_error(values: impl Iterator<Item = [f64; 3]> + Clone, k: f64) -> ([f64; 3], [f64; 3]) {
    let mean = [0, 1, 2].map(|c| values.clone().map(|v| v[c]).sum::<f64>() / k);
    let error = [0, 1, 2].map(|c| {
        let square = values.clone().map(|v| (v[c] - mean[c]).powi(2)).sum::<f64>();
        (square / (k * (k - 1.0))).sqrt()
    });
    (mean, error)
}
