//! Shapes: ray intersection and surface data. Most modules are the twin of a file in
//! `shaders/shapes/`.

use super::{math, real};

pub mod aabb;
pub mod cuboid;
pub mod disc;
pub mod instance;
pub mod kdtree;
pub mod kdtree_stream;
pub mod outline;
pub mod ray;
pub mod rectangle;
pub mod revolution;
pub mod revolution_profile;
pub mod revolution_roots;
pub mod simd4;
pub mod sphere;
pub mod table;
pub mod triangle;
pub mod triangles;
