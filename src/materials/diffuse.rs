//! Lambertian reflection. Twin: `shaders/materials/diffuse.wgsl`.

use super::math::sampling::sample_cosine;
use super::math::{INV_PI, from_frame};
use super::real::{Real, Vec2, Vec3};
use super::shading::{IMPORTANCE, Lobe, RADIANCE, Sample, ShadingPoint, renormalized};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] =
    &[Material { reflectance: Vec3::new(0.9, 0.5, 0.2), ..Material::EMPTY }];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = true;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Lower bound of the cosine to the geometric normal that the shading-normal correction divides by.
const ADJOINT_COS_MIN: Real = 1e-2;

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
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    cos * INV_PI
}

/// Samples a direction by the cosine to the shading normal. For photons the adjoint applies: they
/// scatter about the geometric normal, with the weight of the shading normal on arrival.
#[inline(always)]
pub fn sample_diffuse(p: &ShadingPoint, u: Vec2, mode: u32) -> Sample {
    let mut axis = p.n;
    let mut weight = p.lobe.reflectance;
    if mode == IMPORTANCE {
        axis = p.ng;
        if p.s.shading != p.s.normal {
            weight *= p.wo.dot(p.n).max(0.0) / p.wo.dot(p.ng).max(ADJOINT_COS_MIN);
        }
    }
    let wi = renormalized(from_frame(axis, sample_cosine(u)));
    // a cosine about `ng` itself is above 2^-13; without this test the photon's weight does not
    // depend on the direction, so roulette need not wait for it
    if mode == RADIANCE && wi.dot(p.ng) <= 0.0 {
        weight = Vec3::ZERO;
    }
    Sample { direction: wi, weight }
}
