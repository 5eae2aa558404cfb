//! Environments: the radiance of rays that leave the scene, constant or from an image. Twin:
//! `shaders/lights/environment.wgsl`.

use super::LightKind;
use super::image::{eval_image, pdf_image, sample_image};
use super::light::LightSample;
use super::math::FAR;
use super::math::sampling::{PDF_SPHERE, sample_sphere};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::tables::*;

/// Radiance of the environment from `direction`.
pub fn eval_environment(scene: &SceneTables, light: &Light, direction: Vec3) -> Vec3 {
    match LightKind::of(light.kind) {
        LightKind::Image => eval_image(scene, light, direction),
        LightKind::Constant
        | LightKind::Area
        | LightKind::Point
        | LightKind::Spot
        | LightKind::Sun
        | LightKind::SunDisc => light.color,
    }
}

/// Samples a direction towards the environment.
pub fn sample_environment(scene: &SceneTables, light: &Light, u: Vec4) -> Vec3 {
    match LightKind::of(light.kind) {
        LightKind::Image => sample_image(scene, light, u),
        LightKind::Constant
        | LightKind::Area
        | LightKind::Point
        | LightKind::Spot
        | LightKind::Sun
        | LightKind::SunDisc => sample_sphere(Vec2::new(u.y, u.z)),
    }
}

/// Density per solid angle of [`sample_environment`].
pub fn pdf_environment(scene: &SceneTables, light: &Light, direction: Vec3) -> Real {
    match LightKind::of(light.kind) {
        LightKind::Image => pdf_image(scene, light, direction),
        LightKind::Constant
        | LightKind::Area
        | LightKind::Point
        | LightKind::Spot
        | LightKind::Sun
        | LightKind::SunDisc => PDF_SPHERE,
    }
}

/// Samples the environment's light at any point.
#[inline(always)]
pub fn light_from_environment(
    scene: &SceneTables,
    light: &Light,
    share: Real,
    u: Vec4,
) -> LightSample {
    let direction = sample_environment(scene, light, u);
    LightSample {
        direction,
        distance: FAR,
        radiance: eval_environment(scene, light, direction),
        pdf: pdf_environment(scene, light, direction) * share,
        extended: true,
    }
}
