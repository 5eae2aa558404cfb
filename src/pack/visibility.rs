//! How densely the points that the camera sees lie around a place.

use super::look::{Look, Region};
use super::real::{Real, Vec3};
use std::collections::HashMap;

/// Cells across the near sphere, of the finest grid.
const ACROSS: Real = 64.0;
/// Grids, each with cells this many times as wide as the one before.
const WIDER: Real = 4.0;
/// Number of grids.
const GRIDS: i32 = 5;
/// Grids in which a point that is seen has neighbours.
const NEAR_GRIDS: i32 = 2;
/// Points that make a cell's density.
const LEAST: u32 = 2;

/// Counts of visible points in cells of several widths.
pub struct Visibility {
    counts: HashMap<[i32; 4], u32>,
    center: Vec3,
    width: Real,
    total: f64,
}

impl Visibility {
    /// Of the points of a look.
    pub fn new(look: &Look, region: Region) -> Self {
        let width = 2.0 * region.radius / ACROSS;
        let total = look.seen.len().max(1) as f64;
        let mut out = Self { counts: HashMap::new(), center: region.center, width, total };
        for seen in &look.seen {
            for grid in 0..GRIDS {
                *out.counts.entry(out.cell(seen.position, grid).0).or_default() += 1;
            }
        }
        out
    }

    /// The cell of a grid and its width.
    fn cell(&self, position: Vec3, grid: i32) -> ([i32; 4], Real) {
        let width = self.width * WIDER.powi(grid);
        let d = ((position - self.center) / width).floor();
        ([grid, d.x as i32, d.y as i32, d.z as i32], width)
    }

    /// Visible points per area around `position`, as a share of all: from the finest grid that has
    /// some.
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

    /// Whether the camera sees something close to `position`.
    pub fn is_seen(&self, position: Vec3) -> bool {
        (0..NEAR_GRIDS).any(|grid| self.counts.contains_key(&self.cell(position, grid).0))
    }
}
