//! Lights: choice, shadow-ray samples and photon emission. Twins: `shaders/lights/`.
//!
//! A light is one file pair, with `light_from_X` for shadow rays and `emit_X` for photons, a
//! variant of [`LightKind`], and a case in each dispatch: `light.rs` and `emission.rs` with their
//! twins. The compiler finds the Rust ones that are missing.

use super::{materials, math, real, shapes, tables};

pub mod aim;
pub mod area;
pub mod emission;
pub mod environment;
pub mod guide;
pub mod image;
pub mod infinity;
pub mod light;
pub mod point;
pub mod select;
pub mod shape;
pub mod spot;
pub mod sun;
pub mod sun_disc;

/// Kind of a light, stored as a number in [`Light::kind`](tables::Light::kind).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum LightKind {
    /// Emitting shape.
    Area,
    /// Point with the same intensity in all directions.
    Point,
    /// Point that emits into a cone.
    Spot,
    /// Parallel light.
    Sun,
    /// Sun with an angular size.
    SunDisc,
    /// Constant environment.
    Constant,
    /// Environment image.
    Image,
}

impl LightKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Area,
        Self::Point,
        Self::Spot,
        Self::Sun,
        Self::SunDisc,
        Self::Constant,
        Self::Image,
    ];

    /// Kind with the number `kind`.
    #[inline(always)]
    pub const fn of(kind: u32) -> Self {
        let mut i = 0;
        while i + 1 < Self::ALL.len() {
            if Self::ALL[i] as u32 == kind {
                return Self::ALL[i];
            }
            i += 1;
        }
        Self::Image
    }

    /// Name in shader constants.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Area => "AREA",
            Self::Point => "POINT",
            Self::Spot => "SPOT",
            Self::Sun => "SUN",
            Self::SunDisc => "SUN_DISC",
            Self::Constant => "CONSTANT",
            Self::Image => "IMAGE",
        }
    }

    /// Returns true if the light comes from infinity.
    #[inline(always)]
    pub const fn is_infinite(self) -> bool {
        match self {
            Self::Area | Self::Point | Self::Spot => false,
            Self::Sun | Self::SunDisc | Self::Constant | Self::Image => true,
        }
    }

    /// Returns true if scattered rays can find the light.
    #[inline(always)]
    pub const fn is_extended(self) -> bool {
        match self {
            Self::Area | Self::SunDisc | Self::Constant | Self::Image => true,
            Self::Point | Self::Spot | Self::Sun => false,
        }
    }

    /// Returns true if the light is the environment, which rays that leave the scene find.
    #[inline(always)]
    pub const fn is_environment(self) -> bool {
        match self {
            Self::Area | Self::Point | Self::Spot | Self::Sun | Self::SunDisc => false,
            Self::Constant | Self::Image => true,
        }
    }
}
