//! Sampling of a light from a surface point, with densities per solid angle. Twin:
//! `shaders/lights/light.wgsl`.

use super::LightKind;
use super::area::light_from_area;
use super::environment::light_from_environment;
use super::point::light_from_point;
use super::real::{Real, Vec3, Vec4};
use super::select::{choose_light, share_of};
use super::spot::light_from_spot;
use super::sun::light_from_sun;
use super::sun_disc::light_from_sun_disc;
use super::tables::*;

/// Unoccluded light that reaches a point from a sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// Distance up to which the shadow ray must be free, scene units.
    pub distance: Real,
    /// Radiance, or irradiance at normal incidence for lights without extent.
    pub radiance: Vec3,
    /// Density per solid angle times the probability of choosing the light; for lights without
    /// extent that probability alone.
    pub pdf: Real,
    /// True if a scattered ray could hit the same light.
    pub extended: bool,
}

impl LightSample {
    /// No light.
    pub const NONE: Self =
        Self { direction: Vec3::Z, distance: 0.0, radiance: Vec3::ZERO, pdf: 1.0, extended: true };
}

/// Samples light at `position`: `u.x` chooses the light by the probabilities at `shares`, the other
/// three numbers sample it.
#[inline(always)]
pub fn sample_light(scene: &SceneTables, shares: u32, position: Vec3, u: Vec4) -> LightSample {
    let index = choose_light(scene, shares, u.x);
    let share = share_of(scene, shares, index);
    sample_one_light(scene, &scene.lights[index as usize], share, position, u)
}

/// Samples light at `position` from `light`, which is chosen with probability `share`.
#[inline(always)]
pub fn sample_one_light(
    scene: &SceneTables,
    light: &Light,
    share: Real,
    position: Vec3,
    u: Vec4,
) -> LightSample {
    match LightKind::of(light.kind) {
        LightKind::Area => light_from_area(scene, light, share, position, u),
        LightKind::Point => light_from_point(light, share, position),
        LightKind::Spot => light_from_spot(light, share, position),
        LightKind::Sun => light_from_sun(light, share),
        LightKind::SunDisc => light_from_sun_disc(light, share, u),
        LightKind::Constant | LightKind::Image => light_from_environment(scene, light, share, u),
    }
}
