//! Projectors: points that throw an image through a pinhole. `color` is the irradiance of a white
//! texel on a screen that faces the projector at distance one, `direction` the axis, `right` the
//! vector to the right edge of the image at distance one, `outer` its height over its width, and
//! `area` the area of the image there. Twin: `shaders/lights/projector.wgsl`.

use super::emission::Emission;
use super::glow::MAP_SIDE;
use super::light::LightSample;
use super::luminaire::inverted;
use super::materials::texture::eval_texture;
use super::math::{EPS, FAR, unit};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Irradiance at distance one on a screen that faces the projector, at the image's (u, v).
pub fn eval_projector(scene: &SceneTables, light: &Light, uv: Vec2) -> Vec3 {
    if light.flags & LIGHT_TEXTURED == 0 {
        return light.color;
    }
    light.color * eval_texture(scene, light.texture, uv)
}

/// Light at `position`.
#[inline(always)]
pub fn light_from_projector(
    scene: &SceneTables,
    light: &Light,
    share: Real,
    position: Vec3,
) -> LightSample {
    let from = position - light.position;
    let z = from.dot(light.direction);
    if z <= 0.0 {
        return LightSample::NONE;
    }
    let up = light.right.cross(light.direction) * light.outer;
    let x = from.dot(light.right) / (z * light.right.dot(light.right));
    let y = from.dot(up) / (z * up.dot(up));
    if x.abs() >= 1.0 || y.abs() >= 1.0 {
        return LightSample::NONE;
    }
    let irradiance = eval_projector(scene, light, Vec2::new(x + 1.0, y + 1.0) * 0.5);
    let distance = from.dot(from).sqrt();
    LightSample {
        direction: from * (-1.0 / distance),
        distance: distance * (1.0 - 16.0 * EPS),
        // a screen at depth z receives irradiance / z^2, at the cosine z / distance
        radiance: irradiance * (distance / (z * z * z)),
        pdf: share,
        extended: false,
    }
}

/// Emits a photon from the light; `across` determines its place in the image, by the image's
/// emission map.
#[inline(always)]
pub fn emit_projector(scene: &SceneTables, light: &Light, across: Vec2) -> Emission {
    let mut uv = across;
    let mut pdf = 1.0;
    if light.flags & LIGHT_MAPPED != 0 {
        let row = inverted(scene, light.map, MAP_SIDE, across.y);
        let columns = light.map + MAP_SIDE + row.bin * MAP_SIDE;
        let column = inverted(scene, columns, MAP_SIDE, across.x);
        uv = Vec2::new(column.at, row.at);
        pdf = row.pdf * column.pdf;
    }
    let up = light.right.cross(light.direction) * light.outer;
    let d = light.direction + light.right * (2.0 * uv.x - 1.0) + up * (2.0 * uv.y - 1.0);
    let ray = Ray { origin: light.position, t_min: 0.0, direction: unit(d), t_max: FAR };
    let flux = eval_projector(scene, light, uv) * (light.area / (pdf * light.selection));
    Emission::unguided(ray, flux)
}
