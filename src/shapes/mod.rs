//! Shapes: ray intersection and surface data, each the twin of a file in `shaders/shapes/`.

pub mod revolution;
