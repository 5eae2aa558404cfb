//! Camera, film and pixel filter.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::numbers::{NonNegative, Positive, Share};
use super::super::schema::default_to_first;
use super::Vec3;
use crate::scene::numbers::{LARGEST_SHIFT, NARROWEST_FILTER, WIDEST_FILTER};
use crate::scene::{Aov, Axis, ToneMap};

/// A camera; without a type, a perspective one.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(transform = default_to_first)]
pub enum CameraFile {
    /// A thin-lens camera with straight lines.
    Perspective {
        /// Centre of the lens.
        position: Vec3,
        /// A point on the view axis.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Field of view in degrees, between 0 and 180; vertical, unless `fov_axis` names another
        /// axis.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        fov: Option<f64>,
        /// Axis of `fov` or `sensor`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
        /// Focal length in millimetres; replaces `fov`.
        focal_length: Option<Positive>,
        /// Size of the sensor along `fov_axis` in millimetres; that of a full-frame sensor, 36 by
        /// 24, by default.
        sensor: Option<Positive>,
        /// Shift of the lens: the image's window moves to the right and upward by these fractions
        /// of its width and height.
        #[serde(default)]
        shift: Shift,
        /// Lens radius in scene units; 0 is a pinhole.
        #[serde(default)]
        aperture: NonNegative,
        /// Distance from the lens to the plane of focus along the view direction, in scene units;
        /// required if the aperture is not 0.
        focus: Option<Positive>,
    },
    /// A parallel projection.
    Orthographic {
        /// Centre of the plane that rays start from.
        position: Vec3,
        /// A point on the view axis.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Size of the image in scene units; its height, unless `fov_axis` names another axis.
        size: Positive,
        /// Axis of `size`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
        /// The image's window moves to the right and upward by these fractions of its width and
        /// height.
        #[serde(default)]
        shift: Shift,
        /// Radius of the lens about each ray in scene units; 0 is a pinhole.
        #[serde(default)]
        aperture: NonNegative,
        /// Distance to the plane of focus along the view direction, in scene units; required if the
        /// aperture is not 0.
        focus: Option<Positive>,
    },
    /// All directions in an equirectangular image; the target is at its centre.
    Panorama {
        /// Viewpoint.
        position: Vec3,
        /// A point in the direction of the image's centre.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
    },
    /// An equidistant fisheye: distance from the image's centre is proportional to the angle. The
    /// image is black outside the circle of the field of view.
    Fisheye {
        /// Viewpoint.
        position: Vec3,
        /// A point in the direction of the image's centre.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Field of view in degrees, at most 360; vertical, unless `fov_axis` names another axis.
        #[schemars(extend("exclusiveMinimum" = 0), range(max = 360))]
        fov: f64,
        /// Axis of `fov`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
    },
}

/// Fractions of the image's width and height, each from -16 to 16.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Shift(pub [Fraction; 2]);

/// A number from -16 to 16.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = -LARGEST_SHIFT, "maximum" = LARGEST_SHIFT))]
pub struct Fraction(pub f64);

/// A pixel filter by name, with its usual numbers, or as a table.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum FilterFile {
    /// Name of the filter.
    Named(FilterName),
    /// The filter and its numbers.
    Table(FilterTable),
}

/// Name of a pixel filter.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum FilterName {
    /// The pixel itself.
    Box,
    /// A tent that ends at one pixel.
    Tent,
    /// A Gaussian of standard deviation 0.5 that ends at two pixels.
    Gaussian,
    /// The cubic filter with B = C = 1/3.
    Mitchell,
}

/// A pixel filter with its numbers, in pixels.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(inline)]
pub enum FilterTable {
    /// Constant in a square.
    Box {
        /// Half the width in pixels; 0.5 by default.
        radius: Option<FilterSize>,
    },
    /// A tent along x times one along y.
    Tent {
        /// Half the width in pixels; 1 by default.
        radius: Option<FilterSize>,
    },
    /// A Gaussian, cut off at a circle.
    Gaussian {
        /// Standard deviation in pixels; 0.5 by default.
        sigma: Option<FilterSize>,
        /// Radius of the circle in pixels; four standard deviations by default, at most 16.
        radius: Option<FilterSize>,
    },
    /// Cubic with negative lobes (Mitchell & Netravali 1988); two pixels wide on each side.
    Mitchell {
        /// Weight of the cubic B-spline; 1/3 by default.
        b: Option<Share>,
        /// Sharpness; 1/3 by default.
        c: Option<Share>,
    },
}

/// A length in pixels, from 0.05 to 16.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = NARROWEST_FILTER, "maximum" = WIDEST_FILTER))]
pub struct FilterSize(pub f64);

/// Image size, tone mapping and extra channels.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FilmFile {
    /// Image width in pixels.
    #[schemars(range(min = 1, max = 65536))]
    pub width: u32,
    /// Image height in pixels.
    #[schemars(range(min = 1, max = 65536))]
    pub height: u32,
    /// Exposure in stops, for tone-mapped outputs only.
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// Channels of EXR files in addition to radiance.
    pub aov: Vec<Aov>,
    /// Pixel filter; `"box"`, the pixel itself, by default.
    pub filter: FilterFile,
}

impl Default for FilmFile {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            exposure: 0.0,
            tonemap: ToneMap::default(),
            aov: Vec::new(),
            filter: FilterFile::Named(FilterName::Box),
        }
    }
}

fn y_axis() -> Vec3 {
    [0.0, 1.0, 0.0]
}
