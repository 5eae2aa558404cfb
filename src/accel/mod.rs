//! Acceleration structures, built on the host: the kd-tree and the patches of surfaces of
//! revolution.

use super::{math, real, shapes};

pub mod bezier;
pub mod kdtree;
mod kdtree_bins;
mod kdtree_clip;
mod kdtree_layout;
mod kdtree_sweep;
pub mod profile;
pub mod revolution;
pub mod tessellate;
