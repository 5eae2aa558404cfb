//! Image files that scenes name, for every importer: png, jpg, hdr and exr.

mod decode;
mod exr_image;
mod exr_subsampled;
mod fault;
mod format;
mod store;
mod texel_range;

use schemars::JsonSchema;
use serde::Deserialize;

pub(crate) use fault::ImageFault;
pub(crate) use store::ImageStore;

/// One of the channels of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Alpha, proportional to coverage; of png files with 8 bits per channel.
    Alpha,
}

/// Encoding of the values in an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColorSpace {
    /// sRGB-encoded; the default for png and jpg.
    Srgb,
    /// Proportional to light; the default for hdr and exr.
    Linear,
}
