//! Whether a render and a truth are two noisy pictures of the same thing.
//!
//! For every block and channel the difference `d` of the means is set against
//!
//! ```text
//! sigma^2 = s^2 / K + SE^2 + (bias T)^2
//! ```
//!
//! from the scatter `s` of the render's `K` parts (the larger of the block's own and the mean over
//! the 3 x 3 blocks around it, since a few parts may all miss what is bright and rarely found), the
//! truth's standard error, and an allowance for the bias of density estimation, a share of the
//! truth `T`. Where both agree, `d / sigma` is about Student-t of `K - 1` degrees of freedom, or
//! narrower. A block is outside when one of its channels is. The same is done for regions of 4 x 4
//! blocks, whose means have less noise: smaller errors show there, if they are wider.

use super::reference::{BlockTruth, Blocks};
use super::student::{poisson_limit, two_sided_tail};
use crate::film::metrics::compare;

/// Deviation, in sigma, from which on a block is outside.
pub const LIMIT: f64 = 4.0;
/// Deviation that no block may have.
pub const LIMIT_FAR: f64 = 8.0;
/// Largest difference of a channel's mean over the picture, as a share of the truth.
pub const MEAN_LIMIT: f64 = 0.005;
/// Standard errors of the ratio, the truth's and the render's joined, that are allowed beside
/// [`MEAN_LIMIT`].
pub const MEAN_ERRORS: f64 = 3.0;
/// Chance that an agreeing render has more blocks outside than allowed.
pub const CHANCE: f64 = 1e-3;
/// Edge of a region in blocks.
pub const REGION: u32 = 4;
/// Rounding of f32 sums, as a share of the truth.
const ROUNDING: f64 = 1e-5;

/// How a render and a truth agree.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Mean of the render over mean of the truth, per channel.
    pub mean_ratio: [f64; 3],
    /// Standard error of the ratio from the render's parts.
    pub ratio_error: [f64; 3],
    /// Standard error of the ratio from the truth.
    pub truth_error: [f64; 3],
    /// relMSE of the block means (see [`crate::film::metrics`]).
    pub rel_mse: f64,
    /// Block by block.
    pub blocks: Deviations,
    /// The same for regions of [`REGION`] x [`REGION`] blocks.
    pub regions: Deviations,
}

/// Deviations in sigma, each that of the channel that deviates most.
#[derive(Clone, Debug)]
pub struct Deviations {
    /// Row by row.
    pub values: Vec<f64>,
    /// How many outside chance alone brings, at most.
    pub expected: f64,
    /// How many it exceeds in a share [`CHANCE`] of renders.
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

    /// Number beyond [`LIMIT`].
    pub fn outside(&self) -> usize {
        self.values.iter().filter(|d| d.is_nan() || d.abs() > LIMIT).count()
    }

    /// The one that is largest in size, or one that is no number.
    pub fn worst(&self) -> f64 {
        self.values.iter().copied().fold(0.0, larger)
    }
}

/// Holds the mean of `parts` (two at least) against `truth`. `bias` is the allowed bias as a share
/// of a block's value.
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

/// Mean and standard error of every block over the parts.
fn block_means(parts: &[Blocks], truth: &BlockTruth) -> Vec<([f64; 3], [f64; 3])> {
    let block = |i: usize| mean_and_error(parts.iter().map(|part| part.rgb[i]), parts.len() as f64);
    (0..truth.mean.rgb.len()).map(block).collect()
}

impl Agreement {
    /// What speaks against agreement; empty when nothing does.
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

/// The deviation that is larger in size; what is no number is larger than any.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.abs() <= a.abs() { a } else { b }
}

/// Indices of the 3 x 3 blocks around block `i`, fewer at the picture's border.
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
