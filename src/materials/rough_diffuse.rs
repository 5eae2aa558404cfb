//! Rough diffuse reflection: the reciprocal form of Oren & Nayar's model by Fujii (2012, "A tiny
//! improvement of Oren-Nayar reflectance model"),
//!
//! `f = rho (1 + sigma s / t) / (pi + (pi / 2 - 2 / 3) sigma)`
//!
//! with `s = wi . wo - (wi . n) (wo . n)` and `t = max(wi . n, wo . n)` if `s > 0`, else 1; `sigma`
//! is the roughness in [0, 1]. At most `rho` of the light is reflected. Twin:
//! `shaders/materials/rough_diffuse.wgsl`.

use super::math::sampling::sample_cosine;
use super::math::{INV_PI, PI, from_frame};
use super::real::{Real, Vec3};
use super::shading::{CosineAxis, Lobe, Sample, ShadingPoint, cosine_axis, pdf_cosine, renormalized};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.6, 0.3), alpha: 0.4, ..Material::EMPTY },
    Material { reflectance: Vec3::new(0.7, 0.7, 0.7), alpha: 1.0, ..Material::EMPTY },
];
/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = true;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Lower bound of `t`.
const COS_MIN: Real = 1e-2;

/// `pi f / rho`.
#[inline(always)]
fn rho_ratio(sigma: Real, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let cos_i = wi.dot(n);
    let cos_o = wo.dot(n);
    let s = wi.dot(wo) - cos_i * cos_o;
    let t = if s > 0.0 { cos_i.max(cos_o).max(COS_MIN) } else { 1.0 };
    PI * (1.0 + sigma * (s / t)) / (PI + (0.5 * PI - 0.666_666_7) * sigma)
}

/// BRDF times cosine: `f cos`.
#[inline(always)]
pub fn eval_rough_diffuse(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    lobe.reflectance * (INV_PI * cos * rho_ratio(lobe.alpha, n, wo, wi).max(0.0))
}

/// Density of the cosine-weighted direction: `cos / pi`, sr^-1.
#[inline(always)]
pub fn pdf_rough_diffuse(_: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Real {
    pdf_cosine(n, wi)
}

/// Samples a direction by the cosine; for photons about the geometric normal, as on diffuse
/// surfaces.
#[inline(always)]
pub fn sample_rough_diffuse(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let CosineAxis { axis, mut weight } = cosine_axis(p, mode);
    let wi = renormalized(from_frame(axis, sample_cosine(u.truncate())));
    if wi.dot(p.ng) <= 0.0 || wi.dot(p.n) <= 0.0 {
        weight = Vec3::ZERO;
    }
    weight *= rho_ratio(p.lobe.alpha, p.n, p.wo, wi).max(0.0);
    Sample { direction: wi, weight }
}
