//! Diffuse reflection and transmission by a thin surface, such as paper, leaves or lampshades: the
//! fraction `alpha` of the reflectance `rho` leaves on the other side. Twin:
//! `shaders/materials/translucent.wgsl`.

use super::math::sampling::sample_cosine;
use super::math::{INV_PI, from_frame};
use super::real::{Real, Vec2, Vec3};
use super::shading::{CosineAxis, Lobe, Sample, ShadingPoint, cosine_axis, renormalized};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.8, 0.4), alpha: 0.5, ..Material::EMPTY },
    Material { reflectance: Vec3::new(0.6, 0.6, 0.9), alpha: 1.0, ..Material::EMPTY },
];
/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = true;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = true;

/// Fraction of the light that leaves on the side of a direction with cosine `cos` to `n`.
#[inline(always)]
fn side_share(alpha: Real, cos: Real) -> Real {
    if cos > 0.0 { 1.0 - alpha } else { alpha }
}

/// BSDF times cosine: `rho |cos| / pi` times the side's fraction.
#[inline(always)]
pub fn eval_translucent(lobe: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    lobe.reflectance * (INV_PI * cos.abs() * side_share(lobe.alpha, cos))
}

/// Density: `|cos| / pi` times the side's fraction, sr^-1.
#[inline(always)]
pub fn pdf_translucent(lobe: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Real {
    let cos = wi.dot(n);
    INV_PI * cos.abs() * side_share(lobe.alpha, cos)
}

/// Samples a side by its fraction and a direction by the cosine; for photons about the geometric
/// normal, as on diffuse surfaces.
#[inline(always)]
pub fn sample_translucent(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let alpha = p.lobe.alpha;
    let CosineAxis { axis, mut weight } = cosine_axis(p, mode);
    // choose the side and stretch the number that chose it to [0, 1]
    let mut x = (u.x - alpha) / (1.0 - alpha).max(1e-6);
    let mut side = 1.0;
    if u.x < alpha {
        x = u.x / alpha;
        side = -1.0;
    }
    let local = sample_cosine(Vec2::new(x.clamp(0.0, 1.0), u.y));
    let wi = renormalized(from_frame(axis, Vec3::new(local.x, local.y, local.z * side)));
    if wi.dot(p.ng) * side <= 0.0 {
        weight = Vec3::ZERO;
    }
    Sample { direction: wi, weight }
}
