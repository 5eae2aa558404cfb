//! Materials and textures. Twins: `shaders/materials/`.

use super::{math, real, shapes, tables};

pub mod enclosing;
pub mod glass;
pub mod interior;
pub mod metal;
pub mod scatter;
pub mod texture;
