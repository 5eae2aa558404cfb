//! Reading and writing of image files. The extension selects the format; writes are atomic (see
//! `storage`).

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, codecs};
use rayon::prelude::*;

use super::exr_file::{self, Channel};
use super::tonemap::Bits;
use super::{Development, FileError, Picture, Provenance, pfm};
use crate::memory;
use crate::storage::{self, Purpose};

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 or 16 bits per channel, tone-mapped.
    Png,
    /// 32-bit float radiance with attributes.
    Exr,
    /// 32-bit float radiance.
    Pfm,
    /// Shared-exponent radiance (RGBE) of the Radiance renderer.
    Hdr,
}

impl Format {
    /// Format of a file by its extension, ignoring case.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            "pfm" => Some(Self::Pfm),
            "hdr" => Some(Self::Hdr),
            _ => None,
        }
    }

    /// Format of an output file, or an error that lists the supported extensions.
    fn of_output(file: &Path) -> Result<Self, FileError> {
        let known = ".png, .exr, .pfm or .hdr";
        Self::of(file).ok_or_else(|| match storage::is_stream(file) {
            true => FileError::StreamName { file: file.to_owned(), known },
            false => FileError::UnknownFormat {
                file: file.to_owned(),
                what: "unsupported output image extension".to_owned(),
                known,
            },
        })
    }
}

/// Checks before rendering that the images can be written afterwards: known extensions, existing
/// and writable folders, and no duplicate names.
pub fn check_outputs(files: &[PathBuf]) -> Result<(), FileError> {
    let mut seen: Vec<&PathBuf> = Vec::new();
    for file in files {
        Format::of_output(file)?;
        check_place(file)?;
        if seen.iter().any(|other| storage::same(other, file)) {
            return Err(FileError::Repeated { file: file.clone() });
        }
        seen.push(file);
    }
    Ok(())
}

/// Checks that a PNG file of this name can be created.
pub fn check_png(file: &Path) -> Result<(), FileError> {
    if Format::of(file) != Some(Format::Png) {
        return Err(FileError::UnknownFormat {
            file: file.to_owned(),
            what: "difference images are PNG files".to_owned(),
            known: ".png",
        });
    }
    check_place(file)
}

/// Writes 8-bit display values, three per pixel, as PNG.
pub fn write_rgb8(file: &Path, width: u32, height: u32, rgb: &[u8]) -> Result<(), FileError> {
    let bytes = encode_rgb8(width, height, rgb)
        .map_err(|what| FileError::Encode { file: file.to_owned(), what })?;
    write_whole(file, &bytes)
}

/// Checks that a file can be created in its folder, without leaving one behind.
pub fn check_place(file: &Path) -> Result<(), FileError> {
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(FileError::NoFolder { file: file.to_owned(), folder: folder.to_owned() });
    }
    if file.is_dir() {
        return Err(FileError::IsFolder { file: file.to_owned() });
    }
    storage::check(file, Purpose::Result).map_err(|e| not_written(file, e))
}

/// Writes an image in the format given by the extension. `development` applies to PNG only,
/// `layers` and `provenance` to EXR only.
pub fn write(
    file: &Path,
    picture: &Picture,
    layers: &[Channel],
    development: &Development,
    provenance: &Provenance,
) -> Result<(), FileError> {
    let bytes = match Format::of_output(file)? {
        Format::Png => encode_png(picture, development),
        Format::Exr => {
            exr_file::encode(picture, provenance.frame(picture), layers, &provenance.attributes())
        }
        Format::Pfm => Ok(pfm::encode(picture)),
        Format::Hdr => encode_hdr(picture),
    };
    let bytes = bytes.map_err(|what| FileError::Encode { file: file.to_owned(), what })?;
    write_whole(file, &bytes)
}

/// Writes the bytes atomically, so that no partial file is ever visible.
pub fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let written = storage::write(file, Purpose::Result, |out| out.write_all(bytes));
    written.map_err(|cause| not_written(file, cause))
}

/// Reads radiance from an EXR (R, G, B of the first layer), PFM or HDR file.
pub fn read(file: &Path) -> Result<Picture, FileError> {
    let malformed = |what| FileError::Malformed { file: file.to_owned(), what };
    match Format::of(file) {
        Some(Format::Exr) => {
            let exr = read_exr(file)?;
            exr.picture("").ok_or_else(|| malformed("channels R, G and B are missing".to_owned()))
        }
        Some(Format::Pfm) => pfm::decode(&read_bytes(file)?).map_err(malformed),
        Some(Format::Hdr) => decode_hdr(&read_bytes(file)?).map_err(malformed),
        Some(Format::Png) | None => Err(FileError::UnknownFormat {
            file: file.to_owned(),
            what: "the extension does not name a format that stores radiance".to_owned(),
            known: ".exr, .pfm or .hdr",
        }),
    }
}

/// Reads all channels and text attributes of an EXR file's first layer.
pub fn read_exr(file: &Path) -> Result<exr_file::ExrFile, FileError> {
    exr_file::decode(&read_bytes(file)?)
        .map_err(|what| FileError::Malformed { file: file.to_owned(), what })
}

pub(super) fn read_bytes(file: &Path) -> Result<Vec<u8>, FileError> {
    storage::read(file, memory::readable()).map_err(|cause| FileError::Io {
        file: file.to_owned(),
        verb: "read",
        cause,
    })
}

fn not_written(file: &Path, cause: std::io::Error) -> FileError {
    FileError::Io { file: file.to_owned(), verb: "written", cause }
}

fn encode_png(picture: &Picture, development: &Development) -> Result<Vec<u8>, String> {
    let Picture { width, height, ref rgb } = *picture;
    match development.bits {
        Bits::Eight => {
            let rgb: Vec<[u8; 3]> =
                rgb.par_iter().map(|&radiance| development.bytes(radiance)).collect();
            encode_rgb8(width, height, rgb.as_flattened())
        }
        Bits::Sixteen => {
            let rgb: Vec<[u16; 3]> =
                rgb.par_iter().map(|&radiance| development.words(radiance)).collect();
            // the encoder expects native-endian samples
            encode_rgb(width, height, bytemuck::cast_slice(&rgb), ExtendedColorType::Rgb16)
        }
    }
}

/// Encodes `width * height * 3` display values as PNG.
fn encode_rgb8(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>, String> {
    encode_rgb(width, height, rgb, ExtendedColorType::Rgb8)
}

fn encode_rgb(
    width: u32,
    height: u32,
    rgb: &[u8],
    color: ExtendedColorType,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    codecs::png::PngEncoder::new(&mut bytes)
        .write_image(rgb, width, height, color)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn encode_hdr(picture: &Picture) -> Result<Vec<u8>, String> {
    // RGBE mantissas are unsigned
    let rgb: Vec<_> =
        picture.rgb.iter().map(|rgb| image::Rgb(rgb.map(|value| value.max(0.0)))).collect();
    let mut bytes = Vec::new();
    codecs::hdr::HdrEncoder::new(&mut bytes)
        .encode(&rgb, picture.width as usize, picture.height as usize)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Decodes a file in a format of the `image` crate. The size is checked before memory for the
/// pixels is allocated.
pub(super) fn decode_common(bytes: &[u8], format: ImageFormat) -> Result<DynamicImage, String> {
    /// Memory that a decoder may allocate in addition to the pixels.
    const DECODER_BYTES: u64 = 64 << 20;
    /// Bytes per pixel of the decoded [`Picture`].
    const PICTURE_BYTES: u64 = 12;
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    let most = memory::readable().saturating_add(DECODER_BYTES);
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(most);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions();
    let each = u64::from(decoder.color_type().bytes_per_pixel()) + PICTURE_BYTES;
    memory::check_pixels(width.into(), height.into(), each)?;
    DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())
}

fn decode_hdr(bytes: &[u8]) -> Result<Picture, String> {
    match decode_common(bytes, ImageFormat::Hdr)? {
        DynamicImage::ImageRgb32F(pixels) => {
            Ok(Picture::from_fn(pixels.width(), pixels.height(), |x, y| pixels.get_pixel(x, y).0))
        }
        other => Err(format!("unexpected pixel type {:?}", other.color())),
    }
}
