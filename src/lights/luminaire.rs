//! Inversion of piecewise constant densities for lamps that emit an image or a table. Twin:
//! `shaders/lights/luminaire.wgsl`.

use super::math::EPS;
use super::real::Real;
use super::select::find_interval;
use super::tables::*;

/// Sample of a density on [0, 1) that is constant in each of a number of equal bins.
#[derive(Clone, Copy, Debug)]
pub struct Inverted {
    /// Index of the bin.
    pub bin: u32,
    /// Sample.
    pub at: Real,
    /// Density there.
    pub pdf: Real,
}

/// Inverts the cumulative values at `first` of `count` bins: a monotone map, so that a guide map
/// over `u` is one over the samples.
pub fn inverted(scene: &SceneTables, first: u32, count: u32, u: Real) -> Inverted {
    let bin = find_interval(scene, first, count, u);
    let high = scene.distributions[(first + bin) as usize];
    let low = if bin > 0 { scene.distributions[(first + bin - 1) as usize] } else { 0.0 };
    let part = ((u - low) / (high - low)).max(0.0).min(1.0 - EPS);
    let pdf = (high - low) * count as Real;
    Inverted { bin, at: (bin as Real + part) / count as Real, pdf }
}
