//! Host-only construction of what the kernels read.

pub mod kdtree;
mod kdtree_bins;
mod kdtree_clip;
mod kdtree_sweep;
