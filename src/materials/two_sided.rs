//! A material for each side of a surface. Twin: `shaders/materials/two_sided.wgsl`.

use super::real::Real;
use super::shading::{Layer, ShadingPoint, another};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses the material of the side that the path is on; the normal points to the front.
#[inline(always)]
pub fn choose_two_sided<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let side = if p.wo.dot(p.s.normal) >= 0.0 { m.first } else { m.second };
    another(p, side, u)
}
