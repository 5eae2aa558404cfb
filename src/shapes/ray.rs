//! Rays and hits. Twin: `shaders/shapes/ray.wgsl`.

use super::real::{Plain, Real, Vec3};
use super::table::NONE;
use bytemuck::Zeroable;

/// A segment of a line: the points `origin + t * direction` with `t_min < t < t_max`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Ray {
    /// Where `t` is 0, in scene space.
    pub origin: Vec3,
    /// Hits must lie strictly beyond, in scene units.
    pub t_min: Real,
    /// Unit vector.
    pub direction: Vec3,
    /// Hits must lie strictly before, in scene units; finite.
    pub t_max: Real,
}

/// The nearest hit so far.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Hit {
    /// Distance along the ray; the ray's `t_max` while nothing was hit.
    pub t: Real,
    /// What was hit (kind and index), or [`NONE`].
    pub reference: u32,
    /// First parameter on the shape; a triangle's barycentric weight of `p1`.
    pub u: Real,
    /// Second parameter on the shape; a triangle's barycentric weight of `p2`.
    pub v: Real,
}

impl Hit {
    /// Nothing hit yet on `ray`.
    #[inline]
    pub fn none(ray: &Ray) -> Hit {
        Hit { t: ray.t_max, reference: NONE, u: 0.0, v: 0.0 }
    }
}
