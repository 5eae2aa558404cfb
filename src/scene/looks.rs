//! Meaning of textures and materials.

use super::appearance::{Material, MaterialKind, Reflectance, Texels, Texture, TextureKind};
use super::check::Item;
use super::file::{ColorSpace, MaterialFile, TextureFile};
use super::load::Loader;
use super::numbers::Paint;
use super::text::nearest_file;

pub(super) fn texture(loader: &mut Loader, item: &Item, file: TextureFile) -> Option<Texture> {
    let kind = match file {
        TextureFile::Image { file, color_space, filter, wrap, scale } => {
            let image = loader.reflectance_image(item, &file, color_space)?;
            TextureKind::Image { image, filter, wrap, scale }
        }
        TextureFile::Checker { colors, scale } => {
            TextureKind::Checker { colors: colors.map(|color| color.rgb()), scale }
        }
        TextureFile::Planks { file, size, color_space, filter } => {
            let image = loader.reflectance_image(item, &file, color_space)?;
            TextureKind::Planks { image, size: size.map(f64::from), filter }
        }
    };
    Some(Texture { name: item.name.to_owned(), kind })
}

pub(super) fn material(loader: &Loader, item: &Item, file: MaterialFile) -> Material {
    let paint = |paint: &Paint| match paint {
        Paint::Color(color) => Reflectance::Color(color.rgb()),
        Paint::Texture(name) => Reflectance::Texture(loader.index("textures", name)),
    };
    let kind = match file {
        MaterialFile::Diffuse { reflectance } => MaterialKind::Diffuse { reflectance: paint(&reflectance) },
        MaterialFile::Mirror { reflectance } => MaterialKind::Mirror { reflectance: paint(&reflectance) },
        MaterialFile::Glass { ior, absorption } => {
            MaterialKind::Glass { ior: ior.0, absorption: absorption.rgb() }
        }
        MaterialFile::Metal { reflectance, roughness } => {
            MaterialKind::Metal { reflectance: paint(&reflectance), roughness: roughness.0 }
        }
    };
    Material { name: item.name.to_owned(), kind }
}

impl Loader<'_, '_> {
    /// The image under `item.file`.
    pub fn image(&mut self, item: &Item, file: &str, color_space: Option<ColorSpace>) -> Option<usize> {
        let path = self.resolve(file);
        match self.images.load(&path, color_space) {
            Ok(image) => {
                if self.images.is_transparent(image) {
                    let message = format!("the alpha channel of {file} is not used");
                    self.report.warn(item.node.span_of("file"), message, "every texel counts as opaque");
                }
                Some(image)
            }
            Err(fault) => {
                let near = (fault.missing && !self.report.errors.is_full()).then(|| nearest_file(&path));
                let help = fault.help.or_else(|| near.flatten().map(|near| format!("did you mean {near}?")));
                self.report.error(item.node.span_of(fault.key), fault.message, fault.expected, help);
                None
            }
        }
    }

    /// As [`Self::image`], for shares of light: no texel above 1.
    fn reflectance_image(
        &mut self,
        item: &Item,
        file: &str,
        color_space: Option<ColorSpace>,
    ) -> Option<usize> {
        let image = self.image(item, file, color_space)?;
        if let Texels::Float(texels) = &self.images.images[image].texels {
            let most = texels.iter().flatten().fold(0.0f32, |most, &value| most.max(value));
            if most > 1.0 {
                let message =
                    format!("{file} has a texel of {most}; a surface cannot reflect more than it receives");
                self.report.error(item.node.span_of("file"), message, "expected values from 0 to 1", None);
            }
        }
        Some(image)
    }
}
