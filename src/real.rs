//! Number types of the kernels: here f32, as on a GPU.
//!
//! The modules that refer to [`Real`] by `super::real` are compiled a second time below
//! [`crate::double`], where `super::real` is `double/real.rs`: the same kernels in f64, to measure
//! the error of f32.

use glam::{DVec2, DVec3};

pub use bytemuck::Pod as Plain;
pub use glam::{Vec2, Vec3, Vec4};
pub use std::f32::consts;
pub use wide::{f32x4 as Reals, u32x4 as Words};

/// Floating-point type of the kernels.
pub type Real = f32;
/// Unsigned integer as wide as a [`Real`].
pub type Bits = u32;
/// Unsigned integer twice as wide as a [`Real`].
pub type WideBits = u64;

/// Name of the engine.
pub const ENGINE: &str = "CPU";
/// Mask of the exponent bits.
pub const EXPONENT: Bits = 0x7f80_0000;
/// Mask that clears the low half of the mantissa: products of two such numbers are exact.
pub const LEADING: Bits = 0xffff_f000;

/// Converts a tolerance of a few roundings, given for f32 as in WGSL, to this precision.
pub const fn roundings(single: Real) -> Real {
    single
}

/// Converts a tolerance that scales with the square root of a rounding, likewise.
pub const fn root_roundings(single: Real) -> Real {
    single
}

/// Converts host vectors to the kernels' precision.
pub trait ToReal {
    /// Vector type of the kernels.
    type Vector;
    /// Rounds to the nearest vector.
    fn to_real(self) -> Self::Vector;
}

impl ToReal for DVec2 {
    type Vector = Vec2;
    fn to_real(self) -> Vec2 {
        self.as_vec2()
    }
}

impl ToReal for DVec3 {
    type Vector = Vec3;
    fn to_real(self) -> Vec3 {
        self.as_vec3()
    }
}

/// Converts the kernels' vectors to the host's f64.
pub trait ToDouble {
    /// Vector type of the host.
    type Vector;
    /// Converts exactly.
    fn to_double(self) -> Self::Vector;
}

impl ToDouble for Vec2 {
    type Vector = DVec2;
    fn to_double(self) -> DVec2 {
        self.as_dvec2()
    }
}

impl ToDouble for Vec3 {
    type Vector = DVec3;
    fn to_double(self) -> DVec3 {
        self.as_dvec3()
    }
}
