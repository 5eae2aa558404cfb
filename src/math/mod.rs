//! Vectors, frames, random numbers and elementary functions, each the twin of a file in
//! `shaders/math/`.
//!
//! Twins use only operations that WGSL and Rust round alike (`+ - * /`, `sqrt`, `abs`, `floor`,
//! comparisons and integers), in the same order, so that both engines give the same bits where the
//! driver does not contract. A driver may still reassociate. Mesa (nir_opt_algebraic, up to 25 at
//! least) makes, of what is used once:
//!
//! - of `(a * b) * c` with `c` alone constant `(a * c) * b`, and likewise of sums;
//! - one constant of two that meet in a product or sum, as in `(a + 0.5) - 1.0`;
//! - of `(a * b + c * d) + e` with `e` no product `(a * b + e) + c * d`;
//! - of `a * b + a * c` the product `a * (b + c)`; of `a - a + b` `b`; of `a + 0` `a`, even where
//!   `a` is -0.
//!
//! Twins avoid these forms: a constant stands with one variable in the innermost bracket, and a sum
//! of products begins with what is no product. Factors that are powers of two do no harm.

use super::real;

pub mod octahedral;
pub mod rng;
pub mod sampling;
pub mod sobol;
pub mod srgb;
pub mod trig;
pub mod vector;

pub use octahedral::*;
pub use vector::*;
