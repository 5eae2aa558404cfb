//! GGX microfacet conductor with the exact Fresnel term of a complex index of refraction, per
//! channel; `reflectance` is a factor. Twin: `shaders/materials/conductor.wgsl`.

use super::fresnel::fresnel_conductor;
use super::microfacet::*;
use super::real::{Real, Vec3};
use super::shading::{Lobe, Sample, ShadingPoint};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    // gold and silver
    Material {
        eta: Vec3::new(0.14, 0.38, 1.44),
        k: Vec3::new(3.97, 2.38, 1.6),
        reflectance: Vec3::ONE,
        alpha: 0.09,
        ..Material::EMPTY
    },
    Material {
        eta: Vec3::new(0.05, 0.06, 0.05),
        k: Vec3::new(4.28, 3.52, 2.73),
        reflectance: Vec3::new(0.9, 0.8, 0.7),
        alpha: 0.5,
        ..Material::EMPTY
    },
];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Exact Fresnel term of the material's index times the factor.
#[inline(always)]
fn fresnel_of_conductor(lobe: &Lobe, cos: Real) -> Vec3 {
    lobe.reflectance * fresnel_conductor(cos, lobe.m.eta, lobe.m.k)
}

/// BRDF times the cosine to `n`, with the light that the facets scatter several times.
#[inline(always)]
pub fn eval_conductor(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let Facets { cos_d, cos_o, cos_i, brdf } = facets_at(n, wo, wi, lobe.alpha);
    if cos_o <= 0.0 || cos_i <= 0.0 {
        return Vec3::ZERO;
    }
    let mut f = fresnel_of_conductor(lobe, cos_d) * brdf;
    if lobe.m.mean_albedo < 1.0 {
        f += lobe.reflectance * scattered_again(lobe.m, lobe.m.mean_fresnel, cos_o, cos_i);
    }
    f * cos_i
}

/// Density of [`sample_conductor`], sr^-1.
#[inline(always)]
pub fn pdf_conductor(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    pdf_facet_lobe(lobe, n, wo, wi)
}

/// Samples a direction by the distribution of visible normals, or by the cosine for the light that
/// the facets scatter several times.
#[inline(always)]
pub fn sample_conductor(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    if p.lobe.m.mean_albedo < 1.0 {
        let wi = sample_facet_lobe(p, u.truncate());
        let pdf = pdf_facet_lobe(&p.lobe, p.n, p.wo, wi);
        let mut weight = Vec3::ZERO;
        if pdf > 0.0 {
            weight = eval_conductor(&p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
        }
        return Sample { direction: wi, weight };
    }
    let FacetSample { wi, cos_d, weight } = sample_facets(p.n, p.wo, p.lobe.alpha, u.truncate());
    let weight = fresnel_of_conductor(&p.lobe, cos_d) * weight * facet_correction(p, wi, mode);
    Sample { direction: wi, weight }
}
