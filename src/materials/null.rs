//! No material: paths pass straight through. Twin: `shaders/materials/null.wgsl`.

use super::interior::Interior;
use super::real::Real;
use super::shading::{Scatter, ShadingPoint};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[Material { reflectance: super::Vec3::ONE, ..Material::EMPTY }];

/// Continues in the same direction.
#[inline(always)]
pub fn scatter_null(
    _: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    _: Real,
    _: u32,
) -> Scatter {
    Scatter { direction: -p.wo, interior: *interior, weight: p.lobe.reflectance }
}
