//! Profiles: points whose intensity in each direction is given by an equirectangular image, which
//! the host makes from an IES file. The fields are those of an environment image (see `image`);
//! `color` is the intensity of a texel value of one. Twin: `shaders/lights/profile.wgsl`.

use super::emission::Emission;
use super::image::{eval_image, pdf_image};
use super::light::LightSample;
use super::luminaire::inverted;
use super::math::trig::sin_cos;
use super::math::{EPS, FAR, PI, TAU, unit};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Light at `position`.
#[inline(always)]
pub fn light_from_profile(
    scene: &SceneTables,
    light: &Light,
    share: Real,
    position: Vec3,
) -> LightSample {
    let to = light.position - position;
    let dist_sq = to.dot(to);
    if dist_sq == 0.0 {
        return LightSample::NONE;
    }
    let distance = dist_sq.sqrt();
    let direction = to * (1.0 / distance);
    LightSample {
        direction,
        distance: distance * (1.0 - 16.0 * EPS),
        radiance: eval_image(scene, light, -direction) * (1.0 / dist_sq),
        pdf: share,
        extended: false,
    }
}

/// Direction in which a photon leaves the light, by intensity and solid angle.
pub fn sample_profile(scene: &SceneTables, light: &Light, across: Vec2) -> Vec3 {
    let texture = &scene.textures[light.reference as usize];
    let row = inverted(scene, light.first, texture.height, across.y);
    let columns = light.first + texture.height + row.bin * texture.width;
    let column = inverted(scene, columns, texture.width, across.x);
    let (sin_phi, cos_phi) = sin_cos((0.5 - column.at) * TAU);
    let (sin, cos) = sin_cos(row.at * PI);
    Vec3::new(sin * cos_phi, cos, sin * sin_phi)
}

/// Emits a photon from the light; `across` determines its direction.
#[inline(always)]
pub fn emit_profile(scene: &SceneTables, light: &Light, across: Vec2) -> Emission {
    let direction = unit(sample_profile(scene, light, across));
    let ray = Ray { origin: light.position, t_min: 0.0, direction, t_max: FAR };
    let pdf = pdf_image(scene, light, direction);
    let flux = eval_image(scene, light, direction) * (1.0 / (pdf * light.selection));
    Emission::unguided(ray, flux)
}
