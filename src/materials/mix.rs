//! Mix of two materials: the second one with a probability that a texture may give. Twin:
//! `shaders/materials/mix.wgsl`.

use super::real::Real;
use super::shading::{Layer, ShadingPoint, amount_at, another};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses one of the two materials.
#[inline(always)]
pub fn choose_mix<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let amount = amount_at(p);
    if u < amount {
        return another(p, m.second, u / amount);
    }
    let u = (u - amount) / (1.0 - amount).max(1e-6);
    another(p, m.first, u)
}
