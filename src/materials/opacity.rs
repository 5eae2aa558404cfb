//! Opacity of a material: the path passes straight through with the probability `1 - opacity`, or
//! where the opacity lies below the cutoff of a mask (`ior`; 0 without a mask). Twin:
//! `shaders/materials/opacity.wgsl`.

use super::Bsdf;
use super::real::{Real, Vec3};
use super::shading::{Layer, Lobe, ShadingPoint, amount_at, another};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses between the material and none.
#[inline(always)]
pub fn choose_opacity<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let mut opacity = amount_at(p);
    if m.ior > 0.0 {
        opacity = if opacity >= m.ior { 1.0 } else { 0.0 };
    }
    if u < opacity {
        return another(p, m.first, u / opacity);
    }
    let lobe = Lobe { bsdf: Bsdf::Null, reflectance: Vec3::ONE, ..p.lobe };
    Layer { lobe, weight: 1.0, u }
}
