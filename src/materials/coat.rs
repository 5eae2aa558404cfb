//! Rough dielectric coat of [`super::plastic`]: reflection by GGX microfacets with the Fresnel term
//! of a dielectric. Twin: `shaders/materials/coat.wgsl`.

use super::fresnel::fresnel;
use super::microfacet::*;
use super::real::{Real, Vec3};
use super::shading::{Lobe, Sample, ShadingPoint};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] =
    &[Material { reflectance: Vec3::ONE, ior: 1.5, alpha: 0.09, ..Material::EMPTY }];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// BRDF times the cosine to `n`.
#[inline(always)]
pub fn eval_coat(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let Facets { cos_d, cos_i, brdf, .. } = facets_at(n, wo, wi, lobe.alpha);
    if brdf <= 0.0 {
        return Vec3::ZERO;
    }
    lobe.reflectance * (fresnel(cos_d, 1.0 / lobe.m.ior).reflectance * brdf * cos_i)
}

/// Density of [`sample_coat`], sr^-1.
#[inline(always)]
pub fn pdf_coat(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    pdf_facets(n, wo, wi, lobe.alpha)
}

/// Samples a direction by the distribution of visible normals.
#[inline(always)]
pub fn sample_coat(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let FacetSample { wi, cos_d, weight } = sample_facets(p.n, p.wo, p.lobe.alpha, u.truncate());
    let reflected = fresnel(cos_d, 1.0 / p.lobe.m.ior).reflectance * weight;
    let weight = p.lobe.reflectance * (reflected * facet_correction(p, wi, mode));
    Sample { direction: wi, weight }
}
