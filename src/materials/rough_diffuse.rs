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
use super::real::{Real, Vec2, Vec3};
use super::shading::{IMPORTANCE, Lobe, Sample, ShadingPoint, renormalized};
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

/// Lower bound of the cosine to the geometric normal that the shading-normal correction divides by,
/// and of `t`.
const ADJOINT_COS_MIN: Real = 1e-2;

/// `pi f / rho`.
#[inline(always)]
fn facets_of(sigma: Real, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let cos_i = wi.dot(n);
    let cos_o = wo.dot(n);
    let s = wi.dot(wo) - cos_i * cos_o;
    let t = if s > 0.0 { cos_i.max(cos_o).max(ADJOINT_COS_MIN) } else { 1.0 };
    PI * (1.0 + sigma * (s / t)) / (PI + (0.5 * PI - 0.666_666_7) * sigma)
}

/// BRDF times cosine: `f cos`.
#[inline(always)]
pub fn eval_rough_diffuse(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    lobe.reflectance * (INV_PI * cos * facets_of(lobe.alpha, n, wo, wi).max(0.0))
}

/// Density of the cosine-weighted direction: `cos / pi`, sr^-1.
#[inline(always)]
pub fn pdf_rough_diffuse(_: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Real {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    cos * INV_PI
}

/// Samples a direction by the cosine; for photons about the geometric normal, as on diffuse
/// surfaces.
#[inline(always)]
pub fn sample_rough_diffuse(p: &ShadingPoint, u: Vec2, mode: u32) -> Sample {
    let mut axis = p.n;
    let mut weight = p.lobe.reflectance;
    if mode == IMPORTANCE {
        axis = p.ng;
        if p.s.shading != p.s.normal {
            weight *= p.wo.dot(p.n).max(0.0) / p.wo.dot(p.ng).max(ADJOINT_COS_MIN);
        }
    }
    let wi = renormalized(from_frame(axis, sample_cosine(u)));
    if wi.dot(p.ng) <= 0.0 || wi.dot(p.n) <= 0.0 {
        weight = Vec3::ZERO;
    }
    weight *= facets_of(p.lobe.alpha, p.n, p.wo, wi).max(0.0);
    Sample { direction: wi, weight }
}
