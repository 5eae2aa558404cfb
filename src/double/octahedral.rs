//! Directions in records, in f64: as they are. In f32 they are packed, by `src/math/octahedral.rs`.

use super::super::real::Vec3;

/// A unit vector in a record.
pub type Direction = Vec3;

/// The vector for a record.
pub fn oct_encode(v: Vec3) -> Direction {
    v
}

/// The vector of a record.
pub fn oct_decode(code: Direction) -> Vec3 {
    code
}
