//! The film: image size, tone mapping and extra channels.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Aovs;

/// Image size, tone mapping and extra channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Image width in pixels, >= 1.
    pub width: u32,
    /// Image height in pixels, >= 1.
    pub height: u32,
    /// Exposure of tone-mapped outputs in stops (powers of two).
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// Channels of EXR files in addition to radiance.
    pub aovs: Aovs,
    /// Crop window `[x0, y0, x1, y1]`: columns x0 to x1 and rows y0 to y1, with x1 and y1
    /// exclusive; inside the image and not empty. `None` renders the whole image.
    pub window: Option<[u32; 4]>,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            exposure: 0.0,
            tonemap: ToneMap::default(),
            aovs: Aovs::default(),
            window: None,
        }
    }
}

/// Conversion of radiance to display values in 8-bit files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneMap {
    /// AgX: a filmic curve that preserves the hues of bright lights.
    #[default]
    Agx,
    /// Clipped to [0, 1], then sRGB-encoded.
    Srgb,
}
