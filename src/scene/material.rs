//! Conversion and checks of textures and materials.

use std::path::Path;

use super::appearance::{Material, MaterialKind, Reflectance, Texture, TextureKind};
use super::diagnostics::nearest_file;
use super::file::{MaterialFile, TextureFile};
use super::images::{ColorSpace, ImageFault};
use super::limits::Missing;
use super::load::Loader;
use super::numbers::Paint;
use super::validate::Item;

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
    Material { name: item.name.to_owned(), kind }
}

impl Loader<'_, '_> {
    /// Loads the image under `item.file`.
    pub fn image(
        &mut self,
        item: &Item,
        file: &str,
        color_space: Option<ColorSpace>,
    ) -> Option<usize> {
        let path = self.resolve(file);
        match self.images.load(&path, color_space) {
            Ok(image) => {
                self.odd(item, file, image);
                Some(image)
            }
            Err(fault) => {
                self.image_error(item, &path, fault, "");
                None
            }
        }
    }

    /// Like [`Self::image`], for reflectances: no texel may exceed 1. A gray image may replace a
    /// file that does not exist.
    fn reflectance_image(
        &mut self,
        item: &Item,
        file: &str,
        color_space: Option<ColorSpace>,
    ) -> Option<usize> {
        let path = self.resolve(file);
        let loaded = self.images.load(&path, color_space).and_then(|image| {
            self.images.bound_by_one(&path, image)?;
            Ok(image)
        });
        match loaded {
            Ok(image) => {
                self.odd(item, file, image);
                Some(image)
            }
            Err(fault) if fault.missing && self.allowance.missing == Missing::Warn => {
                self.report.warn(item.node.span_of(fault.key), fault.message, "rendered in gray");
                Some(self.images.stand_in(&path))
            }
            Err(fault) => {
                let advice = if fault.missing { Missing::ADVICE } else { "" };
                self.image_error(item, &path, fault, advice);
                None
            }
        }
    }

    /// Warns about image data that is clamped or ignored.
    fn odd(&mut self, item: &Item, file: &str, image: usize) {
        let at = item.node.span_of("file");
        if self.images.is_transparent(image) {
            let message = format!("the alpha channel of {file} is not used");
            self.report.warn(at.clone(), message, "every texel counts as opaque");
        }
        for (message, label) in self.images.take_notes(image) {
            self.report.warn(at.clone(), message, label);
        }
    }

    fn image_error(&mut self, item: &Item, path: &Path, fault: ImageFault, advice: &str) {
        let near = (fault.missing && !self.report.errors.is_full()).then(|| nearest_file(path));
        let help =
            fault.help.or_else(|| near.flatten().map(|near| format!("did you mean {near}?")));
        let help = match (help, advice) {
            (help, "") => help,
            (Some(help), advice) => Some(format!("{help} {advice}")),
            (None, advice) => Some(format!("name a file that exists, {advice}")),
        };
        self.report.error(item.node.span_of(fault.key), fault.message, fault.expected, help);
    }
}
