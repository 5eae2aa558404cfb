//! Block-wise statistical test of a render against a reference.
//!
//! The mean luminance difference `d` of a block is divided by its standard deviation
//!
//! ```text
//! sigma^2 = s^2 / n + sum SE^2 / n^2 + (model * truth)^2
//! ```
//!
//! computed from the standard deviation `s` of the difference within the block (noise of both
//! images, and detail that differs), the reference's standard errors `SE`, and an allowance for
//! the bias of density estimation. If the render agrees with the reference, `d / sigma` follows a
//! Student t distribution with 63 degrees of freedom, so |d| > 4 sigma occurs by chance in 1.7e-4
//! of the blocks.

use super::metrics::{MetricsError, check_comparable};
use super::{Picture, luminance};

/// Edge of a block in pixels. Columns and rows that do not fill a whole block are ignored.
pub const BLOCK: u32 = 8;

/// Absolute deviation, in sigma, above which a block is an outlier.
pub const LIMIT: f64 = 4.0;

/// Lower bound that keeps the sigma of black blocks above zero.
const SMALLEST_VARIANCE: f64 = 1e-14;

/// Deviation of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Column of the leftmost pixels.
    pub x: u32,
    /// Row of the topmost pixels.
    pub y: u32,
    /// Mean luminance difference (render minus reference) divided by its sigma.
    pub deviation: f64,
}

impl Block {
    /// Returns true if the block deviates by more than [`LIMIT`] sigma.
    pub fn outside(&self) -> bool {
        self.deviation.abs() > LIMIT
    }
}

/// Compares `render` with `truth`, whose standard errors are `standard_error` if known. `model` is
/// the allowed bias as a fraction of the block's mean luminance, e.g. 0.01.
pub fn block_deviations(
    render: &Picture,
    truth: &Picture,
    standard_error: Option<&Picture>,
    model: f64,
) -> Result<Vec<Block>, MetricsError> {
    check_comparable(render, truth)?;
    if let Some(standard_error) = standard_error {
        check_comparable(standard_error, truth)?;
    }
    let mut blocks = Vec::new();
    for y in (0..truth.height / BLOCK).map(|row| row * BLOCK) {
        for x in (0..truth.width / BLOCK).map(|column| column * BLOCK) {
            let pixels =
                || (0..BLOCK * BLOCK).map(|i| pixel_index(truth, x + i % BLOCK, y + i / BLOCK));
            let mean = |value: &dyn Fn(usize) -> f64| {
                pixels().map(value).sum::<f64>() / f64::from(BLOCK * BLOCK)
            };
            let difference = |i: usize| luminance(render.rgb[i]) - luminance(truth.rgb[i]);
            let d = mean(&difference);
            let scatter = mean(&|i| (difference(i) - d).powi(2));
            let error = standard_error.map_or(0.0, |se| mean(&|i| luminance(se.rgb[i]).powi(2)));
            let bias = model * mean(&|i| luminance(truth.rgb[i]));
            let variance =
                (scatter + error) / f64::from(BLOCK * BLOCK) + bias.powi(2) + SMALLEST_VARIANCE;
            blocks.push(Block { x, y, deviation: d / variance.sqrt() });
        }
    }
    Ok(blocks)
}

/// Fraction of blocks that are outliers, in [0, 1]; zero without blocks.
pub fn share_outside(blocks: &[Block]) -> f64 {
    let outside = blocks.iter().filter(|block| block.outside()).count();
    outside as f64 / blocks.len().max(1) as f64
}

fn pixel_index(picture: &Picture, x: u32, y: u32) -> usize {
    y as usize * picture.width as usize + x as usize
}
