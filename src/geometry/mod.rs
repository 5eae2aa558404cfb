//! The shapes of a scene together: the nearest hit of a ray, and the surface there. Each file is
//! the twin of a file in `shaders/geometry/`.

use super::{math, real, shapes, tables};

pub mod instances;
pub mod intersect;
pub mod surface;
pub mod tangents;
