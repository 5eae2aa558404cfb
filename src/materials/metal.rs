//! GGX microfacet conductor with Schlick's Fresnel term, given by its reflectance at normal
//! incidence. Twin: `shaders/materials/metal.wgsl`.

use super::fresnel::schlick;
use super::microfacet::*;
use super::real::{Real, Vec3};
use super::shading::{Lobe, Sample, ShadingPoint};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.7, 0.3), alpha: 0.09, ..Material::EMPTY },
    Material { reflectance: Vec3::new(0.5, 0.5, 0.5), alpha: 0.64, ..Material::EMPTY },
];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Schlick's Fresnel term.
#[inline(always)]
fn fresnel_metal(lobe: &Lobe, cos: Real) -> Vec3 {
    schlick(lobe.reflectance, cos)
}

/// Mean of Schlick's term over the hemisphere, `(20 F_0 + 1) / 21`.
#[inline(always)]
fn mean_schlick(f0: Vec3) -> Vec3 {
    f0 * (20.0 / 21.0) + Vec3::splat(1.0 / 21.0)
}

/// BRDF times the cosine to `n`, with the light that the facets scatter several times.
#[inline(always)]
pub fn eval_metal(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let Facets { cos_d, cos_o, cos_i, brdf } = facets_at(n, wo, wi, lobe.alpha);
    if cos_o <= 0.0 || cos_i <= 0.0 {
        return Vec3::ZERO;
    }
    let mut f = fresnel_metal(lobe, cos_d) * brdf;
    if lobe.m.mean_albedo < 1.0 {
        f += scattered_again(lobe.m, mean_schlick(lobe.reflectance), cos_o, cos_i);
    }
    f * cos_i
}

/// Density of [`sample_metal`], sr^-1.
#[inline(always)]
pub fn pdf_metal(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    pdf_facet_lobe(lobe, n, wo, wi)
}

/// Samples a direction by the distribution of visible normals, or by the cosine for the light that
/// the facets scatter several times.
#[inline(always)]
pub fn sample_metal(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    if p.lobe.m.mean_albedo < 1.0 {
        let wi = sample_facet_lobe(p, u.truncate());
        let pdf = pdf_facet_lobe(&p.lobe, p.n, p.wo, wi);
        let mut weight = Vec3::ZERO;
        if pdf > 0.0 {
            weight = eval_metal(&p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
        }
        return Sample { direction: wi, weight };
    }
    let FacetSample { wi, cos_d, weight } = sample_facets(p.n, p.wo, p.lobe.alpha, u.truncate());
    let weight = fresnel_metal(&p.lobe, cos_d) * weight * facet_correction(p, wi, mode);
    Sample { direction: wi, weight }
}
