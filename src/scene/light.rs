//! Lights without a surface, and the environment.

use glam::{DMat3, DVec3};

use super::Rgb;

/// A light without a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point light with the same intensity in all directions.
    Point {
        /// Position in world space.
        position: DVec3,
        /// Radiant intensity in W/sr.
        intensity: Rgb,
    },
    /// A spot light that shines into a cone.
    Spot {
        /// Apex of the cone.
        position: DVec3,
        /// A point on the cone's axis, different from `position`.
        target: DVec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Rgb,
        /// Angle in degrees between the axis and the edge of the cone, in (0, 180].
        angle_degrees: f64,
        /// Fraction of `angle_degrees` over which the light fades, in [0, 1]: full up to
        /// `(1 - blend) angle`, then a smoothstep in the angle's cosine down to zero at `angle`.
        blend: f64,
    },
    /// Light from infinitely far away: parallel, or from a disc of even radiance.
    Sun {
        /// Unit vector in which the light travels.
        direction: DVec3,
        /// Irradiance on a surface facing the sun in W/m^2.
        irradiance: Rgb,
        /// Diameter of the disc in degrees, at most 180; 0 for parallel light, which is invisible.
        angle_degrees: f64,
    },
}

/// Radiance from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Environment {
    /// The same radiance from all directions.
    Constant {
        /// Radiance in W sr^-1 m^-2.
        radiance: Rgb,
    },
    /// An equirectangular image; row 0 is the zenith (+y). A direction `d`, turned back by `tilt`
    /// and then about y, reads it at `u = 0.5 - atan2(d.z, d.x) / 2pi`, `v = 1 - acos(d.y) / pi`.
    Image {
        /// Index into [`super::Scene::images`].
        image: usize,
        /// Rotation of the image about +y in degrees, by the right-hand rule.
        rotate_degrees: f64,
        /// Rotation that follows the one about y (orthonormal, determinant one); `None` for none.
        tilt: Option<DMat3>,
        /// Radiance in W sr^-1 m^-2 of a texel value of one, per channel.
        scale: Rgb,
    },
}
