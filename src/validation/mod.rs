//! Validation of renders against images of other renderers, block by block, within the noise of
//! both.
//!
//! A reference provides mean and standard error of each block of pixels ([`BlockTruth`]). A render
//! consists of independent parts ([`render_parts`]), whose scatter measures its noise.
//! [`Agreement`] compares the two. [`Promise`] compares a render's error estimate with its true
//! error.

pub mod agreement;
pub mod coverage;
pub mod parts;
pub mod reference;
pub mod student;

pub use agreement::{Agreement, Deviations, hold};
pub use coverage::{NoisyTruth, Promise, promises};
pub use parts::{HoldError, Rendered, render_parts};
pub use reference::{BlockTruth, Blocks};
