//! Plastic: a diffuse base below a dielectric coat, smooth or rough. One of its two lobes is chosen
//! by the coat's reflectance: the coat, [`super::coat`] or a mirror, or the base,
//! [`super::plastic_base`]. Twin: `shaders/materials/plastic.wgsl`.
//!
//! With the reflectance `E(cos)` of the coat, its mean `E_avg` over the hemisphere, and the albedo
//! `rho` of the base,
//!
//! `f = f_coat + (1 - E(cos_o)) (1 - E(cos_i)) rho_b / pi`
//!
//! where `rho_b = rho / (1 - E_avg)`, or, if light takes on the base's color each time the coat
//! reflects it back (`first` is 1), `rho_b = (rho / n^2) / (1 - rho (1 - (1 - E_avg) / n^2))`: the
//! coat reflects `1 - (1 - E_avg) / n^2` of the diffuse light below it. A white base reflects all
//! light either way.

use super::Bsdf;
use super::plastic_base::coat_reflectance;
use super::real::{Real, Vec3};
use super::shading::{Layer, Lobe, ShadingPoint};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Albedo `rho_b` of the base as seen through the coat.
#[inline(always)]
pub fn coated_albedo(m: &Material, rho: Vec3) -> Vec3 {
    let passed = 1.0 - m.mean_albedo;
    if m.first == 1 {
        let inside = passed / (m.ior * m.ior);
        return rho / (m.ior * m.ior) / (Vec3::ONE - rho * (1.0 - inside));
    }
    rho / passed
}

/// Chooses the coat with the probability that it reflects, else the base.
#[inline(always)]
pub fn choose_plastic<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let share = coat_reflectance(m, p.wo.dot(p.n).abs());
    if u >= share {
        let reflectance = coated_albedo(m, p.lobe.reflectance);
        let lobe = Lobe { bsdf: Bsdf::PlasticBase, reflectance, ..p.lobe };
        return Layer { lobe, weight: 1.0, u: (u - share) / (1.0 - share).max(1e-6) };
    }
    let bsdf = if m.alpha > 0.0 { Bsdf::Coat } else { Bsdf::Mirror };
    let lobe = Lobe { bsdf, reflectance: Vec3::ONE, ..p.lobe };
    // the mirror reflects the Fresnel fraction, which is the probability; so does the rough coat
    let weight = if m.alpha > 0.0 { 1.0 / share } else { 1.0 };
    Layer { lobe, weight, u: u / share }
}
