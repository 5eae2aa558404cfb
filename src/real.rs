//! The numbers that kernels count in: here f32, as on a GPU.
//!
//! The modules that name [`Real`] by `super::real` are compiled a second time below
//! [`crate::double`], where `super::real` is `double/real.rs`: the same kernels in f64, which
//! measure what f32 costs.

use glam::{DVec2, DVec3};

pub use bytemuck::Pod as Plain;
pub use glam::{Vec2, Vec3, Vec4};
pub use std::f32::consts;
pub use wide::{f32x4 as Reals, u32x4 as Words};

/// A number of the kernels.
pub type Real = f32;
/// As many bits as a [`Real`] has.
pub type Bits = u32;
/// Twice as many bits.
pub type WideBits = u64;

/// The engine's name.
pub const ENGINE: &str = "CPU";
/// The exponent's bits.
pub const EXPONENT: Bits = 0x7f80_0000;
/// The bits of the leading half of the mantissa and all above: products of two such numbers are
/// exact.
pub const LEADING: Bits = 0xffff_f000;

/// A tolerance of some roundings, written as it is in f32 and in WGSL, for this precision.
pub const fn roundings(single: Real) -> Real {
    single
}

/// The same for a tolerance that goes with the square root of a rounding.
pub const fn root_roundings(single: Real) -> Real {
    single
}

/// Rounds what the host computed to the numbers of the kernels.
pub trait ToReal {
    /// The kernels' vector.
    type Vector;
    /// Nearest vector.
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

/// The kernels' numbers as the host computes.
pub trait ToDouble {
    /// The host's vector.
    type Vector;
    /// The same vector.
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
