//! GGX microfacet conductor with Schlick's Fresnel term and the height-correlated Smith shadowing
//! (Walter et al. 2007; Heitz 2014, 2018). The cosine is not in `eval_metal`. All directions are
//! unit, point away from the surface and are given in the frame whose z is the shading normal.
//! Twin: `shaders/materials/metal.wgsl`.

use super::math::trig::sin_cos;
use super::math::{PI, TAU, unit};
use super::real::{Real, Vec2, Vec3, root_roundings};

/// Least `alpha`: below it rounding spoils the lobe's peak.
pub const ALPHA_MIN: Real = root_roundings(1e-3);

/// Distribution of microfacet normals `h`, GGX. The sine comes from `h.x` and `h.y`: in a narrow
/// lobe `1 - cos^2` has no digits left.
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
pub fn eval_metal(wo: Vec3, wi: Vec3, f0: Vec3, alpha: Real) -> Vec3 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return Vec3::ZERO;
    }
    let h = unit(wo + wi);
    let g = 1.0 / (1.0 + ggx_lambda(wo.z, alpha) + ggx_lambda(wi.z, alpha));
    schlick(f0, wo.dot(h)) * (ggx_d(h, alpha) * g / (4.0 * wo.z * wi.z))
}

/// A microfacet normal `h` by the distribution of visible normals (Heitz 2018); the direction is
/// `mirrored(wo, h)`.
pub fn sample_metal(wo: Vec3, alpha: Real, u: Vec2) -> Vec3 {
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

/// Solid angle density of the directions of [`sample_metal`], sr^-1.
pub fn pdf_metal(wo: Vec3, wi: Vec3, alpha: Real) -> Real {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let h = unit(wo + wi);
    ggx_d(h, alpha) / (4.0 * wo.z * (1.0 + ggx_lambda(wo.z, alpha)))
}

/// `eval_metal * cos / pdf_metal` in closed form, `F G2 / G1`, for `wi` mirrored at `h`. (From
/// `wo + wi` a shader compiler could cancel `wo` against the one in `wi`.)
pub fn weight_metal(wo: Vec3, h: Vec3, wi: Vec3, f0: Vec3, alpha: Real) -> Vec3 {
    if wi.z <= 0.0 {
        return Vec3::ZERO;
    }
    let lo = ggx_lambda(wo.z, alpha);
    schlick(f0, wo.dot(h)) * ((1.0 + lo) / (1.0 + lo + ggx_lambda(wi.z, alpha)))
}
