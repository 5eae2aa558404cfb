//! Vectors, frames, random numbers and elementary functions, each the twin of a file in `shaders/math/`.
//!
//! Twins use only operations that WGSL and Rust round alike (`+ - * /`, `sqrt`, `abs`, `floor`, comparisons
//! and integers), in the same order, so that both engines give the same bits where the driver does not contract.

pub mod rng;
pub mod sampling;
pub mod trig;
pub mod vector;

pub use vector::*;
