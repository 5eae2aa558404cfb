//! Number types of the kernels: here f64. See `src/real.rs`, which has the same names in f32.

// tables of f64 and u32 have gaps, so they are not plain bytes; no GPU reads them
pub use glam::{DVec2 as Vec2, DVec3 as Vec3, DVec4 as Vec4};
pub use std::default::Default as Plain;
pub use std::f64::consts;
pub use wide::{f64x4 as Reals, u64x4 as Words};

/// Floating-point type of the kernels.
pub type Real = f64;
/// Unsigned integer as wide as a [`Real`].
pub type Bits = u64;
/// Unsigned integer twice as wide as a [`Real`].
pub type WideBits = u128;

/// Name of the engine.
pub const ENGINE: &str = "CPU in f64";
/// Mask of the exponent bits.
pub const EXPONENT: Bits = 0x7ff0_0000_0000_0000;
/// Mask that clears the low half of the mantissa: products of two such numbers are exact.
pub const LEADING: Bits = 0xffff_ffff_f800_0000;

/// Ratio of an f64 rounding to an f32 rounding: 2^-29.
const FINER: Real = 1.0 / 536_870_912.0;

/// Converts a tolerance of a few roundings, given for f32 as in WGSL, to this precision.
pub const fn roundings(single: Real) -> Real {
    single * FINER
}

/// Converts a tolerance that scales with the square root of a rounding, likewise.
pub const fn root_roundings(single: Real) -> Real {
    // sqrt(2^-29)
    single * 4.315_837_287_515_549e-5
}

/// Converts host vectors to the kernels' precision.
pub trait ToReal {
    /// Vector type of the kernels.
    type Vector;
    /// Rounds to the nearest vector; exact in f64.
    fn to_real(self) -> Self::Vector;
}

impl ToReal for Vec2 {
    type Vector = Vec2;
    fn to_real(self) -> Vec2 {
        self
    }
}

impl ToReal for Vec3 {
    type Vector = Vec3;
    fn to_real(self) -> Vec3 {
        self
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
    type Vector = Vec2;
    fn to_double(self) -> Vec2 {
        self
    }
}

impl ToDouble for Vec3 {
    type Vector = Vec3;
    fn to_double(self) -> Vec3 {
        self
    }
}
