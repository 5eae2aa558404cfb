//! GGX microfacet conductor with Schlick's Fresnel term and the height-correlated Smith shadowing
//! (Walter et al. 2007; Heitz 2014, 2018). Twin: `shaders/materials/metal.wgsl`.
//!
//! Functions named `ggx_*` take directions in the frame whose z is the shading normal; `ggx_brdf`
//! does not include the cosine.

use super::math::trig::sin_cos;
use super::math::{PI, TAU, basis, from_frame, mirrored, unit};
use super::real::{Real, Vec2, Vec3, root_roundings};
use super::shading::{IMPORTANCE, Lobe, Sample, ShadingPoint, renormalized, shading_correction};
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

/// Least `alpha`: below it, rounding degrades the lobe's peak.
pub const ALPHA_MIN: Real = root_roundings(1e-3);

/// GGX distribution of microfacet normals `h`, sr^-1. The sine is computed from `h.x` and `h.y`: in
/// a narrow lobe `1 - cos^2` loses all digits.
pub fn ggx_d(h: Vec3, alpha: Real) -> Real {
    let a2 = alpha * alpha;
    let sin_sq = h.x * h.x + h.y * h.y;
    let d = h.z * h.z * a2 + sin_sq;
    a2 / (PI * d * d)
}

/// Smith's Lambda of GGX for a direction with cosine `cos`.
pub fn ggx_lambda(cos: Real, alpha: Real) -> Real {
    let c2 = cos * cos;
    let tan_sq = (1.0 - c2).max(0.0) / c2;
    0.5 * ((1.0 + alpha * alpha * tan_sq).sqrt() - 1.0)
}

/// Schlick's Fresnel term.
pub fn schlick(f0: Vec3, cos: Real) -> Vec3 {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    f0 + (Vec3::ONE - f0) * (m2 * m2 * m)
}

/// BRDF, sr^-1, without the cosine.
pub fn ggx_brdf(wo: Vec3, wi: Vec3, f0: Vec3, alpha: Real) -> Vec3 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return Vec3::ZERO;
    }
    let h = unit(wo + wi);
    let g = 1.0 / (1.0 + ggx_lambda(wo.z, alpha) + ggx_lambda(wi.z, alpha));
    schlick(f0, wo.dot(h)) * (ggx_d(h, alpha) * g / (4.0 * wo.z * wi.z))
}

/// Samples a microfacet normal `h` by the distribution of visible normals (Heitz 2018); the
/// scattered direction is `mirrored(wo, h)`.
pub fn ggx_visible_normal(wo: Vec3, alpha: Real, u: Vec2) -> Vec3 {
    let vh = unit(Vec3::new(alpha * wo.x, alpha * wo.y, wo.z));
    let len_sq = vh.x * vh.x + vh.y * vh.y;
    let mut t1 = Vec3::new(1.0, 0.0, 0.0);
    if len_sq > 1e-12 {
        t1 = Vec3::new(-vh.y, vh.x, 0.0) * (1.0 / len_sq.sqrt());
    }
    let t2 = vh.cross(t1);
    let r = u.x.sqrt();
    let (sin, cos) = sin_cos(TAU * u.y);
    let p1 = r * cos;
    let s = 0.5 * (1.0 + vh.z);
    let p2 = (1.0 - s) * (1.0 - p1 * p1).max(0.0).sqrt() + s * (r * sin);
    let nh = t1 * p1 + t2 * p2 + vh * (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
    unit(Vec3::new(alpha * nh.x, alpha * nh.y, nh.z.max(1e-6)))
}

/// Density per solid angle of the directions sampled through [`ggx_visible_normal`], sr^-1.
pub fn ggx_pdf(wo: Vec3, wi: Vec3, alpha: Real) -> Real {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let h = unit(wo + wi);
    ggx_d(h, alpha) / (4.0 * wo.z * (1.0 + ggx_lambda(wo.z, alpha)))
}

/// `ggx_brdf * cos / ggx_pdf` in closed form, `F G2 / G1`, for `wi` mirrored at `h`. (Given
/// `wo + wi`, a shader compiler could cancel `wo` against the one in `wi`.)
pub fn ggx_weight(wo: Vec3, h: Vec3, wi: Vec3, f0: Vec3, alpha: Real) -> Vec3 {
    if wi.z <= 0.0 {
        return Vec3::ZERO;
    }
    let lo = ggx_lambda(wo.z, alpha);
    schlick(f0, wo.dot(h)) * ((1.0 + lo) / (1.0 + lo + ggx_lambda(wi.z, alpha)))
}

/// GGX BRDF times the cosine to `n`.
#[inline(always)]
pub fn eval_metal(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let local_wi = Vec3::new(wi.dot(t), wi.dot(b), cos);
    ggx_brdf(local_wo, local_wi, lobe.reflectance, lobe.alpha) * cos
}

/// Density of [`sample_metal`], sr^-1.
#[inline(always)]
pub fn pdf_metal(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    ggx_pdf(local_wo, Vec3::new(wi.dot(t), wi.dot(b), cos), lobe.alpha)
}

/// Samples a direction by the distribution of visible normals.
#[inline(always)]
pub fn sample_metal(p: &ShadingPoint, u: Vec2, mode: u32) -> Sample {
    let (t, b) = basis(p.n);
    let local_wo = Vec3::new(p.wo.dot(t), p.wo.dot(b), p.wo.dot(p.n));
    let h = ggx_visible_normal(local_wo, p.lobe.alpha, u);
    let local_wi = mirrored(local_wo, h);
    let mut weight = ggx_weight(local_wo, h, local_wi, p.lobe.reflectance, p.lobe.alpha);
    let wi = renormalized(from_frame(p.n, local_wi));
    if wi.dot(p.ng) <= 0.0 {
        weight = Vec3::ZERO;
    } else if mode == IMPORTANCE {
        // an eye path from behind the shading normal would receive nothing
        let seen = p.wo.dot(p.ns) > 0.0;
        weight *= if seen { shading_correction(p, p.n, wi) } else { 0.0 };
    }
    Sample { direction: wi, weight }
}
