//! Guide maps of photon emission: a density over the two random numbers that determine a photon's
//! direction, which favours photons that pass mirrors and glass on their way to what the camera
//! sees (projection maps, Jensen 1996). The host learns the maps from pilot photons before the
//! render (`pack::pilots`; Peter & Pietrek 1998). A photon's flux is divided by its density, so no
//! light is missed or counted twice. Twin: `shaders/lights/guide.wgsl`.

use super::real::{Real, Vec2};
use super::select::find_interval;
use super::shape::pdf_bin;
use super::tables::*;

/// Number of cells along each side of a map.
pub const GUIDE_SIDE: u32 = 32;
/// Number of cells of a map.
pub const GUIDE_CELLS: u32 = GUIDE_SIDE * GUIDE_SIDE;
/// Fraction of the photons of light from infinity that the map emits; lamps use it for all of
/// theirs.
pub const GUIDED: Real = 0.5;

/// Maps the random numbers `across` by the map of `light`, if it has one; returns the new numbers
/// and the reciprocal of their density. `u` chooses the cell.
#[inline(always)]
pub fn guided(scene: &SceneTables, light: &Light, across: Vec2, u: Real) -> (Vec2, Real) {
    if light.guide == 0 {
        return (across, 1.0);
    }
    let cell = find_interval(scene, light.guide, GUIDE_CELLS, u);
    let x = ((cell % GUIDE_SIDE) as Real + across.x) * (1.0 / GUIDE_SIDE as Real);
    let y = ((cell / GUIDE_SIDE) as Real + across.y) * (1.0 / GUIDE_SIDE as Real);
    (Vec2::new(x, y), 1.0 / pdf_bin(scene, light.guide, cell, GUIDE_CELLS))
}

/// Density of the map of `light` at `across`, on the unit square; 0 outside of it.
pub fn pdf_guide(scene: &SceneTables, light: &Light, across: Vec2) -> Real {
    let x = (across.x * GUIDE_SIDE as Real).floor();
    let y = (across.y * GUIDE_SIDE as Real).floor();
    let side = GUIDE_SIDE as Real;
    if x < 0.0 || y < 0.0 || x >= side || y >= side {
        return 0.0;
    }
    pdf_bin(scene, light.guide, y as u32 * GUIDE_SIDE + x as u32, GUIDE_CELLS)
}
