//! Point lights: they emit evenly into all directions. `color` is the intensity. Twin:
//! `shaders/lights/point.wgsl`.

use super::emission::Emission;
use super::light::LightSample;
use super::math::sampling::sample_sphere;
use super::math::{EPS, FAR, TAU, unit};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Light at `position` from a point with this intensity in all directions.
#[inline(always)]
pub fn light_from_point(light: &Light, share: Real, position: Vec3) -> LightSample {
    let to = light.position - position;
    let dist_sq = to.dot(to);
    if dist_sq == 0.0 {
        return LightSample::NONE;
    }
    let distance = dist_sq.sqrt();
    LightSample {
        direction: to * (1.0 / distance),
        distance: distance * (1.0 - 16.0 * EPS),
        radiance: light.color * (1.0 / dist_sq),
        pdf: share,
        extended: false,
    }
}

/// Emits a photon from the light; `across` determines its direction.
#[inline(always)]
pub fn emit_point(light: &Light, across: Vec2) -> Emission {
    let direction = unit(sample_sphere(across));
    let ray = Ray { origin: light.position, t_min: 0.0, direction, t_max: FAR };
    Emission::unguided(ray, light.color * (2.0 * TAU / light.selection))
}
