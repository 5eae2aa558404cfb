//! Suns with an angular size: discs of even radiance at infinity, which eye paths see. `color` is
//! the radiance, `outer` is 1 - cos of the disc's angular radius, and `reference` is the index of
//! the next sun disc or [`NONE`]. Twin: `shaders/lights/sun_disc.wgsl`.

use super::light::LightSample;
use super::math::sampling::sample_cone;
use super::math::{FAR, TAU, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::tables::*;

/// Samples a direction towards the disc, uniform in its solid angle.
pub fn sample_sun_disc(light: &Light, u: Vec4) -> Vec3 {
    unit(from_frame(-light.direction, sample_cone(Vec2::new(u.y, u.z), light.outer)))
}

/// Density per solid angle of [`sample_sun_disc`] in a direction inside the disc.
pub fn pdf_sun_disc(light: &Light) -> Real {
    1.0 / (TAU * light.outer)
}

/// Returns true if `direction` points into the disc.
pub fn in_sun_disc(light: &Light, direction: Vec3) -> bool {
    // half the squared chord: near the axis 1 - cos loses all digits
    let chord = direction + light.direction;
    0.5 * chord.dot(chord) <= light.outer
}

/// Samples the light at any point.
#[inline(always)]
pub fn light_from_sun_disc(light: &Light, share: Real, u: Vec4) -> LightSample {
    LightSample {
        direction: sample_sun_disc(light, u),
        distance: FAR,
        radiance: light.color,
        pdf: pdf_sun_disc(light) * share,
        extended: true,
    }
}

/// Radiance of all sun discs from `direction`.
pub fn eval_sun_discs(scene: &SceneTables, direction: Vec3) -> Vec3 {
    let mut radiance = Vec3::ZERO;
    let mut index = scene.world.sun_discs;
    while index != NONE {
        let light = &scene.lights[index as usize];
        if in_sun_disc(light, direction) {
            radiance += light.color;
        }
        index = light.reference;
    }
    radiance
}
