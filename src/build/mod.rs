//! Host-only construction, in f64, of what the kernels read.

pub mod bezier;
pub mod kdtree;
mod kdtree_bins;
mod kdtree_clip;
mod kdtree_sweep;
pub mod revolution;
