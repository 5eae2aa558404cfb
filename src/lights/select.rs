//! Choice of the light for a shadow ray, in proportion to its contribution near the surface point.
//!
//! The leaves of a tree over space have separate cumulative probabilities of the lights, which the
//! host (`pack::cells`) learns from what the camera sees. A scene with one light has no tree. Twin:
//! `shaders/lights/select.wgsl`.

use super::real::{Real, Vec3};
use super::tables::SceneTables;

/// Greatest depth of a leaf.
pub const CELL_DEPTH: u32 = 8;
/// Value of `Cell::axis` in a leaf.
pub const CELL_LEAF: u32 = 3;

/// Returns the first k in `0..count` for which the cumulative value `distributions[first + k]`
/// exceeds `u`, or the last k.
#[inline(always)]
pub fn find_interval(scene: &SceneTables, first: u32, count: u32, u: Real) -> u32 {
    // binary search without branches on the compared values, which are unpredictable
    let mut low = 0;
    let mut length = count;
    while length > 1 {
        let half = length / 2;
        low += if scene.distributions[(first + low + half - 1) as usize] > u { 0 } else { half };
        length -= half;
    }
    low
}

/// First entry in `distributions` of the cumulative probabilities that apply at `position`.
#[inline(always)]
pub fn shares_at(scene: &SceneTables, position: Vec3) -> u32 {
    if scene.cells.is_empty() {
        return 0;
    }
    let mut cell = scene.cells[0];
    for _ in 0..CELL_DEPTH {
        if cell.axis == CELL_LEAF {
            break;
        }
        let above = position[cell.axis as usize] >= cell.split;
        cell = scene.cells[(cell.first + above as u32) as usize];
    }
    cell.first
}

/// Index of the light that `u` chooses by the probabilities at `shares`.
#[inline(always)]
pub fn choose_light(scene: &SceneTables, shares: u32, u: Real) -> u32 {
    find_interval(scene, shares, scene.world.light_count, u)
}

/// Probability of light `index` by the probabilities at `shares`.
#[inline(always)]
pub fn share_of(scene: &SceneTables, shares: u32, index: u32) -> Real {
    let high = scene.distributions[(shares + index) as usize];
    let low = if index > 0 { scene.distributions[(shares + index - 1) as usize] } else { 0.0 };
    high - low
}
