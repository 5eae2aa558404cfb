//! A clear dielectric coat over any other material: the path meets the coat with the probability
//! `F(cos_o)` of its Fresnel term, else the material below, whose lobes lose `1 - F(cos_i)` of
//! their light as it passes the coat on its other way (see `coated` in `materials/mod.rs`). Twin:
//! `shaders/materials/clearcoat.wgsl`.

use super::Bsdf;
use super::fresnel::fresnel;
use super::real::{Real, Vec3};
use super::shading::{Layer, Lobe, ShadingPoint, another};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses the coat with the probability that it reflects, else the material below.
#[inline(always)]
pub fn choose_clearcoat<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let share = fresnel(p.wo.dot(p.n).abs(), 1.0 / m.ior).reflectance;
    if u >= share {
        let u = (u - share) / (1.0 - share).max(1e-6);
        return another(p, m.first, u);
    }
    let rough = m.alpha > 0.0;
    let bsdf = if rough { Bsdf::Coat } else { Bsdf::Mirror };
    let lobe = Lobe { bsdf, reflectance: Vec3::ONE, ..p.lobe };
    // the mirror reflects the Fresnel fraction, which is the probability
    Layer { lobe, weight: if rough { 1.0 / share } else { 1.0 }, u: u / share }
}
