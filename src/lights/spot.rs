//! Spot lights: points that emit into a cone. `color` is the intensity in the inner cone; `inner`
//! and `outer` are 1 - cos of the cones' half angles. Twin: `shaders/lights/spot.wgsl`.

use super::emission::Emission;
use super::light::LightSample;
use super::math::sampling::sample_cone;
use super::math::{FAR, TAU, from_frame, unit};
use super::point::light_from_point;
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Spot falloff at `versine`, which is 1 - cos of the angle to the axis: 1 inside the inner cone, 0
/// outside the outer cone, a smoothstep of the cosine in between.
pub fn spot_falloff(light: &Light, versine: Real) -> Real {
    if versine <= light.inner {
        return 1.0;
    }
    if versine >= light.outer {
        return 0.0;
    }
    let x = (light.outer - versine) / (light.outer - light.inner);
    x * x * (3.0 - 2.0 * x)
}

/// Light at `position`.
#[inline(always)]
pub fn light_from_spot(light: &Light, share: Real, position: Vec3) -> LightSample {
    let mut sample = light_from_point(light, share, position);
    // half the squared chord: near the axis 1 - cos loses all digits
    let chord = sample.direction + light.direction;
    sample.radiance *= spot_falloff(light, 0.5 * chord.dot(chord));
    sample
}

/// Emits a photon from the light; `across` determines its direction.
#[inline(always)]
pub fn emit_spot(light: &Light, across: Vec2) -> Emission {
    let local = sample_cone(across, light.outer);
    let direction = unit(from_frame(light.direction, local));
    let ray = Ray { origin: light.position, t_min: 0.0, direction, t_max: FAR };
    let solid_angle = TAU * light.outer;
    let falloff = spot_falloff(light, across.x * light.outer);
    Emission::unguided(ray, light.color * (falloff * solid_angle / light.selection))
}
