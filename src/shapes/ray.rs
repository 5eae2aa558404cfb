//! Rays and hits. Twin: `shaders/shapes/ray.wgsl`.

use super::real::{Plain, Real, Vec3};
use super::table::NONE;
use bytemuck::Zeroable;

/// Segment of a line: the points `origin + t * direction` with `t_min < t < t_max`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Ray {
    /// Point at `t = 0`, in scene space.
    pub origin: Vec3,
    /// Lower bound of hit distances (exclusive), scene units.
    pub t_min: Real,
    /// Unit vector.
    pub direction: Vec3,
    /// Upper bound of hit distances (exclusive), scene units; finite.
    pub t_max: Real,
}

/// Nearest hit so far.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Hit {
    /// Distance along the ray; the ray's `t_max` if nothing was hit.
    pub t: Real,
    /// Reference of the shape (kind and index), or [`NONE`].
    pub reference: u32,
    /// First parameter on the shape; on triangles the barycentric weight of `p1`.
    pub u: Real,
    /// Second parameter on the shape; on triangles the barycentric weight of `p2`.
    pub v: Real,
    /// Reference of the shape of the group that was hit, if `reference` is an instance; otherwise
    /// unspecified.
    pub member: u32,
}

impl Hit {
    /// Initial hit of `ray`: nothing hit yet.
    #[inline]
    pub fn none(ray: &Ray) -> Hit {
        Hit { t: ray.t_max, reference: NONE, u: 0.0, v: 0.0, member: NONE }
    }
}
