//! The numbers that kernels count in: here f64. See `src/real.rs`, which has the same names in f32.

// Tables of f64 and u32 have gaps and are no plain bytes, nor need they be where no GPU reads them.
pub use glam::{DVec2 as Vec2, DVec3 as Vec3, DVec4 as Vec4};
pub use std::default::Default as Plain;
pub use std::f64::consts;
pub use wide::{f64x4 as Reals, u64x4 as Words};

/// A number of the kernels.
pub type Real = f64;
/// As many bits as a [`Real`] has.
pub type Bits = u64;
/// Twice as many bits.
pub type WideBits = u128;

/// The engine's name.
pub const ENGINE: &str = "CPU in f64";
/// The exponent's bits.
pub const EXPONENT: Bits = 0x7ff0_0000_0000_0000;
/// The bits of the leading half of the mantissa and all above: products of two such numbers are
/// exact.
pub const LEADING: Bits = 0xffff_ffff_f800_0000;

/// An f64 rounding over an f32 rounding: 2^-29.
const FINER: Real = 1.0 / 536_870_912.0;

/// A tolerance of some roundings, written as it is in f32 and in WGSL, for this precision.
pub const fn roundings(single: Real) -> Real {
    single * FINER
}

/// The same for a tolerance that goes with the square root of a rounding.
pub const fn root_roundings(single: Real) -> Real {
    // sqrt(2^-29)
    single * 4.315_837_287_515_549e-5
}

/// Rounds what the host computed to the numbers of the kernels.
pub trait ToReal {
    /// The kernels' vector.
    type Vector;
    /// Nearest vector.
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

/// The kernels' numbers as the host computes.
pub trait ToDouble {
    /// The host's vector.
    type Vector;
    /// The same vector.
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
