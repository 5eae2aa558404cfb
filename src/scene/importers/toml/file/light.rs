//! Lights and the environment.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::numbers::{Share, Spectrum, Strength};
use super::{RotateFile, Vec3};

/// A light without a surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum LightFile {
    /// A point light with the same intensity in all directions.
    Point {
        /// Position in world space.
        position: Vec3,
        /// Radiant intensity in W/sr.
        intensity: Spectrum<Strength>,
    },
    /// A spot light that shines into a cone.
    Spot {
        /// Apex of the cone.
        position: Vec3,
        /// A point on the cone's axis.
        target: Vec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Spectrum<Strength>,
        /// Angle in degrees from the axis to the edge of the cone, where the light is zero; at most
        /// 180.
        #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
        angle: f64,
        /// Fraction of the angle over which the light fades.
        #[serde(default)]
        blend: Share,
    },
    /// Light from infinitely far away: parallel, or from a disc that the camera sees.
    Sun {
        /// Direction in which the light travels; any length but 0.
        direction: Vec3,
        /// Irradiance on a surface facing the sun, in W/m^2.
        irradiance: Spectrum<Strength>,
        /// Diameter of the sun's disc in degrees, from 0.001 to 180, such as 0.53; 0 for parallel
        /// light, which no camera sees.
        #[serde(default)]
        #[schemars(range(min = 0, max = 180))]
        angle: f64,
    },
}

/// Rotation of a sky.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum SkyRotation {
    /// Degrees about +y by the right-hand rule.
    Degrees(f64),
    /// Rotation about any axis.
    About(RotateFile),
    /// Rows of a matrix that turns directions of the image into directions of the scene.
    Matrix([Vec3; 3]),
}

/// A constant radiance from all directions, or an image.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// Radiance in W sr^-1 m^-2; with a file, a factor on its values.
    pub radiance: Option<Spectrum<Strength>>,
    /// An equirectangular image: exr, hdr, png or jpg.
    pub file: Option<String>,
    /// Rotation of the image: degrees about +y by the right-hand rule, { axis, degrees }, or the
    /// rows of a rotation matrix.
    pub rotate: Option<SkyRotation>,
}
