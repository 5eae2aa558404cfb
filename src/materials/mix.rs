//! Mix of two materials: the second one with a probability that a texture may give. Twin:
//! `shaders/materials/mix.wgsl`.

use super::real::Real;
use super::shading::{Layer, ShadingPoint, amount_at, lobe_at};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses one of the two materials.
#[inline(always)]
pub fn choose_mix<'a>(scene: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let amount = amount_at(p);
    if u < amount {
        return Layer { lobe: lobe_at(scene, m.second, p.s.uv), weight: 1.0, u: u / amount };
    }
    let u = (u - amount) / (1.0 - amount).max(1e-6);
    Layer { lobe: lobe_at(scene, m.first, p.s.uv), weight: 1.0, u }
}
