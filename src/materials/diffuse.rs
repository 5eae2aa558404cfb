//! Lambertian reflection. Twin: `shaders/materials/diffuse.wgsl`.

use super::math::sampling::sample_cosine;
use super::math::{INV_PI, from_frame};
use super::real::{Real, Vec3};
use super::shading::{
    CosineAxis, Lobe, RADIANCE, Sample, ShadingPoint, cosine_axis, pdf_cosine, renormalized,
};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] =
    &[Material { reflectance: Vec3::new(0.9, 0.5, 0.2), ..Material::EMPTY }];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = true;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Diffuse BRDF times cosine: `rho cos / pi`.
#[inline(always)]
pub fn eval_diffuse(lobe: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    lobe.reflectance * (INV_PI * cos)
}

/// Density of the cosine-weighted direction: `cos / pi`, sr^-1.
#[inline(always)]
pub fn pdf_diffuse(_: &Lobe, n: Vec3, _: Vec3, wi: Vec3) -> Real {
    pdf_cosine(n, wi)
}

/// Samples a direction by the cosine to the shading normal. For photons the adjoint applies: they
/// scatter about the geometric normal, with the weight of the shading normal on arrival.
#[inline(always)]
pub fn sample_diffuse(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let CosineAxis { axis, mut weight } = cosine_axis(p, mode);
    let wi = renormalized(from_frame(axis, sample_cosine(u.truncate())));
    // a cosine about `ng` itself is above 2^-13; without this test the photon's weight does not
    // depend on the direction, so roulette need not wait for it
    if mode == RADIANCE && wi.dot(p.ng) <= 0.0 {
        weight = Vec3::ZERO;
    }
    Sample { direction: wi, weight }
}
