//! Conversion of textures and materials.

use super::document::{Document, Item};
use super::file::{CoverageFile, MaterialFile, TextureFile};
use super::index;
use super::named::{glass_absorption, glass_index, metal_index, thin_glass_keys};
use super::numbers::Paint;
use crate::scene::builder::SceneBuilder;
use crate::scene::parts::Part;
use crate::scene::{Material, MaterialKind, Opacity, Reflectance, Texture, TextureKind};

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
    let (kind, coverage) = match file {
        MaterialFile::Diffuse { reflectance, roughness, coverage } => {
            let kind =
                MaterialKind::Diffuse { reflectance: paint(&reflectance), roughness: roughness.0 };
            (kind, coverage)
        }
        MaterialFile::Translucent { reflectance, transmission, coverage } => {
            let reflectance = paint(&reflectance);
            (MaterialKind::Translucent { reflectance, transmission: transmission.0 }, coverage)
        }
        MaterialFile::Mirror { reflectance, coverage } => {
            (MaterialKind::Mirror { reflectance: paint(&reflectance) }, coverage)
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
            coverage,
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
                MaterialKind::ThinGlass { ior, transmittance }
            } else {
                let (roughness, priority) = (roughness.0, priority.unwrap_or_default());
                MaterialKind::Glass { ior, roughness, absorption, priority }
            };
            (kind, coverage)
        }
        MaterialFile::Metal { reflectance, eta, k, material, roughness, coverage } => {
            let index = metal_index(
                builder,
                item,
                reflectance.is_some(),
                [eta.map(|eta| eta.rgb()), k.map(|k| k.rgb())],
                material.as_deref(),
            );
            let kind = match (index, reflectance) {
                (Some([eta, k]), _) => MaterialKind::Conductor { eta, k, roughness: roughness.0 },
                (None, reflectance) => MaterialKind::Metal {
                    reflectance: reflectance.as_ref().map_or(Reflectance::Color([1.0; 3]), paint),
                    roughness: roughness.0,
                },
            };
            (kind, coverage)
        }
        MaterialFile::Plastic { reflectance, ior, roughness, nonlinear, coverage } => {
            let reflectance = paint(&reflectance);
            let roughness = roughness.0;
            (MaterialKind::Plastic { reflectance, ior, roughness, nonlinear }, coverage)
        }
        MaterialFile::Mix { materials: [first, second], amount, coverage } => {
            let materials = [named(&first), named(&second)];
            (MaterialKind::Mix { materials, amount: paint(&amount) }, coverage)
        }
        MaterialFile::TwoSided { front, back, coverage } => {
            (MaterialKind::TwoSided { front: named(&front), back: named(&back) }, coverage)
        }
        MaterialFile::Null {} => {
            (MaterialKind::Null, CoverageFile { opacity: None, opacity_cutoff: None })
        }
    };
    let opacity = match (coverage.opacity, coverage.opacity_cutoff) {
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
    builder.add_material(item, Material { name: item.name.to_owned(), kind, opacity });
}
