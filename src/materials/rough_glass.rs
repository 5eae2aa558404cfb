//! Rough dielectric: GGX microfacets that reflect and refract by the Fresnel equations (Walter et
//! al. 2007). Twin: `shaders/materials/rough_glass.wgsl`.
//!
//! Light that the facets scatter several times is added by a factor: the BSDF is divided by the
//! fraction that they scatter once from the viewer's direction (Turquin 2019, "Practical multiple
//! scattering compensation for microfacet models", for a Fresnel term of one). For photons, the
//! viewer's direction is the one that they leave in.
//!
//! The lobe's `reflectance` holds `eta`, the index in front of the surface over that behind it.

use super::fresnel::{fresnel, refracted};
use super::math::{basis, from_frame, mirrored, unit};
use super::microfacet::*;
use super::real::{Real, Vec3};
use super::shading::{IMPORTANCE, Lobe, Sample, ShadingPoint, renormalized, shading_correction};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::splat(1.0 / 1.5), ior: 1.5, alpha: 0.2, ..Material::EMPTY },
    Material { reflectance: Vec3::splat(1.5), ior: 1.5, alpha: 0.5, ..Material::EMPTY },
];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = true;

/// Least fraction that the BSDF is divided by.
const LEAST: Real = 0.1;

/// Fraction of the light from a direction with cosine `cos` that the facets scatter once, on the
/// outer or the inner side of the surface.
#[inline(always)]
fn scattered_once(m: &Material, outside: bool, cos: Real) -> Real {
    if m.mean_albedo == 1.0 {
        return 1.0;
    }
    if outside { facet_albedo(m, cos).max(LEAST) } else { inner_albedo(m, cos).max(LEAST) }
}

/// Returns whether the medium in front of the surface, on the viewer's side, is the outer one.
#[inline(always)]
fn is_outside(lobe: &Lobe) -> bool {
    (lobe.reflectance.x < 1.0) == (lobe.m.ior > 1.0)
}

/// Refraction by microfacets for one pair of directions in the frame of the normal.
struct Refraction {
    /// BTDF times the cosine of `wi`, for radiance.
    value: Real,
    /// Density of `wi`, sr^-1.
    pdf: Real,
}

/// `eta` as in [`Lobe`]; `wo` lies above the surface and `wi` below it (Walter et al., eq. 21).
#[inline(always)]
fn refraction(wo: Vec3, wi: Vec3, alpha: Real, eta: Real) -> Refraction {
    let sum = wo * eta + wi;
    let long = unit(sum);
    let h = if long.z < 0.0 { -long } else { long };
    let (cos_d, cos_t) = (wo.dot(h), -wi.dot(h));
    if cos_d <= 0.0 || cos_t <= 0.0 {
        return Refraction { value: 0.0, pdf: 0.0 };
    }
    let passed = 1.0 - fresnel(cos_d, eta).reflectance;
    let lambda = ggx_lambda(wo.z, alpha);
    let root = eta * cos_d - cos_t;
    // solid angle of the facets' normals over that of `wi`, times the visible normals' density
    let spread = ggx_d(h, alpha) * cos_d * cos_t / (root * root * wo.z);
    Refraction {
        value: passed * spread * (eta * eta) / (1.0 + lambda + ggx_lambda(-wi.z, alpha)),
        pdf: passed * spread / (1.0 + lambda),
    }
}

/// BSDF times the cosine to `n`.
#[inline(always)]
pub fn eval_rough_glass(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let eta = lobe.reflectance.x;
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let local_wi = Vec3::new(wi.dot(t), wi.dot(b), wi.dot(n));
    if local_wo.z <= 0.0 || local_wi.z == 0.0 {
        return Vec3::ZERO;
    }
    let mut value = 0.0;
    if local_wi.z > 0.0 {
        let Facets { cos_d, cos_i, brdf, .. } = facets_at(n, wo, wi, lobe.alpha);
        value += fresnel(cos_d, eta).reflectance * brdf * cos_i;
    } else {
        value += refraction(local_wo, local_wi, lobe.alpha, eta).value;
    }
    Vec3::splat(value / scattered_once(lobe.m, is_outside(lobe), local_wo.z))
}

/// Density of [`sample_rough_glass`], sr^-1.
#[inline(always)]
pub fn pdf_rough_glass(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let eta = lobe.reflectance.x;
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let local_wi = Vec3::new(wi.dot(t), wi.dot(b), wi.dot(n));
    if local_wo.z <= 0.0 || local_wi.z == 0.0 {
        return 0.0;
    }
    if local_wi.z > 0.0 {
        let h = unit(local_wo + local_wi);
        return fresnel(local_wo.dot(h), eta).reflectance * ggx_pdf(local_wo, local_wi, lobe.alpha);
    }
    refraction(local_wo, local_wi, lobe.alpha, eta).pdf
}

/// Samples a facet by the distribution of visible normals, then reflects or refracts by the Fresnel
/// equations.
#[inline(always)]
pub fn sample_rough_glass(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let (eta, alpha) = (p.lobe.reflectance.x, p.lobe.alpha);
    let (t, b) = basis(p.n);
    let local_wo = Vec3::new(p.wo.dot(t), p.wo.dot(b), p.wo.dot(p.n));
    let h = ggx_visible_normal(local_wo, alpha, u.truncate());
    let cos_d = local_wo.dot(h);
    let interface = fresnel(cos_d, eta);
    let reflects = u.z < interface.reflectance;
    let mut local_wi = mirrored(local_wo, h);
    let mut side = 1.0;
    if !reflects {
        local_wi = refracted(local_wo, h, cos_d, interface.cos_t, eta);
        side = -1.0;
    }
    let wi = renormalized(from_frame(p.n, local_wi));
    let mut weight = 0.0;
    if local_wi.z * side > 0.0 && wi.dot(p.ng) * side > 0.0 {
        let lambda = ggx_lambda(local_wo.z, alpha);
        weight = (1.0 + lambda) / (1.0 + lambda + ggx_lambda(local_wi.z.abs(), alpha));
        let outside = is_outside(&p.lobe);
        if mode == IMPORTANCE {
            weight *= shading_correction(p, p.n, wi);
            let leaves_outside = outside == reflects;
            weight *= 1.0 / scattered_once(p.lobe.m, leaves_outside, local_wi.z.abs());
        } else {
            // radiance is compressed into a smaller solid angle inside
            weight *= if reflects { 1.0 } else { eta * eta };
            weight *= 1.0 / scattered_once(p.lobe.m, outside, local_wo.z);
        }
    }
    Sample { direction: wi, weight: Vec3::splat(weight) }
}
