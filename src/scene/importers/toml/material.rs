//! Conversion of textures and materials.

use super::document::{Document, Item};
use super::file::{MaterialFile, TextureFile};
use super::index;
use super::numbers::Paint;
use crate::scene::builder::SceneBuilder;
use crate::scene::named::glasses::{glass, glass_names};
use crate::scene::numbers::LARGEST;
use crate::scene::parts::Part;
use crate::scene::{Material, MaterialKind, Reflectance, Rgb, Texture, TextureKind};

pub(super) fn texture(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: TextureFile,
) -> Option<()> {
    // textures that only emit may have texels above 1
    let names = |section, key: &str| {
        let mut nodes = document.items(section).filter_map(|user| user.node.get(key));
        nodes.any(|node| node.str() == Some(item.name))
    };
    let emits = (names("shapes", "emission") || names("lights", "texture"))
        && !names("materials", "reflectance");
    let mut image = |file: &str, color_space| match emits {
        true => builder.image(item, file, color_space),
        false => builder.reflectance_image(item, file, color_space),
    };
    let kind = match file {
        TextureFile::Image { file, color_space, filter, wrap, scale } => {
            let image = image(&file, color_space)?;
            TextureKind::Image { image, filter, wrap, scale }
        }
        TextureFile::Checker { colors, scale } => {
            TextureKind::Checker { colors: colors.map(|color| color.rgb()), scale }
        }
        TextureFile::Planks { file, size, color_space, filter } => {
            let image = image(&file, color_space)?;
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
        MaterialFile::Glass {
            ior,
            material,
            absorption,
            attenuation_color,
            attenuation_distance,
            priority,
        } => MaterialKind::Glass {
            ior: glass_index(builder, item, ior.map(f64::from), material.as_deref()),
            absorption: glass_absorption(
                builder,
                item,
                absorption.map(|absorption| absorption.rgb()),
                attenuation_color.map(|color| color.rgb()),
                attenuation_distance.map(f64::from),
            ),
            priority,
        },
        MaterialFile::Metal { reflectance, roughness } => {
            MaterialKind::Metal { reflectance: paint(&reflectance), roughness: roughness.0 }
        }
    };
    builder.add_material(item, Material { name: item.name.to_owned(), kind });
}

/// Index of refraction from the key `ior` or from the name of a material. Reports a name that is
/// not known, and none or both of the keys.
fn glass_index(
    builder: &mut SceneBuilder,
    item: &Item,
    ior: Option<f64>,
    material: Option<&str>,
) -> f64 {
    let report = &mut builder.report;
    match (ior, material) {
        (Some(ior), None) => return ior,
        (None, Some(name)) => match glass(name) {
            Some(glass) => return glass.ior,
            None => {
                let message = format!("there is no glass called `{name}`");
                let label = report.did_you_mean(name, glass_names(), "expected a known glass");
                let names: Vec<_> = glass_names().collect();
                let help = format!("known: {}; or give the index as `ior`", names.join(", "));
                report.error(item.span_of("material"), message, label, Some(help));
            }
        },
        (Some(_), Some(_)) => {
            let message = format!("{} has both an index and the name of a glass", item.place());
            let label = "expected either `ior` or `material`";
            report.error(item.span_of("material"), message, label, None);
        }
        (None, None) => {
            let message = format!("{} lacks `ior`", item.place());
            let help = Some("for example ior = 1.5, or material = \"bk7\"".to_owned());
            let label = "expected `ior` or `material`".to_owned();
            report.missing(item.span(), message, label, help);
        }
    }
    1.0
}

/// Absorption coefficient per scene unit, from itself or from the color that is left at a distance
/// (glTF 2.0, KHR_materials_volume): `-ln(color) / distance`.
fn glass_absorption(
    builder: &mut SceneBuilder,
    item: &Item,
    absorption: Option<Rgb>,
    color: Option<Rgb>,
    distance: Option<f64>,
) -> Rgb {
    let report = &mut builder.report;
    if absorption.is_some() && (color.is_some() || distance.is_some()) {
        let message = format!("{} has two kinds of absorption", item.place());
        let key = if color.is_some() { "attenuation_color" } else { "attenuation_distance" };
        let label = "expected either `absorption` or `attenuation_color`";
        report.error(item.span_of(key), message, label, None);
    }
    match (color, distance) {
        (Some(color), distance) => {
            let distance = distance.unwrap_or(1.0);
            // a channel of zero leaves nothing at any distance that matters
            color.map(|left| (-left.max(f64::MIN_POSITIVE).ln() / distance).min(LARGEST))
        }
        (None, Some(_)) if absorption.is_none() => {
            let message = format!("{} has a distance without a color", item.place());
            let label = "expected `attenuation_color` too";
            report.error(item.span_of("attenuation_distance"), message, label, None);
            [0.0; 3]
        }
        (None, _) => absorption.unwrap_or_default(),
    }
}
