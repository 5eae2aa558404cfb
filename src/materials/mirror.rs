//! Perfect mirror. Twin: `shaders/materials/mirror.wgsl`.

use super::interior::Interior;
use super::real::{Real, Vec3};
use super::shading::{Sample, Scatter, ShadingPoint, reflected};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] =
    &[Material { reflectance: Vec3::new(0.9, 0.8, 0.7), ..Material::EMPTY }];

/// Reflects at the shading normal.
#[inline(always)]
pub fn scatter_mirror(
    _: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    _: Real,
    mode: u32,
) -> Scatter {
    let Sample { direction, weight } = reflected(p, mode);
    Scatter { direction, interior: *interior, weight: weight * p.lobe.reflectance }
}
