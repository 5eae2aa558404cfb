//! Brushed metal: a GGX conductor whose facets have another width along the grain than across it
//! (Heitz 2014, section 5.4; Heitz 2018). The Fresnel term is exact if the entry's `first` is 1,
//! else Schlick's. Twin: `shaders/materials/brushed.wgsl`.
//!
//! The widths along u and v are the entry's `alpha` and `ior`. The lobe's `alpha` is the angle of
//! u about the shading normal, from the first tangent of [`basis`]. Light scattered several times
//! does not depend on the azimuth.

use super::fresnel::{fresnel_conductor, schlick};
use super::geometry::tangents::{Tangents, tangents_at};
use super::math::sampling::sample_cosine;
use super::math::trig::{arctan2, sin_cos};
use super::math::{PI, TAU, basis, from_frame, mirrored, unit};
use super::microfacet::*;
use super::real::{Real, Vec2, Vec3};
use super::shading::{Lobe, Sample, ShadingPoint, pdf_cosine, renormalized};
use super::shapes::ray::Hit;
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.7, 0.3), alpha: 0.1, ior: 0.4, ..Material::EMPTY },
    Material {
        eta: Vec3::new(0.14, 0.38, 1.44),
        k: Vec3::new(3.97, 2.38, 1.6),
        reflectance: Vec3::ONE,
        first: 1,
        alpha: 0.6,
        ior: 0.2,
        ..Material::EMPTY
    },
];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = false;

/// Angle of the direction of u about the shading normal.
#[inline(never)]
pub fn grain_angle(scene: &SceneTables, hit: Hit, p: &ShadingPoint) -> Real {
    let Tangents { u, .. } = tangents_at(scene, hit, p.s);
    let (t, b) = basis(p.n);
    arctan2(u.dot(b), u.dot(t))
}

/// Vectors along and across the grain.
#[inline(always)]
fn grain(n: Vec3, angle: Real) -> (Vec3, Vec3) {
    let (t, b) = basis(n);
    let (sin, cos) = sin_cos(angle);
    (t * cos + b * sin, b * cos - t * sin)
}

/// GGX distribution of microfacet normals `h`, sr^-1.
#[inline(always)]
fn brushed_d(h: Vec3, m: &Material) -> Real {
    let (x, y) = (h.x / m.alpha, h.y / m.ior);
    let d = (x * x + y * y) + h.z * h.z;
    1.0 / (PI * m.alpha * m.ior * d * d)
}

/// Smith's Lambda.
#[inline(always)]
pub fn brushed_lambda(w: Vec3, m: &Material) -> Real {
    let (x, y) = (w.x * m.alpha, w.y * m.ior);
    0.5 * ((1.0 + (x * x + y * y) / (w.z * w.z)).sqrt() - 1.0)
}

#[inline(always)]
fn fresnel_of_brushed(lobe: &Lobe, cos: Real) -> Vec3 {
    if lobe.m.first == 1 {
        return lobe.reflectance * fresnel_conductor(cos, lobe.m.eta, lobe.m.k);
    }
    schlick(lobe.reflectance, cos)
}

/// Mean Fresnel reflectance over the hemisphere; of Schlick's term `(20 F_0 + 1) / 21`.
#[inline(always)]
fn mean_fresnel_of_brushed(lobe: &Lobe) -> Vec3 {
    if lobe.m.first == 1 {
        return lobe.m.mean_fresnel;
    }
    lobe.reflectance * (20.0 / 21.0) + Vec3::splat(1.0 / 21.0)
}

/// BRDF times the cosine to `n`, with the light that the facets scatter several times.
#[inline(always)]
pub fn eval_brushed(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let m = lobe.m;
    let (t, b) = grain(n, lobe.alpha);
    let o = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let i = Vec3::new(wi.dot(t), wi.dot(b), wi.dot(n));
    if o.z <= 0.0 || i.z <= 0.0 {
        return Vec3::ZERO;
    }
    let h = unit(o + i);
    let g = 1.0 / (1.0 + brushed_lambda(o, m) + brushed_lambda(i, m));
    let mut f = fresnel_of_brushed(lobe, o.dot(h)) * (brushed_d(h, m) * g / (4.0 * o.z * i.z));
    if m.mean_albedo < 1.0 {
        let tint = if m.first == 1 { lobe.reflectance } else { Vec3::ONE };
        f += tint * scattered_again(m, mean_fresnel_of_brushed(lobe), o.z, i.z);
    }
    f * i.z
}

/// Density of [`sample_brushed`], sr^-1.
#[inline(always)]
pub fn pdf_brushed(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let m = lobe.m;
    let (t, b) = grain(n, lobe.alpha);
    let o = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
    let i = Vec3::new(wi.dot(t), wi.dot(b), wi.dot(n));
    if o.z <= 0.0 || i.z <= 0.0 {
        return 0.0;
    }
    let pdf = brushed_d(unit(o + i), m) / (4.0 * o.z * (1.0 + brushed_lambda(o, m)));
    let again = again_share(m, o.z);
    pdf * (1.0 - again) + again * pdf_cosine(n, wi)
}

/// Probability of the cosine instead of the visible normals.
#[inline(always)]
fn again_share(m: &Material, cos: Real) -> Real {
    if m.mean_albedo < 1.0 { 1.0 - facet_albedo(m, cos) } else { 0.0 }
}

/// Visible microfacet normal for `wo` in the frame of the grain.
#[inline(always)]
pub fn brushed_normal(wo: Vec3, m: &Material, u: Vec2) -> Vec3 {
    let vh = unit(Vec3::new(m.alpha * wo.x, m.ior * wo.y, wo.z));
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
    unit(Vec3::new(m.alpha * nh.x, m.ior * nh.y, nh.z.max(1e-6)))
}

/// Samples a direction by the distribution of visible normals, or by the cosine for the light that
/// the facets scatter several times.
#[inline(always)]
pub fn sample_brushed(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let m = p.lobe.m;
    let (t, b) = grain(p.n, p.lobe.alpha);
    let o = Vec3::new(p.wo.dot(t), p.wo.dot(b), p.wo.dot(p.n));
    let again = again_share(m, o.z);
    let wi = if u.x < again {
        from_frame(p.n, sample_cosine(Vec2::new(u.x / again, u.y)))
    } else {
        let x = ((u.x - again) / (1.0 - again).max(1e-6)).clamp(0.0, 1.0);
        let i = mirrored(o, brushed_normal(o, m, Vec2::new(x, u.y)));
        (t * i.x + b * i.y) + p.n * i.z
    };
    let wi = renormalized(wi);
    let pdf = pdf_brushed(&p.lobe, p.n, p.wo, wi);
    let mut weight = Vec3::ZERO;
    if pdf > 0.0 {
        weight = eval_brushed(&p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
    }
    Sample { direction: wi, weight }
}
