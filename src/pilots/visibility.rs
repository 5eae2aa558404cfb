//! Density of the points that the camera sees around a position.

use super::eye_pilots::{EyePilots, Region};
use super::real::{Real, Vec3};
use std::collections::HashMap;

/// Number of cells across the near sphere in the finest grid.
const ACROSS: Real = 64.0;
/// Ratio of the cell widths of consecutive grids.
const WIDER: Real = 4.0;
/// Number of grids.
const GRIDS: i32 = 5;
/// Number of grids, from the finest, that [`Visibility::is_seen`] searches.
const NEAR_GRIDS: i32 = 2;
/// Minimum number of points in a cell that gives a density.
const LEAST: u32 = 2;

/// Counts of visible points in cells of several widths.
pub struct Visibility {
    counts: HashMap<[i32; 4], u32>,
    center: Vec3,
    width: Real,
    total: f64,
}

impl Visibility {
    /// Counts the visible points of `eyes`.
    pub fn new(eyes: &EyePilots, region: Region) -> Self {
        let width = 2.0 * region.radius / ACROSS;
        let total = eyes.seen.len().max(1) as f64;
        let mut out = Self { counts: HashMap::new(), center: region.center, width, total };
        for seen in &eyes.seen {
            for grid in 0..GRIDS {
                *out.counts.entry(out.cell(seen.position, grid).0).or_default() += 1;
            }
        }
        out
    }

    /// Cell of a grid at `position`, and its width.
    fn cell(&self, position: Vec3, grid: i32) -> ([i32; 4], Real) {
        let width = self.width * WIDER.powi(grid);
        let d = ((position - self.center) / width).floor();
        ([grid, d.x as i32, d.y as i32, d.z as i32], width)
    }

    /// Fraction of the visible points per area around `position`, from the finest grid that has
    /// enough points there.
    pub fn density(&self, position: Vec3) -> f64 {
        for grid in 0..GRIDS {
            let (cell, width) = self.cell(position, grid);
            match self.counts.get(&cell) {
                Some(count) if *count >= LEAST => {
                    let width = f64::from(width);
                    return f64::from(*count) / (width * width * self.total);
                }
                _ => {}
            }
        }
        0.0
    }

    /// Returns whether the camera sees a point close to `position`.
    pub fn is_seen(&self, position: Vec3) -> bool {
        (0..NEAR_GRIDS).any(|grid| self.counts.contains_key(&self.cell(position, grid).0))
    }
}
