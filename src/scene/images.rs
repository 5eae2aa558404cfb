//! Image files: png and jpg (8 or 16 bits), hdr and exr.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};

use super::allowance::{Allowance, Refusal, within};
use super::appearance::{ImageData, Texels};
use super::file::ColorSpace;
use crate::srgb::linear_from_srgb;

/// Why an image cannot be used; `key` is the key in the scene file to blame.
pub(crate) struct ImageFault {
    pub key: &'static str,
    pub message: String,
    pub expected: &'static str,
    pub help: Option<String>,
    /// Whether there is no such file.
    pub missing: bool,
}

/// Images read so far, each (file, color space) once.
#[derive(Debug, Default)]
pub(crate) struct ImageStore {
    pub images: Vec<ImageData>,
    /// Every file asked for.
    pub files: Vec<PathBuf>,
    known: BTreeMap<(PathBuf, Option<ColorSpace>), usize>,
    transparent: BTreeSet<usize>,
    allowance: Allowance,
    /// Bytes of texels of all images, those too that could not be used.
    spent: u64,
}

impl ImageStore {
    pub fn new(allowance: &Allowance) -> Self {
        Self { allowance: allowance.clone(), ..Self::default() }
    }

    /// Index of the image in a file, read when it is new.
    pub fn load(&mut self, path: &Path, space: Option<ColorSpace>) -> Result<usize, ImageFault> {
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if let Some(&index) = self.known.get(&(canonical.clone(), space)) {
            return Ok(index);
        }
        self.files.push(path.to_owned());
        let (image, transparent) = self.read(path, space)?;
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

/// Bytes that a decoder may take beside the pixels.
const DECODER_BYTES: u64 = 64 << 20;

const EXPECTED: &str = "expected a png, jpg, hdr or exr file";

fn fault(path: &Path, why: impl std::fmt::Display) -> ImageFault {
    ImageFault {
        key: "file",
        message: format!("cannot read image {}: {why}", path.display()),
        expected: EXPECTED,
        help: None,
        missing: false,
    }
}

fn refused(path: &Path, refusal: Refusal) -> ImageFault {
    ImageFault { help: refusal.help(), missing: refusal.is_missing(), ..fault(path, refusal) }
}

/// A texel of an EXR file; alpha is 1 in a file without.
type Rgba = (f32, f32, f32, f32);

impl ImageStore {
    /// An image, and whether it has alpha below 1.
    fn read(&mut self, path: &Path, space: Option<ColorSpace>) -> Result<(ImageData, bool), ImageFault> {
        let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        let (data, transparent) = if is_exr { self.read_exr(path)? } else { self.read_common(path, space)? };
        if let Texels::Float(texels) = &data.texels {
            if space == Some(ColorSpace::Srgb) && is_linear_file(path) {
                return Err(ImageFault {
                    key: "color_space",
                    message: format!("{} holds linear numbers", path.display()),
                    expected: "expected \"linear\", or nothing",
                    help: None,
                    missing: false,
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

    fn open(&self, path: &Path) -> Result<BufReader<File>, ImageFault> {
        let most = ("texture-bytes", self.allowance.texture_bytes);
        let file = self.allowance.open(path, most).map_err(|refusal| refused(path, refusal))?;
        Ok(BufReader::new(file))
    }

    /// Takes what an image needs from what is left, before its pixels are read.
    fn spend(&mut self, path: &Path, pixels: u64, bytes_each: u64) -> Result<(), ImageFault> {
        let Allowance { texture_pixels, texture_bytes, .. } = self.allowance;
        let bytes = pixels.saturating_mul(bytes_each);
        within("texture-pixels", "pixels", pixels, texture_pixels)
            .and_then(|()| within("texture-bytes", "bytes of texels", bytes, texture_bytes - self.spent))
            .map_err(|refusal| refused(path, refusal))?;
        self.spent += bytes;
        Ok(())
    }

    fn read_common(
        &mut self,
        path: &Path,
        space: Option<ColorSpace>,
    ) -> Result<(ImageData, bool), ImageFault> {
        let mut reader =
            ImageReader::new(self.open(path)?).with_guessed_format().map_err(|error| fault(path, error))?;
        let mut limits = Limits::no_limits();
        // For what decoders need beside the pixels, which are counted here.
        limits.max_alloc = Some(self.allowance.texture_bytes.saturating_add(DECODER_BYTES));
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(|error| fault(path, error))?;
        let (width, height) = decoder.dimensions();
        if width == 0 || height == 0 {
            return Err(fault(path, "it has no pixels"));
        }
        let wide = decoder.color_type().bytes_per_pixel() > decoder.color_type().channel_count();
        self.spend(path, u64::from(width) * u64::from(height), if wide { 12 } else { 4 })?;
        let image = DynamicImage::from_decoder(decoder).map_err(|error| fault(path, error))?;
        let transparent = is_transparent(&image);
        let srgb = space != Some(ColorSpace::Linear);
        let texels = match image {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                Texels::Float(image.into_rgb32f().pixels().map(|pixel| pixel.0).collect())
            }
            DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_) => {
                let decode = |value: u16| {
                    let share = f64::from(value) / 65535.0;
                    (if srgb { linear_from_srgb(share) } else { share }) as f32
                };
                Texels::Float(image.into_rgb16().pixels().map(|pixel| pixel.0.map(decode)).collect())
            }
            _ => Texels::Rgba8 { srgb, data: image.into_rgba8().pixels().map(|pixel| pixel.0).collect() },
        };
        Ok((ImageData { path: path.display().to_string(), width, height, texels }, transparent))
    }

    fn read_exr(&mut self, path: &Path) -> Result<(ImageData, bool), ImageFault> {
        let meta =
            MetaData::read_from_buffered(self.open(path)?, false).map_err(|error| fault(path, error))?;
        let pixels = meta.headers.iter().map(|header| header.layer_size.area() as u64);
        self.spend(path, pixels.max().unwrap_or(0), 12)?;
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
            .from_buffered(self.open(path)?)
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
}

fn is_transparent(image: &DynamicImage) -> bool {
    match image {
        DynamicImage::ImageRgba8(image) => image.pixels().any(|pixel| pixel.0[3] < u8::MAX),
        DynamicImage::ImageLumaA8(image) => image.pixels().any(|pixel| pixel.0[1] < u8::MAX),
        DynamicImage::ImageRgba16(image) => image.pixels().any(|pixel| pixel.0[3] < u16::MAX),
        DynamicImage::ImageLumaA16(image) => image.pixels().any(|pixel| pixel.0[1] < u16::MAX),
        DynamicImage::ImageRgba32F(image) => image.pixels().any(|pixel| pixel.0[3] < 1.0),
        _ => false,
    }
}

fn is_linear_file(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| extension == "exr" || extension == "hdr")
}
