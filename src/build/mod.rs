//! Host-side preparation, in f64, of what the kernels read.

pub mod bezier;
pub mod revolution;
pub mod tessellate;
