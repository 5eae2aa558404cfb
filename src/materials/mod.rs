//! Materials and textures. Twins: `shaders/materials/`.

use super::{math, real, shapes, tables};

pub mod glass;
pub mod metal;
pub mod scatter;
pub mod texture;
