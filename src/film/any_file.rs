//! Image files of either coding: radiance, or 8- or 16-bit display values.

use std::path::Path;

use image::{DynamicImage, ImageFormat};

use super::file::{Format, decode_common, read, read_bytes, read_exr};
use super::{FileError, Picture};
use crate::math::srgb::linear_from_srgb;

/// Coding of the values in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    /// Linear light without an upper bound: .exr, .pfm, .hdr.
    Radiance,
    /// Display values, encoded with the sRGB curve: .png, .jpg.
    Display,
}

/// Reads an image as linear light. Display values are decoded with the inverse sRGB curve to
/// [0, 1]; a tone map that produced them is not inverted.
///
/// # Errors
/// The errors of [`read`], and [`FileError::Transparent`] if a pixel is not opaque.
pub fn read_any(file: &Path) -> Result<(Picture, Coding), FileError> {
    let extension =
        file.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    match (Format::of(file), extension.as_deref()) {
        (Some(Format::Exr), _) => Ok((read_opaque_exr(file)?, Coding::Radiance)),
        (Some(Format::Pfm | Format::Hdr), _) => Ok((read(file)?, Coding::Radiance)),
        (Some(Format::Png), _) => Ok((read_display(file, ImageFormat::Png)?, Coding::Display)),
        (None, Some("jpg" | "jpeg")) => {
            Ok((read_display(file, ImageFormat::Jpeg)?, Coding::Display))
        }
        (None, _) => Err(FileError::UnknownFormat {
            file: file.to_owned(),
            what: "unsupported input image extension".to_owned(),
            known: ".exr, .pfm, .hdr, .png or .jpg",
        }),
    }
}

fn read_opaque_exr(file: &Path) -> Result<Picture, FileError> {
    let exr = read_exr(file)?;
    let picture = exr.picture("").ok_or_else(|| FileError::Malformed {
        file: file.to_owned(),
        what: "channels R, G and B are missing".to_owned(),
    })?;
    match exr.channels.get("A") {
        Some(alpha) => check_opaque(file, &picture, alpha.iter().map(|alpha| *alpha == 1.0)),
        None => Ok(()),
    }?;
    Ok(picture)
}

fn read_display(file: &Path, format: ImageFormat) -> Result<Picture, FileError> {
    let image = decode_common(&read_bytes(file)?, format)
        .map_err(|what| FileError::Malformed { file: file.to_owned(), what })?;
    // Widening 8 bits to 16 is lossless: 65535 = 255 * 257.
    let opaque = match image.color().has_alpha() {
        true => {
            Some(image.to_rgba16().pixels().map(|pixel| pixel.0[3] == u16::MAX).collect::<Vec<_>>())
        }
        false => None,
    };
    let picture = decoded(&image);
    check_opaque(file, &picture, opaque.into_iter().flatten())?;
    Ok(picture)
}

fn decoded(image: &DynamicImage) -> Picture {
    let pixels = image.to_rgb16();
    let linear = |value: u16| linear_from_srgb(f64::from(value) / f64::from(u16::MAX)) as f32;
    Picture::from_fn(pixels.width(), pixels.height(), |x, y| pixels.get_pixel(x, y).0.map(linear))
}

fn check_opaque(
    file: &Path,
    picture: &Picture,
    opaque: impl Iterator<Item = bool>,
) -> Result<(), FileError> {
    let mut others = opaque.enumerate().filter(|(_, opaque)| !opaque).map(|(index, _)| index);
    match others.next() {
        Some(first) => Err(FileError::Transparent {
            file: file.to_owned(),
            pixels: 1 + others.count(),
            at: picture.position(first),
        }),
        None => Ok(()),
    }
}
