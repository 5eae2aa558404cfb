//! Bezier surfaces of revolution: frame, ray intersection and surface data.
//! Twin: `shaders/shapes/revolution.wgsl`.

use super::real::{LEADING, Plain, Real, Vec2, Vec3, roundings};
use bytemuck::Zeroable;

pub use super::revolution_profile::{LocalRay, MAX_DEGREE, Patch, profile_point, ring_point};
pub use super::revolution_roots::{BRACKETED, PatchHit, patch_miss};

use super::math::trig::sin_cos;
use super::math::{FAR, TAU, unit};
use super::revolution_roots::first_root;

/// Relative error of a hit's position, measured in the coordinates' and the surface's size: 16
/// roundings.
const REVOLUTION_ERROR: Real = roundings(9.6e-7);

/// A surface of revolution's frame and attributes. A scene point p has the local coordinates
/// (x_axis . q, y_axis . q, z_axis . q) / scale with q = p - center; the axes are orthonormal.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Revolution {
    /// Local x axis in the scene; theta = 0 lies along it.
    pub x_axis: Vec3,
    /// Scene units per local unit.
    pub scale: Real,
    /// The axis of revolution.
    pub y_axis: Vec3,
    /// Local units per scene unit.
    pub inv_scale: Real,
    /// Local z axis; theta = pi / 2 lies along it.
    pub z_axis: Vec3,
    /// Number of profile segments, for v.
    pub segments: u32,
    /// Point of the axis at half the profile's height, scene units.
    pub center: Vec3,
    /// Index of the material.
    pub material: u32,
    /// Index of the light, or the caller's mark for none.
    pub light: u32,
    /// The caller's uv mode.
    pub uv: u32,
    /// Zero.
    pub padding: [u32; 2],
}

/// The exact surface at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevolutionSurface {
    /// Point on the surface, scene units.
    pub position: Vec3,
    /// Bound on the distance from `position` to the true surface and to the ray's hit on it, across
    /// the surface, scene units.
    pub error: Real,
    /// Unit normal; outward where the profile is drawn upward.
    pub normal: Vec3,
    /// u around the axis, v along the profile over all its segments.
    pub uv: Vec2,
}

/// `x` with the last half of its bits cleared: products of two such numbers are exact.
fn leading_bits(x: Real) -> Real {
    Real::from_bits(x.to_bits() & LEADING)
}

/// The ray in the frame of `revolution`, its origin moved next to the center. The move is exact up
/// to a rounding of the result, however far the origin: distance and direction are split so that no
/// product rounds.
pub fn local_ray(revolution: &Revolution, origin: Vec3, direction: Vec3) -> LocalRay {
    let high =
        Vec3::new(leading_bits(direction.x), leading_bits(direction.y), leading_bits(direction.z));
    let low = direction - high;
    let far = leading_bits((revolution.center - origin).dot(direction));
    let p = ((origin + high * far) - revolution.center) + low * far;
    let near = -p.dot(direction);
    let q = (p + direction * near) * revolution.inv_scale;
    let local_origin =
        Vec3::new(revolution.x_axis.dot(q), revolution.y_axis.dot(q), revolution.z_axis.dot(q));
    let local_direction = Vec3::new(
        revolution.x_axis.dot(direction),
        revolution.y_axis.dot(direction),
        revolution.z_axis.dot(direction),
    );
    LocalRay { origin: local_origin, start: far + near, direction: local_direction, side: -1.0 }
}

/// The first hit of the ray with the patch's whole ring at a distance from t_min to below t_max,
/// scene units. `direction` is unit.
pub fn intersect_patch(
    points: &[Vec2],
    revolution: &Revolution,
    piece: &Patch,
    origin: Vec3,
    direction: Vec3,
    t_min: Real,
    t_max: Real,
) -> PatchHit {
    let mut ray = local_ray(revolution, origin, direction);
    let o = ray.origin;
    let d = ray.direction;
    let mut begin = (t_min - ray.start) * revolution.inv_scale;
    let mut end = (t_max - ray.start) * revolution.inv_scale;
    // The slab of the ring's heights.
    if d.y.abs() > 1e-30 {
        let l0 = (piece.y_min - o.y) / d.y;
        let l1 = (piece.y_max - o.y) / d.y;
        begin = begin.max(l0.min(l1));
        end = end.min(l0.max(l1));
    } else if o.y < piece.y_min || o.y > piece.y_max {
        return patch_miss();
    }
    // Its outer cylinder, and its inner one, which holds nothing.
    let a = (d.x * d.x + d.z * d.z).max(1e-20);
    let l_axis = -(o.x * d.x + o.z * d.z) / a;
    let x = o.x + d.x * l_axis;
    let z = o.z + d.z * l_axis;
    let axis_sq = x * x + z * z;
    let outer_sq = piece.r_max * piece.r_max - axis_sq;
    if outer_sq < 0.0 {
        return patch_miss();
    }
    let outer = (outer_sq / a).sqrt();
    let inner = ((piece.r_min * piece.r_min - axis_sq).max(0.0) / a).sqrt();
    begin = begin.max(l_axis - outer);
    end = end.min(l_axis + outer);
    let mut hit = patch_miss();
    for i in 0..2 {
        ray.side = if i == 0 { -1.0 } else { 1.0 };
        let first = if i == 0 { begin } else { begin.max(l_axis + inner) };
        let last = if i == 0 { end.min(l_axis - inner) } else { end };
        hit = first_root(points, piece, &ray, first, last);
        if hit.t < FAR {
            break;
        }
    }
    if hit.t < FAR {
        let t = ray.start + hit.t * revolution.scale;
        hit.t = if t < t_max { t.max(t_min) } else { FAR };
    }
    hit
}

/// The surface at (theta, tau) of a hit.
pub fn revolution_surface(
    points: &[Vec2],
    revolution: &Revolution,
    piece: &Patch,
    theta: Real,
    tau: Real,
) -> RevolutionSurface {
    let mut at = ring_point(points, piece, theta, tau);
    let p = at.point * revolution.scale;
    // The tangent alone gives the normal, on the axis too; at a cusp the tangent next to it stands
    // in.
    if at.d_tau.dot(at.d_tau) <= roundings(1e-8) * piece.length * piece.length {
        at = ring_point(points, piece, theta, tau + (0.5 - tau) * 0.001);
    }
    let (sin, cos) = sin_cos(theta);
    let dr = at.d_tau.x * cos + at.d_tau.z * sin;
    let dy = at.d_tau.y;
    let n = unit(Vec3::new(dy * cos, -dr, dy * sin));
    let position = ((revolution.center + revolution.x_axis * p.x) + revolution.y_axis * p.y)
        + revolution.z_axis * p.z;
    let normal = (revolution.x_axis * n.x + revolution.y_axis * n.y) + revolution.z_axis * n.z;
    let c = revolution.center;
    let size = revolution.scale + c.x.abs().max(c.y.abs()).max(c.z.abs());
    let u = 0.5 - theta / TAU;
    let t = piece.t0 + (piece.t1 - piece.t0) * tau;
    RevolutionSurface {
        position,
        error: REVOLUTION_ERROR * size,
        normal,
        uv: Vec2::new(u - u.floor(), (piece.segment as Real + t) / revolution.segments as Real),
    }
}
