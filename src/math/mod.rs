//! Vectors, frames, random numbers and elementary functions, each the twin of a file in `shaders/math/`.
//!
//! Twins use only operations that WGSL and Rust round alike (`+ - * /`, `sqrt`, `abs`, `floor`, comparisons
//! and integers), in the same order, so that both engines give the same bits where the driver does not contract. A driver may still
//! reassociate: Mesa makes `(a * c) * b` of `(a * b) * c` and `(a + c) + b` of `(a + b) + c` where `c` alone is constant,
//! joins two constants that meet in a product or sum, makes `a * (b + c)` of `a * b + a * c`, and drops `a - a` from a
//! sum. Twins avoid these forms (powers of two as factors do no harm): a constant stands with one variable, in the
//! innermost bracket.

pub mod rng;
pub mod sampling;
pub mod trig;
pub mod vector;

pub use vector::*;
