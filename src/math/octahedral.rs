//! Packed directions in records. Twin: `shaders/math/octahedral.wgsl`.

use super::unit;
use glam::{Vec2, Vec3};

/// Encoded unit vector in a record.
pub type Direction = u32;

/// Encodes a unit vector in 32 bits: octahedral map, 16 bits per coordinate (Cigolle et al. 2014).
pub fn oct_encode(v: Vec3) -> Direction {
    let s = 1.0 / (v.x.abs() + v.y.abs() + v.z.abs());
    let p = Vec2::new(v.x * s, v.y * s);
    let mut q = p;
    if v.z < 0.0 {
        q.x = (1.0 - p.y.abs()) * if p.x >= 0.0 { 1.0 } else { -1.0 };
        q.y = (1.0 - p.x.abs()) * if p.y >= 0.0 { 1.0 } else { -1.0 };
    }
    let x = (q.x * 32767.0 + 32768.5).floor() as u32;
    let y = (q.y * 32767.0 + 32768.5).floor() as u32;
    x | y << 16
}

/// Decodes a unit vector; inverse of [`oct_encode`].
pub fn oct_decode(code: Direction) -> Vec3 {
    unit(oct_vector(code))
}

/// Decodes the direction of [`oct_decode`] without normalizing it.
#[inline]
pub fn oct_vector(code: Direction) -> Vec3 {
    let x = ((code & 0xffff) as f32 - 32768.0) * (1.0 / 32767.0);
    let y = ((code >> 16) as f32 - 32768.0) * (1.0 / 32767.0);
    let mut v = Vec3::new(x, y, 1.0 - x.abs() - y.abs());
    if v.z < 0.0 {
        v.x = (1.0 - y.abs()) * if x >= 0.0 { 1.0 } else { -1.0 };
        v.y = (1.0 - x.abs()) * if y >= 0.0 { 1.0 } else { -1.0 };
    }
    v
}
