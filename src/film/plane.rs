//! Single-channel images and separable filters.

use rayon::prelude::*;

use super::{Picture, Region};

/// A single-channel image.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Pixels per row.
    pub width: usize,
    /// Row by row, row 0 on top.
    pub values: Vec<f64>,
}

impl Plane {
    /// Maps each pixel's color to a number.
    pub fn of(picture: &Picture, value: impl Fn([f32; 3]) -> f64 + Sync) -> Self {
        Self {
            width: picture.width as usize,
            values: picture.rgb.par_iter().map(|&rgb| value(rgb)).collect(),
        }
    }

    /// Combines two planes of equal size, pixel by pixel.
    pub fn zip(&self, other: &Self, value: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        let values =
            self.values.par_iter().zip(&other.values).map(|(&a, &b)| value(a, b)).collect();
        Self { width: self.width, values }
    }

    /// Mean over the pixels of a region, which must lie in the plane.
    pub fn mean(&self, region: &Region) -> f64 {
        let columns = region.x0 as usize..region.x1 as usize;
        let rows = self.values.chunks(self.width).take(region.y1 as usize).skip(region.y0 as usize);
        let sum: f64 = rows.map(|row| row[columns.clone()].iter().sum::<f64>()).sum();
        sum / (columns.len() as f64 * f64::from(region.y1 - region.y0))
    }

    /// Correlates each row with `weights`, an odd number of weights centered on the pixel. Border
    /// pixels are repeated beyond the border.
    pub fn along_x(&self, weights: &[f64]) -> Self {
        let (width, radius) = (self.width, weights.len() / 2);
        self.by_row(|y, sums| {
            let row = &self.values[y * width..(y + 1) * width];
            let mut padded = vec![row[0]; radius];
            padded.extend_from_slice(row);
            padded.resize(width + 2 * radius, row[width - 1]);
            for (shift, weight) in weights.iter().enumerate() {
                add(sums, &padded[shift..shift + width], *weight);
            }
        })
    }

    /// Correlates each column with `weights`, as [`Self::along_x`] does for rows.
    pub fn along_y(&self, weights: &[f64]) -> Self {
        let (width, radius) = (self.width, weights.len() / 2);
        let last = self.values.len() / width - 1;
        self.by_row(|y, sums| {
            for (shift, weight) in weights.iter().enumerate() {
                let from = (y + shift).saturating_sub(radius).min(last);
                add(sums, &self.values[from * width..(from + 1) * width], *weight);
            }
        })
    }

    /// Creates a plane of this size; `fill(y, row)` fills each row, which is initially zero.
    fn by_row(&self, fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).enumerate().for_each(|(y, row)| fill(y, row));
        Self { width: self.width, values }
    }
}

fn add(sums: &mut [f64], row: &[f64], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(row) {
        *sum += weight * value;
    }
}

/// Samples of a Gaussian with standard deviation `sigma` pixels and peak 1 at the integers from
/// `-radius` to `radius`.
pub fn gaussian(sigma: f64, radius: usize) -> Vec<f64> {
    let at = |i: usize| i as f64 - radius as f64;
    (0..=2 * radius).map(|i| (-at(i).powi(2) / (2.0 * sigma * sigma)).exp()).collect()
}

/// Weights divided by their sum.
pub fn normalized(weights: &[f64]) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}
