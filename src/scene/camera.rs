//! The camera.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

/// A camera: viewpoint, projection and lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the lens; for an orthographic camera the centre of the plane that rays start from.
    pub position: DVec3,
    /// A point on the view axis, different from `position`.
    pub target: DVec3,
    /// Up direction of the image; not parallel to the view axis, not necessarily perpendicular or
    /// unit.
    pub up: DVec3,
    /// Map from directions or positions to the image.
    pub projection: Projection,
    /// Shift of the image's window to the right and upward, in image widths and heights; [0, 0] for
    /// panorama and fisheye.
    pub shift: [f64; 2],
    /// Lens radius in scene units, >= 0; 0 for panorama and fisheye.
    pub aperture: f64,
    /// Distance of the plane of focus along the view axis in scene units, > 0; scene files default
    /// to `|target - position|`.
    pub focus: f64,
}

/// Map from directions or positions to the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Central projection onto a plane.
    Perspective {
        /// Field of view in degrees, in (0, 180).
        fov_degrees: f64,
        /// Axis of the field of view.
        axis: Axis,
    },
    /// Parallel projection along the view axis.
    Orthographic {
        /// Size of the image in scene units, > 0.
        size: f64,
        /// Axis of the size.
        axis: Axis,
    },
    /// All directions in an equirectangular image: longitude to the right, latitude upward.
    Panorama,
    /// Directions at equal angles from the view axis at equal distances from the image's centre
    /// (equidistant fisheye). The image is black outside the circle of the field of view.
    Fisheye {
        /// Field of view in degrees, in (0, 360].
        fov_degrees: f64,
        /// Axis of the field of view.
        axis: Axis,
    },
}

/// Axis of the image that a field of view or a size refers to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Image height.
    #[default]
    Vertical,
    /// Image width.
    Horizontal,
    /// Image diagonal.
    Diagonal,
    /// The shorter of height and width.
    Smaller,
    /// The longer of height and width.
    Larger,
}

impl Axis {
    /// Image height over the length along this axis, for an image of `width` by `height` pixels.
    pub fn height_share(self, width: f64, height: f64) -> f64 {
        match self {
            Self::Vertical => 1.0,
            Self::Horizontal => height / width,
            Self::Diagonal => height / width.hypot(height),
            Self::Smaller => height / width.min(height),
            Self::Larger => height / width.max(height),
        }
    }

    /// Length along this axis of a full-frame sensor (36 by 24), in millimetres.
    pub fn full_frame(self) -> f64 {
        match self {
            Self::Vertical | Self::Smaller => 24.0,
            Self::Horizontal | Self::Larger => 36.0,
            Self::Diagonal => 36f64.hypot(24.0),
        }
    }
}

impl Camera {
    /// A pinhole camera at `position` that looks at `target`, with +y up and a vertical field of
    /// view in degrees.
    pub fn look_at(position: DVec3, target: DVec3, fov_degrees: f64) -> Self {
        Self {
            position,
            target,
            up: DVec3::Y,
            projection: Projection::Perspective { fov_degrees, axis: Axis::Vertical },
            shift: [0.0; 2],
            aperture: 0.0,
            focus: position.distance(target),
        }
    }

    /// Half the height of an image of `width` by `height` pixels: at distance one for a perspective
    /// camera, in scene units for an orthographic one, in radians for panorama and fisheye.
    pub fn half_height(&self, width: u32, height: u32) -> f64 {
        let share = |axis: Axis| axis.height_share(f64::from(width), f64::from(height));
        match self.projection {
            Projection::Perspective { fov_degrees, axis } => {
                (0.5 * fov_degrees.to_radians()).tan() * share(axis)
            }
            Projection::Orthographic { size, axis } => 0.5 * size * share(axis),
            Projection::Panorama => FRAC_PI_2,
            Projection::Fisheye { fov_degrees, axis } => {
                0.5 * fov_degrees.to_radians() * share(axis)
            }
        }
    }

    /// Half the width of the image, likewise.
    pub fn half_width(&self, width: u32, height: u32) -> f64 {
        match self.projection {
            Projection::Panorama => PI,
            Projection::Perspective { .. }
            | Projection::Orthographic { .. }
            | Projection::Fisheye { .. } => {
                self.half_height(width, height) * f64::from(width) / f64::from(height)
            }
        }
    }

    /// Height of a pixel's footprint on a surface at this distance, in scene units.
    pub fn footprint(&self, distance: f64, width: u32, height: u32) -> f64 {
        let pixel = 2.0 * self.half_height(width, height) / f64::from(height);
        match self.projection {
            Projection::Orthographic { .. } => pixel,
            Projection::Perspective { .. } | Projection::Panorama | Projection::Fisheye { .. } => {
                pixel * distance
            }
        }
    }

    /// Returns whether the camera has a lens, which can blur what is out of focus.
    pub fn has_lens(&self) -> bool {
        match self.projection {
            Projection::Perspective { .. } | Projection::Orthographic { .. } => true,
            Projection::Panorama | Projection::Fisheye { .. } => false,
        }
    }
}
