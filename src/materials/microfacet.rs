//! Microfacet reflection: the GGX distribution with the height-correlated Smith shadowing (Walter
//! et al. 2007; Heitz 2014, 2018), and the light that it scatters more than once. Shared by metals
//! and coats. Twin: `shaders/materials/microfacet.wgsl`.
//!
//! Functions named `ggx_*` take directions in the frame whose z is the shading normal.

use super::math::sampling::sample_cosine;
use super::math::trig::sin_cos;
use super::math::{INV_PI, PI, TAU, basis, from_frame, mirrored, unit};
use super::real::{Real, Vec2, Vec3, root_roundings};
use super::shading::{
    IMPORTANCE, Lobe, ShadingPoint, pdf_cosine, renormalized, shading_correction,
};
use super::tables::Material;

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

/// Reflection by microfacets for one pair of directions, without the Fresnel term.
#[derive(Clone, Copy, Debug)]
pub struct Facets {
    /// Cosine of `wo` and of `wi` with the normal of the facets that mirror one into the other.
    pub cos_d: Real,
    /// Cosine of `wo` with the shading normal.
    pub cos_o: Real,
    /// Cosine of `wi` with the shading normal.
    pub cos_i: Real,
    /// BRDF over the Fresnel term, `D G_2 / (4 cos_o cos_i)`, sr^-1; 0 below the surface.
    pub brdf: Real,
}

/// Facets that mirror `wo` into `wi` at a surface with shading normal `n`.
#[inline(always)]
pub fn facets_at(n: Vec3, wo: Vec3, wi: Vec3, alpha: Real) -> Facets {
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let local_wi = Vec3::new(wi.dot(t), wi.dot(b), wi.dot(n));
    let (cos_o, cos_i) = (local_wo.z, local_wi.z);
    if cos_o <= 0.0 || cos_i <= 0.0 {
        return Facets { cos_d: 0.0, cos_o, cos_i, brdf: 0.0 };
    }
    let h = unit(local_wo + local_wi);
    let g = 1.0 / (1.0 + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha));
    Facets {
        cos_d: local_wo.dot(h),
        cos_o,
        cos_i,
        brdf: ggx_d(h, alpha) * g / (4.0 * cos_o * cos_i),
    }
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

/// Direction sampled through a microfacet normal.
#[derive(Clone, Copy, Debug)]
pub struct FacetSample {
    /// Unit direction, in world space.
    pub wi: Vec3,
    /// Cosine of `wo` with the facet's normal.
    pub cos_d: Real,
    /// BRDF times cosine over density, without the Fresnel term: `G_2 / G_1` in closed form; 0
    /// below the surface.
    pub weight: Real,
}

/// Samples a direction by the distribution of visible normals. (The weight is computed from `h`:
/// given `wo + wi`, a shader compiler could cancel `wo` against the one in `wi`.)
#[inline(always)]
pub fn sample_facets(n: Vec3, wo: Vec3, alpha: Real, u: Vec2) -> FacetSample {
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let h = ggx_visible_normal(local_wo, alpha, u);
    let local_wi = mirrored(local_wo, h);
    let wi = renormalized(from_frame(n, local_wi));
    let mut weight = 0.0;
    if local_wi.z > 0.0 {
        let lo = ggx_lambda(local_wo.z, alpha);
        weight = (1.0 + lo) / (1.0 + lo + ggx_lambda(local_wi.z, alpha));
    }
    FacetSample { wi, cos_d: local_wo.dot(h), weight }
}

/// Density of [`sample_facets`], sr^-1.
#[inline(always)]
pub fn pdf_facets(n: Vec3, wo: Vec3, wi: Vec3, alpha: Real) -> Real {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    let (t, b) = basis(n);
    let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    ggx_pdf(local_wo, Vec3::new(wi.dot(t), wi.dot(b), cos), alpha)
}

/// Weight of a direction that a microfacet lobe has sampled: zero below the surface, and for
/// photons corrected for the shading normal.
#[inline(always)]
pub fn facet_correction(p: &ShadingPoint, wi: Vec3, mode: u32) -> Real {
    if wi.dot(p.ng) <= 0.0 {
        return 0.0;
    }
    if mode == IMPORTANCE {
        // an eye path from behind the shading normal would receive nothing
        return if p.wo.dot(p.ns) > 0.0 { shading_correction(p, p.n, wi) } else { 0.0 };
    }
    1.0
}

/// Fraction of the light from a direction with cosine `cos` that the microfacets scatter once,
/// without the Fresnel term (see [`Material::albedo_low`]).
#[inline(always)]
pub fn facet_albedo(m: &Material, cos: Real) -> Real {
    let (a, b) = (m.albedo_low, m.albedo_high);
    let high = b.x + cos * (b.y + cos * (b.z + cos * b.w));
    (a.x + cos * (a.y + cos * (a.z + cos * (a.w + cos * high)))).clamp(0.0, 1.0)
}

/// The same for a rough dielectric, from inside.
#[inline(always)]
pub fn inner_albedo(m: &Material, cos: Real) -> Real {
    let (a, b, c) = (m.eta, m.k, m.mean_fresnel);
    let high = b.y + cos * (b.z + cos * (c.x + cos * c.y));
    (a.x + cos * (a.y + cos * (a.z + cos * (b.x + cos * high)))).clamp(0.0, 1.0)
}

/// BRDF of the light that microfacets scatter several times, sr^-1, with their mean Fresnel
/// reflectance (Kulla & Conty 2017, "Revisiting physically based shading at Imageworks"; Fresnel
/// part by Jakob et al. 2014). Single scattering loses this light.
#[inline(always)]
pub fn scattered_again(m: &Material, mean_fresnel: Vec3, cos_o: Real, cos_i: Real) -> Vec3 {
    let lost = (1.0 - facet_albedo(m, cos_o)) * (1.0 - facet_albedo(m, cos_i));
    let share = lost * (INV_PI / (1.0 - m.mean_albedo));
    let kept = mean_fresnel * mean_fresnel * m.mean_albedo;
    kept / (Vec3::ONE - mean_fresnel * (1.0 - m.mean_albedo)) * share
}

/// Direction of a lobe that adds the light scattered several times: by the cosine with the
/// probability that the facets scatter again, else by the visible normals.
#[inline(always)]
pub fn sample_facet_lobe(p: &ShadingPoint, u: Vec2) -> Vec3 {
    let again = 1.0 - facet_albedo(p.lobe.m, p.wo.dot(p.n));
    if u.x < again {
        return renormalized(from_frame(p.n, sample_cosine(Vec2::new(u.x / again, u.y))));
    }
    let x = ((u.x - again) / (1.0 - again).max(1e-6)).clamp(0.0, 1.0);
    sample_facets(p.n, p.wo, p.lobe.alpha, Vec2::new(x, u.y)).wi
}

/// Density of a metal's directions: of [`sample_facet_lobe`] if it adds the light scattered several
/// times, else of [`sample_facets`], sr^-1.
#[inline(always)]
pub fn pdf_facet_lobe(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let pdf = pdf_facets(n, wo, wi, lobe.alpha);
    if lobe.m.mean_albedo < 1.0 {
        let again = 1.0 - facet_albedo(lobe.m, wo.dot(n));
        return pdf * (1.0 - again) + again * pdf_cosine(n, wi);
    }
    pdf
}
