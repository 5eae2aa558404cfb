//! Shapes: what a ray meets, each the twin of a file in `shaders/shapes/`.

pub mod aabb;
pub mod kdtree;
pub mod ray;
pub mod triangle;
