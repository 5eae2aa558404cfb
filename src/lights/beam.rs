//! Beams: parallel light that leaves a disc, collimated to its axis. `position` is the centre of
//! the disc, `direction` its axis, `outer` its squared radius, and `color` the irradiance at normal
//! incidence. Twin: `shaders/lights/beam.wgsl`.

use super::emission::Emission;
use super::light::LightSample;
use super::math::sampling::sample_disc;
use super::math::{EPS, FAR, basis};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Light at `position`, if it lies in the beam.
#[inline(always)]
pub fn light_from_beam(light: &Light, share: Real, position: Vec3) -> LightSample {
    let d = position - light.position;
    let along = d.dot(light.direction);
    let across = d - light.direction * along;
    if along <= 0.0 || across.dot(across) > light.outer {
        return LightSample::NONE;
    }
    LightSample {
        direction: -light.direction,
        distance: along * (1.0 - 16.0 * EPS),
        radiance: light.color,
        pdf: share,
        extended: false,
    }
}

/// Emits a photon from the light; `across` determines its place on the disc.
#[inline(always)]
pub fn emit_beam(light: &Light, across: Vec2) -> Emission {
    let d = sample_disc(across) * light.outer.sqrt();
    let (t, b) = basis(light.direction);
    let origin = light.position + t * d.x + b * d.y;
    let ray = Ray { origin, t_min: 0.0, direction: light.direction, t_max: FAR };
    Emission::unguided(ray, light.color * (light.area / light.selection))
}
