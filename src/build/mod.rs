//! Host-only construction of what the kernels read, in f64.

pub mod bezier;
pub mod kdtree;
mod kdtree_bins;
mod kdtree_clip;
mod kdtree_sweep;
pub mod normalize;
pub mod revolution;
pub mod tessellate;
