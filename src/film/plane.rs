//! One number per pixel, and separable filters.

use rayon::prelude::*;

use super::{Picture, Region};

/// A number for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Pixels per row.
    pub width: usize,
    /// Row by row, row 0 on top.
    pub values: Vec<f64>,
}

impl Plane {
    /// A number of each pixel's color.
    pub fn of(picture: &Picture, value: impl Fn([f32; 3]) -> f64 + Sync) -> Self {
        Self {
            width: picture.width as usize,
            values: picture.rgb.par_iter().map(|&rgb| value(rgb)).collect(),
        }
    }

    /// A number of each pixel's numbers in two planes of one size.
    pub fn zip(&self, other: &Self, value: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        let values =
            self.values.par_iter().zip(&other.values).map(|(&a, &b)| value(a, b)).collect();
        Self { width: self.width, values }
    }

    /// Mean over the pixels of a region that fits.
    pub fn mean(&self, region: &Region) -> f64 {
        let columns = region.x0 as usize..region.x1 as usize;
        let rows = self.values.chunks(self.width).take(region.y1 as usize).skip(region.y0 as usize);
        let sum: f64 = rows.map(|row| row[columns.clone()].iter().sum::<f64>()).sum();
        sum / (columns.len() as f64 * f64::from(region.y1 - region.y0))
    }

    /// Correlates every row with `weights`, whose middle one is that of the pixel itself. Pixels
    /// beyond the border repeat those on it.
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

    /// The same for every column.
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

    /// A plane of this size whose rows are filled in, from zeros, by `fill(y, row)`.
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

/// A Gaussian of standard deviation `sigma` pixels at the whole numbers from `-radius` to `radius`.
pub fn gaussian(sigma: f64, radius: usize) -> Vec<f64> {
    let at = |i: usize| i as f64 - radius as f64;
    (0..=2 * radius).map(|i| (-at(i).powi(2) / (2.0 * sigma * sigma)).exp()).collect()
}

/// Weights over their sum.
pub fn normalized(weights: &[f64]) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}
