//! Environment given by an equirectangular image. `color` scales the image, `reference` is its
//! texture, `outer` and `inner` are the cosine and sine of its rotation about y, and `first` is the
//! start of its distribution: cumulative rows, then the cumulative columns of each row. If
//! `patch_count` is 1, the image is tilted, and `position` and `direction` are its x and y axes.
//! Twin: `shaders/lights/image.wgsl`.

use super::materials::texture::eval_texture;
use super::math::trig::{arctan2, sin_cos};
use super::math::{PI, TAU};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::find_interval;
use super::shape::pdf_bin;
use super::tables::*;

/// Turns a direction from scene space into the axes of the image, before its rotation about y.
pub fn untilted(light: &Light, d: Vec3) -> Vec3 {
    if light.patch_count == 0 {
        return d;
    }
    let z = light.position.cross(light.direction);
    Vec3::new(light.position.dot(d), light.direction.dot(d), z.dot(d))
}

/// Inverse of [`untilted`].
pub fn tilted(light: &Light, d: Vec3) -> Vec3 {
    if light.patch_count == 0 {
        return d;
    }
    let z = light.position.cross(light.direction);
    light.position * d.x + light.direction * d.y + z * d.z
}

/// Texture coordinates of a direction, in the axes of the image, in an equirectangular image
/// rotated about y; v is 1 at the zenith.
pub fn image_uv(light: &Light, direction: Vec3) -> Vec2 {
    let x = light.outer * direction.x - light.inner * direction.z;
    let z = light.inner * direction.x + light.outer * direction.z;
    let r = (x * x + z * z).sqrt();
    Vec2::new(0.5 - arctan2(z, x) * (1.0 / TAU), 1.0 - arctan2(r, direction.y) * (1.0 / PI))
}

/// Radiance of the image from `direction`.
pub fn eval_image(scene: &SceneTables, light: &Light, direction: Vec3) -> Vec3 {
    light.color * eval_texture(scene, light.reference, image_uv(light, untilted(light, direction)))
}

/// Samples a direction towards a pixel, in proportion to the pixel's radiance and solid angle.
pub fn sample_image(scene: &SceneTables, light: &Light, u: Vec4) -> Vec3 {
    let texture = &scene.textures[light.reference as usize];
    let row = find_interval(scene, light.first, texture.height, u.y);
    let column = find_interval(
        scene,
        light.first + texture.height + row * texture.width,
        texture.width,
        u.z,
    );
    // offset in the row from the lower bits of u.w: what is left of u.y gives few distinct offsets
    // in rows of low probability
    let fine = u.w * 4096.0;
    let across = (column as Real + u.w) / texture.width as Real;
    let down = (row as Real + (fine - fine.floor())) / texture.height as Real;
    let (sin_phi, cos_phi) = sin_cos((0.5 - across) * TAU);
    let (sin, cos) = sin_cos(down * PI);
    let x = sin * cos_phi;
    let z = sin * sin_phi;
    let d = Vec3::new(light.outer * x + light.inner * z, cos, light.outer * z - light.inner * x);
    tilted(light, d)
}

/// Density per solid angle of [`sample_image`].
pub fn pdf_image(scene: &SceneTables, light: &Light, toward: Vec3) -> Real {
    let texture = &scene.textures[light.reference as usize];
    let direction = untilted(light, toward);
    let uv = image_uv(light, direction);
    let row = (((1.0 - uv.y) * texture.height as Real).floor() as u32).min(texture.height - 1);
    let column = ((uv.x * texture.width as Real).floor() as u32).min(texture.width - 1);
    let p = pdf_bin(scene, light.first, row, texture.height)
        * pdf_bin(scene, light.first + texture.height + row * texture.width, column, texture.width);
    // from x and z: near a pole 1 - y^2 loses all digits
    let sin = (direction.x * direction.x + direction.z * direction.z).max(1e-12).sqrt();
    p / (2.0 * PI * PI * sin)
}
