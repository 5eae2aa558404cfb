//! Thin sheet of a dielectric, such as a window pane or a soap film without interference: reflects
//! and transmits with all reflections between its two faces, and does not bend light. Twin:
//! `shaders/materials/thin_glass.wgsl`.

use super::fresnel::fresnel;
use super::interior::Interior;
use super::real::{Real, Vec3};
use super::shading::{Sample, Scatter, ShadingPoint, reflected};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] =
    &[Material { ior: 1.5, reflectance: Vec3::new(0.9, 0.8, 0.7), ..Material::EMPTY }];

/// Reflects with the probability `2 R / (1 + R)`, the sum of `R + R T^2 + R^3 T^2 + ...` over the
/// reflections inside, where `R = 1 - T` is the Fresnel reflectance of one face; else passes
/// straight through, times the transmittance `reflectance`.
#[inline(always)]
pub fn scatter_thin_glass(
    _: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    u: Real,
    mode: u32,
) -> Scatter {
    let one = fresnel(p.wo.dot(p.n).abs(), 1.0 / p.lobe.m.ior).reflectance;
    if u < 2.0 * one / (1.0 + one) {
        let Sample { direction, weight } = reflected(p, mode);
        return Scatter { direction, interior: *interior, weight };
    }
    Scatter { direction: -p.wo, interior: *interior, weight: p.lobe.reflectance }
}
