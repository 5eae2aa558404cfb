//! Smooth dielectric: Fresnel reflection and refraction, total internal reflection. Twin:
//! `shaders/materials/glass.wgsl`.

use super::fresnel::{fresnel, refracted};
use super::interior::{Interior, interior_beyond, relative_ior};
use super::real::{Real, Vec3};
use super::shading::{IMPORTANCE, Sample, Scatter, ShadingPoint, reflected, shading_correction};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[
    Material { ior: 1.5, ..Material::EMPTY },
    Material { ior: 0.75, absorption: Vec3::new(0.5, 0.2, 0.1), ..Material::EMPTY },
];

/// Reflects or refracts by the Fresnel equations, chosen by `u`. A refracted direction on the wrong
/// side of the surface is replaced by refraction at the geometric normal.
#[inline(always)]
pub fn scatter_glass(
    scene: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    u: Real,
    mode: u32,
) -> Scatter {
    let beyond = interior_beyond(scene, &p.s, p.wo, interior);
    let eta = relative_ior(scene, &p.s, p.wo, interior, &beyond);
    let cos_i = p.wo.dot(p.n);
    let interface = fresnel(cos_i, eta);
    if u < interface.reflectance {
        let Sample { direction, weight } = reflected(p, mode);
        return Scatter { direction, interior: *interior, weight };
    }
    let mut n = p.n;
    let mut wi = refracted(p.wo, n, cos_i, interface.cos_t, eta);
    if wi.dot(p.ng) >= 0.0 {
        n = p.ng;
        let cos_g = p.wo.dot(p.ng);
        let flat = fresnel(cos_g, eta);
        wi = refracted(p.wo, p.ng, cos_g, flat.cos_t, eta);
    }
    // radiance is compressed into a smaller solid angle inside (Veach 1997, section 5.2)
    let mut weight = eta * eta;
    if mode == IMPORTANCE {
        weight = shading_correction(p, n, wi);
    }
    Scatter { direction: wi, interior: beyond, weight: Vec3::splat(weight) }
}
