//! Conversion of textures and materials.

use super::document::{Document, Item};
use super::file::{MaterialFile, TextureFile};
use super::index;
use super::numbers::Paint;
use crate::scene::builder::SceneBuilder;
use crate::scene::{Material, MaterialKind, Reflectance, Texture, TextureKind};

pub(super) fn texture(builder: &mut SceneBuilder, item: &Item, file: TextureFile) -> Option<()> {
    let kind = match file {
        TextureFile::Image { file, color_space, filter, wrap, scale } => {
            let image = builder.reflectance_image(item, &file, color_space)?;
            TextureKind::Image { image, filter, wrap, scale }
        }
        TextureFile::Checker { colors, scale } => {
            TextureKind::Checker { colors: colors.map(|color| color.rgb()), scale }
        }
        TextureFile::Planks { file, size, color_space, filter } => {
            let image = builder.reflectance_image(item, &file, color_space)?;
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
    let kind = match file {
        MaterialFile::Diffuse { reflectance, roughness } => {
            MaterialKind::Diffuse { reflectance: paint(&reflectance), roughness: roughness.0 }
        }
        MaterialFile::Translucent { reflectance, transmission } => MaterialKind::Translucent {
            reflectance: paint(&reflectance),
            transmission: transmission.0,
        },
        MaterialFile::Mirror { reflectance } => {
            MaterialKind::Mirror { reflectance: paint(&reflectance) }
        }
        MaterialFile::Glass { ior, absorption, priority } => {
            MaterialKind::Glass { ior: ior.0, absorption: absorption.rgb(), priority }
        }
        MaterialFile::Metal { reflectance, roughness } => {
            MaterialKind::Metal { reflectance: paint(&reflectance), roughness: roughness.0 }
        }
    };
    builder.add_material(item, Material { name: item.name.to_owned(), kind });
}
