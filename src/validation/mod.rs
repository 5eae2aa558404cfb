//! Holding renders against pictures of other renderers, block by block, within the noise of both.
//!
//! A truth gives mean and standard error of every block of pixels ([`BlockTruth`]). A render is
//! made in parts that do not depend on each other ([`render_parts`]), so that its own noise is seen
//! in their scatter and not guessed from the picture's texture. [`Agreement`] joins the two;
//! [`Promise`] holds a render's own word against a truth.

pub mod agreement;
pub mod coverage;
pub mod parts;
pub mod reference;
pub mod student;

pub use agreement::{Agreement, Deviations, hold};
pub use coverage::{NoisyTruth, Promise, promises};
pub use parts::{HoldError, Rendered, render_parts};
pub use reference::{BlockTruth, Blocks};
