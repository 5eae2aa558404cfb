//! Which light a shadow ray goes to: a light is chosen by what it contributes near the surface
//! point.
//!
//! A tree over space has leaves with cumulative probabilities of the lights of their own, learned
//! by the host (`pack::cells`) from what the camera sees. A scene with one light has no tree. Twin:
//! `shaders/lights/select.wgsl`.

use super::light::find_interval;
use super::real::{Real, Vec3};
use super::tables::Scene;

/// Deepest leaf of the tree.
pub const CELL_DEPTH: u32 = 8;
/// `Cell::axis` of a leaf.
pub const CELL_LEAF: u32 = 3;

/// First entry in `distributions` of the cumulative probabilities that hold at `position`.
#[inline(always)]
pub fn shares_at(scene: &Scene, position: Vec3) -> u32 {
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

/// The light that `u` chooses by the probabilities at `shares`.
#[inline(always)]
pub fn choose_light(scene: &Scene, shares: u32, u: Real) -> u32 {
    find_interval(scene, shares, scene.world.light_count, u)
}

/// Probability of light `index` by the probabilities at `shares`.
#[inline(always)]
pub fn share_of(scene: &Scene, shares: u32, index: u32) -> Real {
    let high = scene.distributions[(shares + index) as usize];
    let low = if index > 0 { scene.distributions[(shares + index - 1) as usize] } else { 0.0 };
    high - low
}
