//! Suns: parallel light. `color` is the irradiance at normal incidence. Twin:
//! `shaders/lights/sun.wgsl`.

use super::light::LightSample;
use super::math::FAR;
use super::real::Real;
use super::tables::*;

/// Light at any point.
#[inline(always)]
pub fn light_from_sun(light: &Light, share: Real) -> LightSample {
    LightSample {
        direction: -light.direction,
        distance: FAR,
        radiance: light.color,
        pdf: share,
        extended: false,
    }
}
