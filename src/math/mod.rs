//! Vectors, frames, random numbers and elementary functions. Twins: `shaders/math/`.
//!
//! Twins use only operations that WGSL and Rust round alike (`+ - * /`, `sqrt`, `abs`, `floor`,
//! comparisons and integers), in the same order, so that both engines compute the same bits if the
//! driver does not contract expressions. A driver may still reassociate. Mesa (nir_opt_algebraic,
//! at least up to version 25) rewrites values that are used once:
//!
//! - `(a * b) * c`, if only `c` is constant, to `(a * c) * b`, and likewise for sums;
//! - two constants that meet in a product or sum, as in `(a + 0.5) - 1.0`, to one;
//! - `(a * b + c * d) + e`, if `e` is not a product, to `(a * b + e) + c * d`;
//! - `a * b + a * c` to `a * (b + c)`; `a - a + b` to `b`; `a + 0` to `a`, even if `a` is -0.
//!
//! Twins avoid these forms: a constant is combined with one variable in the innermost bracket, and
//! a sum of products begins with a term that is not a product. Factors that are powers of two are
//! harmless.

use super::real;

pub mod octahedral;
pub mod pixel_filter;
pub mod rng;
pub mod sampling;
pub mod sobol;
pub mod srgb;
pub mod trig;
pub mod vector;

pub use octahedral::*;
pub use vector::*;
