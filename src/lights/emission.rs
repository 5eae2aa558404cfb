//! Photon emission. Twin: `shaders/lights/emission.wgsl`.

use super::LightKind;
use super::area::emit_area;
use super::guide::guided;
use super::infinity::emit_from_infinity;
use super::materials::enclosing::interior_at;
use super::materials::interior::{Interior, interior_of};
use super::math::rng::{Rng, rng_next};
use super::point::emit_point;
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::choose_light;
use super::shapes::ray::Ray;
use super::spot::emit_spot;
use super::tables::*;

/// Photon as it leaves its light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// First ray.
    pub ray: Ray,
    /// Flux in W, times the number of photons emitted in the pass.
    pub flux: Vec3,
    /// Flux relative to that of the same photon emitted without a guide map; for light from
    /// infinity, of one that passes `near_center` at half of `near_radius`.
    pub relative_flux: Real,
    /// Media that the ray's origin lies in.
    pub interior: Interior,
    /// True if scattered rays can find the light.
    pub extended: bool,
}

impl Emission {
    /// Photon that no guide map has chosen, in a medium that is yet to be determined.
    #[inline(always)]
    pub fn unguided(ray: Ray, flux: Vec3) -> Self {
        Self { ray, flux, relative_flux: 1.0, interior: interior_of(NONE), extended: false }
    }
}

/// Emits a photon from a randomly chosen light.
#[inline(always)]
pub fn emit_photon(scene: &SceneTables, rng: &mut Rng) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    let light = &scene.lights[choose_light(scene, 0, u.x) as usize];
    let mut emission = emit_from(scene, light, u, v);
    emission.extended = LightKind::of(light.kind).is_extended();
    emission
}

/// Emits a photon from `light`, by its guide map if it has one.
#[inline(always)]
pub fn emit_from(scene: &SceneTables, light: &Light, u: Vec4, v: Vec4) -> Emission {
    match LightKind::of(light.kind) {
        LightKind::Area => {
            emit_nearby(scene, light, v, |across| emit_area(scene, light, u, across))
        }
        LightKind::Point => emit_nearby(scene, light, v, |across| emit_point(light, across)),
        LightKind::Spot => emit_nearby(scene, light, v, |across| emit_spot(light, across)),
        LightKind::Sun | LightKind::SunDisc | LightKind::Constant | LightKind::Image => {
            emit_from_infinity(scene, light, u, v)
        }
    }
}

/// Emits a photon from a lamp by `emit`, which takes the two random numbers that determine its
/// direction.
#[inline(always)]
fn emit_nearby(
    scene: &SceneTables,
    light: &Light,
    v: Vec4,
    emit: impl Fn(Vec2) -> Emission,
) -> Emission {
    let (across, scale) = guided(scene, light, Vec2::new(v.x, v.y), v.w);
    let mut emission = emit(across);
    emission.flux *= scale;
    emission.relative_flux *= scale;
    emission.interior = interior_at(scene, light.medium, emission.ray.origin);
    emission
}
