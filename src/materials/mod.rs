//! Materials and textures. Twins: `shaders/materials/`.

pub mod glass;
pub mod metal;
pub mod scatter;
pub mod texture;
