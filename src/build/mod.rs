//! Host-only construction of what the kernels read, in f64.

use super::{math, real, shapes};

pub mod bezier;
pub mod bodies;
pub mod contact;
pub mod kdtree;
mod kdtree_bins;
mod kdtree_clip;
mod kdtree_layout;
mod kdtree_sweep;
pub mod learned;
pub mod normalize;
pub mod orientation;
pub mod parts;
pub mod profile;
pub mod revolution;
pub mod tessellate;
