//! Hash grid over photon records: cells form rows along x, and rows are hashed into a table of
//! buckets. Two rows may share a bucket, so readers compare the row's code. Twin:
//! `shaders/kernels/grid.wgsl`.

use super::real::{Real, Vec3};
use glam::IVec3;

/// Greatest cell coordinate; cells beyond it are merged, which only costs time.
const CELL_MAX: Real = 1e9;
/// Number of cells along x per cell side along y or z. Readers scan whole rows, so shorter cells
/// cost them nothing and exclude more photons.
const ALONG: Real = 4.0;

/// Cell of a point; `inv_cell` is the reciprocal side length along y and z. Monotone in each
/// coordinate.
pub fn grid_cell(position: Vec3, inv_cell: Real) -> IVec3 {
    let sides = Vec3::new(ALONG, 1.0, 1.0) * inv_cell;
    let p = (position * sides).floor().clamp(Vec3::splat(-CELL_MAX), Vec3::splat(CELL_MAX));
    p.as_ivec3()
}

/// Bucket of a cell. Hashes the row (primes of Teschner et al. 2003, then a finalizer that
/// separates nearby rows); the cells of a row follow one another, so a reader finds the photons of
/// several cells in one contiguous range.
pub fn grid_bucket(cell: IVec3, mask: u32) -> u32 {
    let mut h = (cell.y as u32).wrapping_mul(19349663) ^ (cell.z as u32).wrapping_mul(83492791);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb352d);
    h ^= h >> 15;
    h.wrapping_add(cell.x as u32) & mask
}

/// Row along x and photon class in one word. Rows less than 1024 cells apart have different codes,
/// so a reader that visits fewer than 1024 rows in a line can tell rows in a shared bucket apart.
pub fn grid_code(cell: IVec3, photon_class: u32) -> u32 {
    (cell.y as u32 & 0x3ff) | (cell.z as u32 & 0x3ff) << 10 | photon_class << 20
}
