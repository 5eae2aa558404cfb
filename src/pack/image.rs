//! Textures and their images.

use super::real::{Bits, Real, ToReal, Vec2};
use super::tables::*;
use crate::math::srgb::linear_from_srgb;
use crate::scene::{self, Filter, ImageData, Reflectance, Texels, TextureKind, Wrap};
use bytemuck::Zeroable;
use glam::{DVec2, DVec3};

/// Fills `textures` and `texels`. The images of profile lights, in their order, and that of the
/// environment become additional textures after the scene's own.
pub fn pack_textures(scene: &scene::Scene, out: &mut SceneTables) {
    if scene.images.iter().any(|i| matches!(i.texels, Texels::Rgba8 { srgb: true, .. })) {
        out.texels.extend((0..256).map(|i| (linear_from_srgb(i as f64 / 255.0) as Real).to_bits()));
    }
    let images: Vec<Texture> =
        scene.images.iter().map(|image| pack_image(image, &mut out.texels)).collect();
    for texture in &scene.textures {
        out.textures.push(match &texture.kind {
            TextureKind::Checker { colors, scale } => Texture {
                kind: TEXTURE_CHECKER,
                scale: vec2(*scale),
                color0: DVec3::from(colors[0]).to_real(),
                color1: DVec3::from(colors[1]).to_real(),
                ..Texture::zeroed()
            },
            TextureKind::Image { image, filter, wrap, scale } => Texture {
                kind: TEXTURE_IMAGE,
                scale: vec2(*scale),
                flags: filter_flag(*filter)
                    | if *wrap == Wrap::Clamp { TEXTURE_CLAMP_U | TEXTURE_CLAMP_V } else { 0 },
                ..images[*image]
            },
            TextureKind::Planks { image, size, filter } => Texture {
                kind: TEXTURE_PLANKS,
                scale: vec2([1.0 / size[0], 1.0 / size[1]]),
                flags: filter_flag(*filter),
                ..images[*image]
            },
        });
    }
    let profiles = scene.lights.iter().filter_map(|light| match light {
        scene::Light::Profile { image, .. } => Some(*image),
        scene::Light::Point { .. }
        | scene::Light::Spot { .. }
        | scene::Light::Projector { .. }
        | scene::Light::Beam { .. }
        | scene::Light::Sun { .. } => None,
    });
    let sky = match &scene.environment {
        Some(scene::Environment::Image { image, .. }) => Some(*image),
        Some(scene::Environment::Constant { .. }) | None => None,
    };
    for image in profiles.chain(sky) {
        out.textures.push(Texture {
            kind: TEXTURE_IMAGE,
            scale: Vec2::ONE,
            // a sphere of directions wraps around horizontally and ends at its poles
            flags: TEXTURE_CLAMP_V,
            ..images[image]
        });
    }
}

/// Period of a material's appearance in u and v; infinite if it does not repeat.
pub fn period(scene: &scene::Scene, material: &scene::Material) -> DVec2 {
    let texture = match material.kind.reflectance() {
        Some(Reflectance::Texture(texture)) => scene.textures.get(*texture),
        Some(Reflectance::Color(_)) | None => None,
    };
    let of = |scale: [f64; 2], cells: [f64; 2]| {
        let period = DVec2::from(cells) / DVec2::from(scale).abs();
        DVec2::select(period.cmpgt(DVec2::ZERO), period, DVec2::INFINITY)
    };
    match texture.map(|texture| &texture.kind) {
        // two cells: the color depends on the sum of both indices
        Some(TextureKind::Checker { scale, .. }) => of(*scale, [2.0, 2.0]),
        Some(TextureKind::Image { scale, wrap: Wrap::Repeat, .. }) => of(*scale, [1.0, 1.0]),
        Some(TextureKind::Image { wrap: Wrap::Clamp, .. }) | None => DVec2::INFINITY,
        // every second row is shifted
        Some(TextureKind::Planks { size, .. }) => DVec2::from(*size) * DVec2::new(2.0, 1.0),
    }
}

/// Subtracts whole periods from `uv` if it lies many of them from 0, so that it keeps its precision
/// in f32.
pub fn reduced(uv: DVec2, period: DVec2) -> DVec2 {
    const MANY: f64 = 64.0;
    let one = |x: f64, period: f64| {
        let periods = (x / period).floor();
        if period.is_finite() && periods.abs() >= MANY { x - periods * period } else { x }
    };
    DVec2::new(one(uv.x, period.x), one(uv.y, period.y))
}

fn vec2(v: [f64; 2]) -> Vec2 {
    Vec2::new(v[0] as Real, v[1] as Real)
}

fn filter_flag(filter: Filter) -> u32 {
    if filter == Filter::Nearest { TEXTURE_NEAREST } else { 0 }
}

fn pack_image(image: &ImageData, texels: &mut Vec<Bits>) -> Texture {
    let first = texels.len() as u32;
    let format = match &image.texels {
        Texels::Rgba8 { srgb, data } => {
            texels.extend(data.iter().map(|p| u32::from_le_bytes(*p) as Bits));
            if *srgb { TEXELS_SRGB8 } else { TEXELS_LINEAR8 }
        }
        Texels::Float(data) => {
            texels.extend(data.iter().flatten().map(|x| (*x as Real).to_bits()));
            TEXELS_FLOAT
        }
    };
    Texture { first, width: image.width, height: image.height, format, ..Texture::zeroed() }
}
