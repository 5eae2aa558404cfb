//! Decoding of image files: png and jpg (8 or 16 bits), hdr and exr, identified by content.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use exr::meta::MetaData;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::fault::{ImageFault, fault, refused};
use super::format::{Format, HEAD, jpeg_fault, with_radiance_line};
use super::store::ImageStore;
use super::{ColorSpace, exr_image};
use crate::math::srgb::linear_from_srgb;
use crate::scene::appearance::{ImageData, Texels};
use crate::scene::limits::{Allowance, within};

/// Image data, whether alpha is below 1 anywhere, and the names of ignored channels.
type Loaded = (ImageData, bool, Vec<String>);

/// Bytes that a decoder may allocate in addition to the pixels.
const DECODER_BYTES: u64 = 64 << 20;

impl ImageStore {
    /// Reads and decodes a file.
    pub(super) fn read(
        &mut self,
        path: &Path,
        space: Option<ColorSpace>,
    ) -> Result<Loaded, ImageFault> {
        let mut file = self.open(path)?;
        let mut head = Vec::new();
        file.by_ref()
            .take(HEAD as u64)
            .read_to_end(&mut head)
            .map_err(|error| fault(path, error))?;
        file.rewind().map_err(|error| fault(path, error))?;
        let format = Format::of(&head).map_err(|other| fault(path, other))?;
        if space == Some(ColorSpace::Srgb) && format.is_linear() {
            return Err(ImageFault {
                key: "color_space",
                message: format!("{} contains linear values", path.display()),
                expected: "expected \"linear\", or nothing",
                help: None,
                missing: false,
            });
        }
        match format {
            Format::Exr => self.read_exr(path, file),
            Format::Hdr => {
                let file = with_radiance_line(file).map_err(|error| fault(path, error))?;
                let decoder = HdrDecoder::new(file).map_err(|error| fault(path, error))?;
                self.decode(path, decoder, space)
            }
            Format::Jpeg => {
                if let Some(why) = jpeg_fault(&mut file) {
                    let help = "save it again with one scan, or as PNG".to_owned();
                    return Err(ImageFault { help: Some(help), ..fault(path, why) });
                }
                file.rewind().map_err(|error| fault(path, error))?;
                self.read_common(path, file, ImageFormat::Jpeg, space)
            }
            Format::Png => self.read_common(path, file, ImageFormat::Png, space),
        }
    }

    fn open(&self, path: &Path) -> Result<BufReader<File>, ImageFault> {
        let most = ("texture-bytes", self.allowance.texture_bytes);
        let file = self.allowance.open(path, most).map_err(|refusal| refused(path, refusal))?;
        Ok(BufReader::new(file))
    }

    /// Charges an image to the limits before its pixels are decoded.
    fn spend(&mut self, path: &Path, pixels: u64, bytes_each: u64) -> Result<(), ImageFault> {
        let Allowance { texture_pixels, texture_bytes, .. } = self.allowance;
        let bytes = pixels.saturating_mul(bytes_each);
        within("texture-pixels", "pixels", pixels, texture_pixels)
            .and_then(|()| {
                within("texture-bytes", "bytes of texels", bytes, texture_bytes - self.spent)
            })
            .map_err(|refusal| refused(path, refusal))?;
        self.spent += bytes;
        Ok(())
    }

    fn read_common(
        &mut self,
        path: &Path,
        file: BufReader<File>,
        format: ImageFormat,
        space: Option<ColorSpace>,
    ) -> Result<Loaded, ImageFault> {
        let mut reader = ImageReader::with_format(file, format);
        let mut limits = Limits::no_limits();
        // Memory of the decoder in addition to the pixels, which `spend` counts.
        limits.max_alloc = Some(self.allowance.texture_bytes.saturating_add(DECODER_BYTES));
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(|error| fault(path, error))?;
        self.decode(path, decoder, space)
    }

    fn decode(
        &mut self,
        path: &Path,
        decoder: impl ImageDecoder,
        space: Option<ColorSpace>,
    ) -> Result<Loaded, ImageFault> {
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
                Texels::Float(
                    image.into_rgb16().pixels().map(|pixel| pixel.0.map(decode)).collect(),
                )
            }
            _ => Texels::Rgba8 {
                srgb,
                data: image.into_rgba8().pixels().map(|pixel| pixel.0).collect(),
            },
        };
        Ok((
            ImageData { path: path.display().to_string(), width, height, texels },
            transparent,
            Vec::new(),
        ))
    }

    fn read_exr(&mut self, path: &Path, mut file: BufReader<File>) -> Result<Loaded, ImageFault> {
        let meta =
            MetaData::read_from_buffered(&mut file, false).map_err(|error| fault(path, error))?;
        let pixels = meta.headers.iter().map(|header| header.layer_size.area() as u64);
        self.spend(path, pixels.max().unwrap_or(0), 12)?;
        let chosen = exr_image::choose(&meta).map_err(|why| fault(path, why))?;
        let unread = chosen.unread.clone();
        let picture = exr_image::read(file, &meta, chosen).map_err(|error| fault(path, error))?;
        let data = ImageData {
            path: path.display().to_string(),
            width: picture.width as u32,
            height: picture.height as u32,
            texels: Texels::Float(picture.texels),
        };
        Ok((data, picture.transparent, unread))
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
