//! Image files: png and jpg (8 or 16 bits), hdr and exr, identified by content.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use exr::meta::MetaData;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::appearance::{ImageData, Texels};
use super::exr_image;
use super::file::ColorSpace;
use super::image_bytes::{Format, HEAD, jpeg_fault, with_radiance_line};
use super::limits::{Allowance, Missing, Refusal, within};
use crate::math::srgb::linear_from_srgb;

/// Reason why an image cannot be used; `key` is the scene file key that the error points to.
pub(crate) struct ImageFault {
    pub key: &'static str,
    pub message: String,
    pub expected: &'static str,
    pub help: Option<String>,
    /// True if the file does not exist.
    pub missing: bool,
}

/// A warning about an image, and the interpretation of the affected values.
pub(crate) type Note = (String, &'static str);

/// Image data, whether alpha is below 1 anywhere, and the names of ignored channels.
type Loaded = (ImageData, bool, Vec<String>);

/// Images read so far, one for each (file, color space).
#[derive(Debug, Default)]
pub(crate) struct ImageStore {
    pub images: Vec<ImageData>,
    /// Every file requested.
    pub files: Vec<PathBuf>,
    known: BTreeMap<(PathBuf, Option<ColorSpace>), usize>,
    transparent: BTreeSet<usize>,
    /// Texels clamped into their range, by image.
    moved: BTreeMap<usize, Moved>,
    /// Warnings about ignored channels, by image.
    unread: BTreeMap<usize, String>,
    stand_ins: BTreeMap<PathBuf, usize>,
    allowance: Allowance,
    /// Bytes of texels of all images, including those that could not be used.
    spent: u64,
}

impl ImageStore {
    pub fn new(allowance: &Allowance) -> Self {
        Self { allowance: allowance.clone(), ..Self::default() }
    }

    /// Index of the image in a file; reads the file on first use.
    pub fn load(&mut self, path: &Path, space: Option<ColorSpace>) -> Result<usize, ImageFault> {
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if let Some(&index) = self.known.get(&(canonical.clone(), space)) {
            return Ok(index);
        }
        self.files.push(path.to_owned());
        let (mut image, transparent, unread) = self.read(path, space)?;
        let index = self.images.len();
        let mut moved = Moved::default();
        bound(&mut image, f32::MAX, &mut moved).map_err(|bad| fault(path, bad))?;
        self.moved.insert(index, moved);
        if !unread.is_empty() {
            let message = format!("the channels {} are not used", unread.join(", "));
            self.unread.insert(index, message);
        }
        self.images.push(image);
        self.known.insert((canonical, space), index);
        if transparent {
            self.transparent.insert(index);
        }
        Ok(index)
    }

    /// Clamps texels that exceed 1 by a rounding error.
    ///
    /// # Errors
    /// A texel that exceeds 1 by more.
    pub fn bound_by_one(&mut self, path: &Path, index: usize) -> Result<(), ImageFault> {
        let moved = self.moved.entry(index).or_default();
        bound(&mut self.images[index], 1.0, moved).map_err(|bad| fault(path, bad))
    }

    /// Warnings about an image that is not used as it is; returns each once.
    pub fn take_notes(&mut self, index: usize) -> Vec<Note> {
        let moved = self.moved.remove(&index).and_then(|moved| moved.said());
        let moved = moved.map(|message| (message, "read as the limit"));
        let unread = self.unread.remove(&index).map(|message| (message, "read in gray"));
        let notes = moved.into_iter().chain(unread);
        notes
            .map(|(message, label)| (format!("{}: {message}", self.images[index].path), label))
            .collect()
    }

    /// An image of one gray texel that replaces a file that does not exist.
    pub fn stand_in(&mut self, path: &Path) -> usize {
        let images = &mut self.images;
        *self.stand_ins.entry(path.to_owned()).or_insert_with(|| {
            let texels = Texels::Float(vec![[Missing::STAND_IN as f32; 3]]);
            images.push(ImageData {
                path: path.display().to_string(),
                width: 1,
                height: 1,
                texels,
            });
            images.len() - 1
        })
    }

    /// Returns whether an image has alpha below 1 anywhere.
    pub fn is_transparent(&self, index: usize) -> bool {
        self.transparent.contains(&index)
    }
}

/// Bytes that a decoder may allocate in addition to the pixels.
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

/// Largest excess of a texel over its range that counts as rounding: one step of 16-bit floats
/// above 1.
const ROUNDING: f32 = 1.0 / 1024.0;

/// Texels of an image that were clamped into their range.
#[derive(Clone, Debug, Default)]
struct Moved {
    count: usize,
    worst: f32,
    /// The worst value and its position.
    what: String,
}

impl Moved {
    fn said(&self) -> Option<String> {
        let Self { count, what, .. } = self;
        let noun = if *count == 1 { "value" } else { "values" };
        (*count > 0)
            .then(|| format!("{count} {noun} out of range by rounding, the worst is {what}"))
    }
}

/// Clamps texels that are below 0 or above `most` by a rounding error.
///
/// # Errors
/// A texel that is further out of range, or not finite.
fn bound(image: &mut ImageData, most: f32, moved: &mut Moved) -> Result<(), String> {
    let Texels::Float(texels) = &mut image.texels else { return Ok(()) };
    for (index, texel) in texels.iter_mut().enumerate() {
        if texel.iter().all(|value| (0.0..=most).contains(value)) {
            continue;
        }
        let (x, y) = (index % image.width as usize, index / image.width as usize);
        for value in texel {
            let inside = value.clamp(0.0, most);
            let excess = (*value - inside).abs();
            if !value.is_finite() {
                return Err(format!("texel ({x}, {y}) is {value}, not finite"));
            } else if excess > ROUNDING {
                let why = if *value < 0.0 {
                    "negative"
                } else {
                    "above 1; a surface cannot reflect more than it receives"
                };
                return Err(format!("texel ({x}, {y}) is {value}, {why}"));
            } else if excess > 0.0 {
                moved.count += 1;
                if excess > moved.worst {
                    (moved.worst, moved.what) = (excess, format!("{value:?} at texel ({x}, {y})"));
                }
                *value = inside;
            }
        }
    }
    Ok(())
}

impl ImageStore {
    fn read(&mut self, path: &Path, space: Option<ColorSpace>) -> Result<Loaded, ImageFault> {
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
