//! Shapes: ray intersection and surface data, each the twin of a file in `shaders/shapes/`.

pub mod revolution;
pub mod revolution_profile;
pub mod revolution_roots;
