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
    /// Filter of the pixels.
    pub filter: PixelFilter,
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
            filter: PixelFilter::default(),
            window: None,
        }
    }
}

/// Reconstruction filter: the weight of the image plane in a pixel by the offset (x, y) from the
/// pixel's centre. Lengths are in pixels; each filter integrates to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelFilter {
    /// Constant where |x| and |y| are at most `radius`.
    Box {
        /// Half the width, > 0.
        radius: f64,
    },
    /// Product of `1 - |x| / radius` and the same of y.
    Tent {
        /// Half the width, > 0.
        radius: f64,
    },
    /// Gaussian, cut off at a circle.
    Gaussian {
        /// Standard deviation along x and along y before the cut, > 0.
        sigma: f64,
        /// Radius of the circle, > 0.
        radius: f64,
    },
    /// Product of two cubic filters with negative lobes that reach two pixels (Mitchell & Netravali
    /// 1988, "Reconstruction Filters in Computer Graphics").
    Mitchell {
        /// Weight of the cubic B-spline, in [0, 1].
        b: f64,
        /// Sharpness, in [0, 1]; with 0, no lobe is negative.
        c: f64,
    },
}

impl Default for PixelFilter {
    /// The pixel itself.
    fn default() -> Self {
        Self::Box { radius: 0.5 }
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
