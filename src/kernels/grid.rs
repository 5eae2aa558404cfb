//! The hash grid over photon records: cells in rows along x, hashed into a table of buckets row by
//! row. Two rows may share a bucket, so a reader compares the row's code. Twin:
//! `shaders/kernels/grid.wgsl`.

use super::real::{Real, Vec3};
use glam::IVec3;

/// Farthest cell from the origin; beyond it cells are merged, which costs time and nothing else.
const CELL_MAX: Real = 1e9;
/// Cells along x in the length of one along y or z. A reader reads rows, so that short ones cost it
/// nothing and spare it photons.
const ALONG: Real = 4.0;

/// Cell of a point; `inv_cell` is one over the side length along y and z. Monotone in each
/// coordinate.
pub fn grid_cell(position: Vec3, inv_cell: Real) -> IVec3 {
    let sides = Vec3::new(ALONG, 1.0, 1.0) * inv_cell;
    let p = (position * sides).floor().clamp(Vec3::splat(-CELL_MAX), Vec3::splat(CELL_MAX));
    p.as_ivec3()
}

/// Bucket of a cell: rows along x are hashed (Teschner et al. 2003, primes; then a finaliser so
/// that near rows part), and the cells of a row follow one another, so that a reader finds the
/// photons of several cells side by side.
pub fn grid_bucket(cell: IVec3, mask: u32) -> u32 {
    let mut h = (cell.y as u32).wrapping_mul(19349663) ^ (cell.z as u32).wrapping_mul(83492791);
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb352d);
    h ^= h >> 15;
    h.wrapping_add(cell.x as u32) & mask
}

/// A row along x and a class in one word. Rows less than 1024 apart have different codes, so that
/// two that share a bucket are told apart by whoever visits fewer in a line.
pub fn grid_code(cell: IVec3, photon_class: u32) -> u32 {
    (cell.y as u32 & 0x3ff) | (cell.z as u32 & 0x3ff) << 10 | photon_class << 20
}
