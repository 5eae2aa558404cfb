//! Thin sheet with rough faces, such as frosted window glass: light that [`super::thin_glass`]
//! reflects or passes straight through is spread by GGX microfacets. Twin:
//! `shaders/materials/rough_pane.wgsl`.
//!
//! What a facet transmits leaves in the direction that it would reflect, mirrored to the other side
//! of the sheet: the two faces bend light one way and back. Light scattered several times is added
//! as in [`super::rough_glass`].

use super::fresnel::fresnel;
use super::microfacet::*;
use super::real::{Real, Vec3};
use super::shading::{IMPORTANCE, Lobe, Sample, ShadingPoint, renormalized, shading_correction};
use super::tables::Material;

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.8, 0.5), ior: 1.5, alpha: 0.2, ..Material::EMPTY },
    Material { reflectance: Vec3::ONE, ior: 2.0, alpha: 0.6, ..Material::EMPTY },
];

/// See [`super::Bsdf::is_wide`].
pub const WIDE: bool = false;
/// See [`super::Bsdf::transmits`].
pub const TRANSMITS: bool = true;

/// Least fraction that the BSDF is divided by.
const LEAST: Real = 0.1;

/// Fraction of the light from a direction with cosine `cos` that the facets scatter once.
#[inline(always)]
fn pane_scattered_once(m: &Material, cos: Real) -> Real {
    if m.mean_albedo == 1.0 { 1.0 } else { facet_albedo(m, cos).max(LEAST) }
}

/// Reflectance of both faces together (see [`super::thin_glass`]).
#[inline(always)]
pub fn pane_reflectance(cos: Real, ior: Real) -> Real {
    let one = fresnel(cos.abs(), 1.0 / ior).reflectance;
    2.0 * one / (1.0 + one)
}

/// `wi` on the side of `n`, mirrored there if it is behind.
#[inline(always)]
fn in_front(n: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos < 0.0 { wi - n * (2.0 * cos) } else { wi }
}

/// BSDF times the cosine to `n`.
#[inline(always)]
pub fn eval_rough_pane(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let Facets { cos_d, cos_o, cos_i, brdf } = facets_at(n, wo, in_front(n, wi), lobe.alpha);
    if brdf <= 0.0 {
        return Vec3::ZERO;
    }
    let reflected = pane_reflectance(cos_d, lobe.m.ior);
    let mut f = Vec3::splat(reflected);
    if wi.dot(n) < 0.0 {
        f = lobe.reflectance * (1.0 - reflected);
    }
    f * (brdf * cos_i / pane_scattered_once(lobe.m, cos_o))
}

/// Density of [`sample_rough_pane`], sr^-1.
#[inline(always)]
pub fn pdf_rough_pane(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let up = in_front(n, wi);
    let reflected = pane_reflectance(facets_at(n, wo, up, lobe.alpha).cos_d, lobe.m.ior);
    let share = if wi.dot(n) < 0.0 { 1.0 - reflected } else { reflected };
    share * pdf_facets(n, wo, up, lobe.alpha)
}

/// Samples a facet by the distribution of visible normals, then a side by the reflectance.
#[inline(always)]
pub fn sample_rough_pane(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    let FacetSample { wi: up, cos_d, weight } =
        sample_facets(p.n, p.wo, p.lobe.alpha, u.truncate());
    let reflects = u.z < pane_reflectance(cos_d, p.lobe.m.ior);
    let cos = up.dot(p.n);
    let mut wi = up;
    let mut side = 1.0;
    let mut color = Vec3::ONE;
    if !reflects {
        wi = renormalized(up - p.n * (2.0 * cos));
        side = -1.0;
        color = p.lobe.reflectance;
    }
    if wi.dot(p.ng) * side <= 0.0 {
        return Sample { direction: wi, weight: Vec3::ZERO };
    }
    let mut factor = weight;
    let mut viewed = p.wo.dot(p.n);
    if mode == IMPORTANCE {
        factor *= shading_correction(p, p.n, wi);
        viewed = cos;
    }
    Sample { direction: wi, weight: color * (factor / pane_scattered_once(p.lobe.m, viewed)) }
}
