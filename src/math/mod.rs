//! Vectors, frames, random numbers and elementary functions, each the twin of a file in `shaders/math/`.

pub mod trig;

use glam::Vec3;

/// Twice pi.
pub const TAU: f32 = std::f32::consts::TAU;
/// Farther than anything in a scene; WGSL has no infinity to rely on.
pub const FAR: f32 = 1e30;

/// `v` at length one.
pub fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}
