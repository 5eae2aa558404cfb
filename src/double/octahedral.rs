//! Directions in records in f64, stored without packing. The f32 version, `src/math/octahedral.rs`,
//! packs them.

use super::super::real::Vec3;

/// Unit vector in a record.
pub type Direction = Vec3;

/// Encodes a unit vector: returns it unchanged.
pub fn oct_encode(v: Vec3) -> Direction {
    v
}

/// Decodes a unit vector: returns it unchanged.
pub fn oct_decode(code: Direction) -> Vec3 {
    code
}

/// Decodes the direction of [`oct_decode`] without normalizing it.
pub fn oct_vector(code: Direction) -> Vec3 {
    code
}
