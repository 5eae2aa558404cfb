//! Conversion of textures and materials.

use super::document::{Document, Item};
use super::file::{CommonFile, MaterialFile, TextureFile};
use super::index;
use super::named::{glass_absorption, glass_index, metal_index, thin_glass_keys};
use super::numbers::{Amount, GrainedAmount, Paint};
use crate::scene::builder::SceneBuilder;
use crate::scene::parts::Part;
use crate::scene::{
    BumpMap, Material, MaterialKind, NormalMap, Opacity, Principled, Reflectance, Texture,
    TextureKind,
};

pub(super) fn texture(builder: &mut SceneBuilder, item: &Item, file: TextureFile) -> Option<()> {
    let kind = match file {
        TextureFile::Image { file, color_space, channel, filter, wrap, scale } => {
            let image = builder.reflectance_image(item, &file, color_space, channel)?;
            TextureKind::Image { image, filter, wrap, scale }
        }
        TextureFile::Checker { colors, scale } => {
            TextureKind::Checker { colors: colors.map(|color| color.rgb()), scale }
        }
        TextureFile::Planks { file, size, color_space, filter } => {
            let image = builder.reflectance_image(item, &file, color_space, None)?;
            TextureKind::Planks { image, size: size.map(f64::from), filter }
        }
    };
    builder.add_texture(item, Texture { name: item.name.to_owned(), kind });
    Some(())
}

pub(super) fn material(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: MaterialFile,
) {
    let paint = |paint: &Paint| match paint {
        Paint::Color(color) => Reflectance::Color(color.rgb()),
        Paint::Texture(name) => Reflectance::Texture(index(document, "textures", name)),
    };
    let named = |name: &str| index(document, "materials", name);
    let share = |amount: &Amount| match amount {
        Amount::Number(number) => Reflectance::Color([number.0; 3]),
        Amount::Texture(name) => Reflectance::Texture(index(document, "textures", name)),
    };
    let mut roughness_v = None;
    let mut roughness_map = None;
    // a texture is a factor of the roughness 1
    let mut rough = |amount: &Amount| match amount {
        Amount::Number(number) => number.0,
        Amount::Texture(name) => {
            roughness_map = Some(index(document, "textures", name));
            1.0
        }
    };
    let (kind, common) = match file {
        MaterialFile::Diffuse { reflectance, roughness, common } => {
            let (reflectance, roughness) = (paint(&reflectance), rough(&roughness));
            (MaterialKind::Diffuse { reflectance, roughness }, common)
        }
        MaterialFile::Translucent { reflectance, transmission, common } => {
            let reflectance = paint(&reflectance);
            (MaterialKind::Translucent { reflectance, transmission: transmission.0 }, common)
        }
        MaterialFile::Mirror { reflectance, common } => {
            (MaterialKind::Mirror { reflectance: paint(&reflectance) }, common)
        }
        MaterialFile::Glass {
            ior,
            material,
            roughness,
            absorption,
            attenuation_color,
            attenuation_distance,
            priority,
            thin,
            transmittance,
            common,
        } => {
            let ior = glass_index(builder, item, ior.map(f64::from), material.as_deref());
            let absorption = glass_absorption(
                builder,
                item,
                absorption.map(|absorption| absorption.rgb()),
                attenuation_color.map(|color| color.rgb()),
                attenuation_distance.map(f64::from),
            );
            thin_glass_keys(builder, item, thin);
            let kind = if thin {
                let transmittance =
                    transmittance.as_ref().map_or(Reflectance::Color([1.0; 3]), paint);
                MaterialKind::ThinGlass { ior, roughness: roughness.0, transmittance }
            } else {
                let (roughness, priority) = (roughness.0, priority.unwrap_or_default());
                MaterialKind::Glass { ior, roughness, absorption, priority }
            };
            (kind, common)
        }
        MaterialFile::Metal { reflectance, eta, k, material, roughness, common } => {
            let index = metal_index(
                builder,
                item,
                reflectance.is_some(),
                [eta.map(|eta| eta.rgb()), k.map(|k| k.rgb())],
                material.as_deref(),
            );
            let roughness = match roughness {
                GrainedAmount::Number(number) => number.0,
                GrainedAmount::Texture(name) => rough(&Amount::Texture(name)),
                GrainedAmount::Grain([u, v]) => {
                    roughness_v = Some(v.0);
                    u.0
                }
            };
            let kind = match (index, reflectance) {
                (Some([eta, k]), _) => MaterialKind::Conductor { eta, k, roughness },
                (None, reflectance) => MaterialKind::Metal {
                    reflectance: reflectance.as_ref().map_or(Reflectance::Color([1.0; 3]), paint),
                    roughness,
                },
            };
            (kind, common)
        }
        MaterialFile::Plastic { reflectance, ior, roughness, nonlinear, common } => {
            let reflectance = paint(&reflectance);
            let roughness = rough(&roughness);
            (MaterialKind::Plastic { reflectance, ior, roughness, nonlinear }, common)
        }
        MaterialFile::Principled {
            base_color,
            metallic,
            roughness,
            anisotropy,
            ior,
            specular,
            transmission,
            clearcoat,
            clearcoat_roughness,
            common,
        } => {
            let kind = MaterialKind::Principled(Principled {
                base_color: paint(&base_color),
                metallic: share(&metallic),
                roughness: rough(&roughness),
                anisotropy: anisotropy.0,
                ior,
                specular: share(&specular),
                transmission: share(&transmission),
                clearcoat: share(&clearcoat),
                clearcoat_roughness: clearcoat_roughness.0,
            });
            (kind, common)
        }
        MaterialFile::Mix { materials: [first, second], amount, common } => {
            let materials = [named(&first), named(&second)];
            (MaterialKind::Mix { materials, amount: paint(&amount) }, common)
        }
        MaterialFile::TwoSided { front, back, common } => {
            (MaterialKind::TwoSided { front: named(&front), back: named(&back) }, common)
        }
        MaterialFile::Null {} => (MaterialKind::Null, CommonFile::default()),
    };
    let maps = maps(builder, document, item, &common);
    let opacity = match (common.opacity, common.opacity_cutoff) {
        (Some(amount), cutoff) => {
            let cutoff = cutoff.map(|cutoff| cutoff.0);
            Some(Opacity { amount: paint(&amount), cutoff })
        }
        (None, Some(_)) => {
            let message = format!("{} has a cutoff without an opacity", item.place());
            let label = "expected `opacity` too, such as the name of a texture";
            builder.report.error(item.span_of("opacity_cutoff"), message, label, None);
            None
        }
        (None, None) => None,
    };
    let (normal_map, bump_map) = maps;
    let name = item.name.to_owned();
    builder.add_material(
        item,
        Material { name, kind, opacity, roughness_map, roughness_v, normal_map, bump_map },
    );
}

/// The textures that bend the normal. Reports a factor without its map and a height map without its
/// height.
fn maps(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    common: &CommonFile,
) -> (Option<NormalMap>, Option<BumpMap>) {
    let texture = |name: &String| index(document, "textures", name);
    for (key, map, given) in [
        (
            "normal_strength",
            "normal_map",
            common.normal_strength.is_some() && common.normal_map.is_none(),
        ),
        ("bump_height", "bump_map", common.bump_height.is_some() && common.bump_map.is_none()),
        ("bump_map", "bump_height", common.bump_map.is_some() && common.bump_height.is_none()),
    ] {
        if given {
            let message = format!("{} has `{key}` without `{map}`", item.place());
            let label = format!("expected `{map}` too");
            builder.report.error(item.span_of(key), message, &label, None);
        }
    }
    let normal = common.normal_map.as_ref().map(|name| NormalMap {
        texture: texture(name),
        strength: common.normal_strength.unwrap_or(1.0),
    });
    let bump = common.bump_map.as_ref().zip(common.bump_height);
    (normal, bump.map(|(name, height)| BumpMap { texture: texture(name), height }))
}
