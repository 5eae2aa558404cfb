//! Diffuse base of [`super::plastic`], which light reaches and leaves through the coat. The
//! transmittance towards `wo` is the probability of the base and no part of the lobe. Twin:
//! `shaders/materials/plastic_base.wgsl`.

use super::fresnel::fresnel;
use super::math::sampling::sample_cosine;
use super::math::{INV_PI, from_frame};
use super::microfacet::facet_albedo;
use super::real::{Real, Vec3, Vec4};
use super::shading::{CosineAxis, Lobe, Sample, ShadingPoint, cosine_axis, pdf_cosine, renormalized};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.6, 0.3), ior: 1.5, ..Material::EMPTY },
    Material {
        reflectance: Vec3::new(0.4, 0.7, 0.9),
        ior: 1.5,
        alpha: 0.25,
        albedo_low: Vec4::new(0.3, -0.5, 0.3, -0.05),
        ..Material::EMPTY
    },
];
/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = true;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Fraction of the light from a direction with cosine `cos` that the coat reflects.
#[inline(always)]
pub fn coat_reflectance(m: &Material, cos: Real) -> Real {
    if m.alpha > 0.0 { facet_albedo(m, cos) } else { fresnel(cos, 1.0 / m.ior).reflectance }
}

/// BRDF times cosine: `rho_b (1 - E(cos)) cos / pi`.
#[inline(always)]
pub fn eval_plastic_base(lobe: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    let passed = 1.0 - coat_reflectance(lobe.m, cos);
    lobe.reflectance * (INV_PI * cos * passed)
}

/// Density of the cosine-weighted direction: `cos / pi`, sr^-1.
#[inline(always)]
pub fn pdf_plastic_base(_: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Real {
    pdf_cosine(n, wi)
}

/// Samples a direction by the cosine; for photons about the geometric normal, as on diffuse
/// surfaces.
#[inline(always)]
pub fn sample_plastic_base(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let CosineAxis { axis, mut weight } = cosine_axis(p, mode);
    let wi = renormalized(from_frame(axis, sample_cosine(u.truncate())));
    let cos = wi.dot(p.n);
    if wi.dot(p.ng) <= 0.0 || cos <= 0.0 {
        weight = Vec3::ZERO;
    }
    weight *= 1.0 - coat_reflectance(p.lobe.m, cos.max(0.0));
    Sample { direction: wi, weight }
}
