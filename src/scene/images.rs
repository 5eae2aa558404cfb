//! Image files: png and jpg (8 or 16 bits), hdr and exr.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use exr::prelude::{ReadChannels, ReadLayers};
use image::{DynamicImage, ImageReader};

use super::appearance::{ImageData, Texels};
use super::file::ColorSpace;

/// Why an image cannot be used; `key` is the key in the scene file to blame.
pub(crate) struct ImageFault {
    pub key: &'static str,
    pub message: String,
    pub expected: &'static str,
}

/// Images read so far, each (file, color space) once.
#[derive(Debug, Default)]
pub(crate) struct ImageStore {
    pub images: Vec<ImageData>,
    /// Every file asked for.
    pub files: Vec<PathBuf>,
    known: BTreeMap<(PathBuf, Option<ColorSpace>), usize>,
    transparent: BTreeSet<usize>,
}

impl ImageStore {
    /// Index of the image in a file, read when it is new.
    pub fn load(&mut self, path: &Path, space: Option<ColorSpace>) -> Result<usize, ImageFault> {
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if let Some(&index) = self.known.get(&(canonical.clone(), space)) {
            return Ok(index);
        }
        self.files.push(path.to_owned());
        let (image, transparent) = read(path, space)?;
        let index = self.images.len();
        self.images.push(image);
        self.known.insert((canonical, space), index);
        if transparent {
            self.transparent.insert(index);
        }
        Ok(index)
    }

    /// Whether an image has an alpha channel that is not 1 everywhere.
    pub fn is_transparent(&self, index: usize) -> bool {
        self.transparent.contains(&index)
    }
}

const EXPECTED: &str = "expected a png, jpg, hdr or exr file";

fn fault(path: &Path, why: impl std::fmt::Display) -> ImageFault {
    ImageFault {
        key: "file",
        message: format!("cannot read image {}: {why}", path.display()),
        expected: EXPECTED,
    }
}

/// A texel of an EXR file; alpha is 1 in a file without.
type Rgba = (f32, f32, f32, f32);

/// An image, and whether it has alpha below 1.
fn read(path: &Path, space: Option<ColorSpace>) -> Result<(ImageData, bool), ImageFault> {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let (data, transparent) = if is_exr { read_exr(path)? } else { read_common(path, space)? };
    if let Texels::Float(texels) = &data.texels {
        if space == Some(ColorSpace::Srgb) && is_linear_file(path) {
            return Err(ImageFault {
                key: "color_space",
                message: format!("{} holds linear numbers", path.display()),
                expected: "expected \"linear\", or nothing",
            });
        }
        let bad =
            texels.iter().position(|texel| texel.iter().any(|&value| !value.is_finite() || value < 0.0));
        if let Some(index) = bad {
            let (x, y) = (index % data.width as usize, index / data.width as usize);
            return Err(fault(
                path,
                format!("texel ({x}, {y}) is {:?}, negative or not finite", texels[index]),
            ));
        }
    }
    Ok((data, transparent))
}

fn is_linear_file(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| extension == "exr" || extension == "hdr")
}

fn read_common(path: &Path, space: Option<ColorSpace>) -> Result<(ImageData, bool), ImageFault> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let image = reader.map_err(|error| fault(path, error))?.decode().map_err(|error| fault(path, error))?;
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err(fault(path, "it has no pixels"));
    }
    let transparent =
        image.color().has_alpha() && image.to_rgba16().pixels().any(|pixel| pixel.0[3] < u16::MAX);
    let srgb = space != Some(ColorSpace::Linear);
    let texels = match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Texels::Float(image.to_rgb32f().pixels().map(|pixel| pixel.0).collect())
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let decode = |value: u16| {
                let share = f64::from(value) / 65535.0;
                (if srgb { linear_from_srgb(share) } else { share }) as f32
            };
            Texels::Float(image.to_rgb16().pixels().map(|pixel| pixel.0.map(decode)).collect())
        }
        _ => Texels::Rgba8 { srgb, data: image.to_rgba8().pixels().map(|pixel| pixel.0).collect() },
    };
    Ok((ImageData { path: path.display().to_string(), width, height, texels }, transparent))
}

/// IEC 61966-2-1.
fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn read_exr(path: &Path) -> Result<(ImageData, bool), ImageFault> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![[0.0f32; 3]; size.area()], false),
            |(width, texels, transparent): &mut (usize, Vec<[f32; 3]>, bool), at, (r, g, b, a): Rgba| {
                texels[at.y() * *width + at.x()] = [r, g, b];
                *transparent |= a < 1.0;
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| fault(path, error))?;
    let size = image.layer_data.size;
    let (_, texels, transparent) = image.layer_data.channel_data.pixels;
    let data = ImageData {
        path: path.display().to_string(),
        width: size.width() as u32,
        height: size.height() as u32,
        texels: Texels::Float(texels),
    };
    Ok((data, transparent))
}
