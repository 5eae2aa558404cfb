//! Smooth conductor: a mirror whose reflectance follows from a complex index of refraction, or from
//! the reflectance at normal incidence if the index is 1. Twin:
//! `shaders/materials/smooth_metal.wgsl`.

use super::fresnel::{fresnel_conductor, schlick};
use super::interior::Interior;
use super::real::{Real, Vec3};
use super::shading::{Sample, Scatter, ShadingPoint, mirror_normal, reflected};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { reflectance: Vec3::new(0.9, 0.8, 0.7), ..Material::EMPTY },
    Material {
        reflectance: Vec3::ONE,
        eta: Vec3::new(0.14, 0.38, 1.44),
        k: Vec3::new(3.97, 2.38, 1.6),
        ..Material::EMPTY
    },
];

/// Reflects at the shading normal.
#[inline(always)]
pub fn scatter_smooth_metal(
    _: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    _: Real,
    mode: u32,
) -> Scatter {
    let Sample { direction, weight } = reflected(p, mode);
    let cos = p.wo.dot(mirror_normal(p)).abs();
    let m = p.lobe.m;
    let fresnel = if m.eta == Vec3::ONE {
        schlick(p.lobe.reflectance, cos)
    } else {
        p.lobe.reflectance * fresnel_conductor(cos, m.eta, m.k)
    };
    Scatter { direction, interior: *interior, weight: weight * fresnel }
}
