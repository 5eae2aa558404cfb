//! Bezier surfaces of revolution: local frame, ray intersection and surface data. Twin:
//! `shaders/shapes/revolution.wgsl`.

use super::real::{LEADING, Plain, Real, Vec2, Vec3, roundings};
use bytemuck::Zeroable;

pub use super::revolution_profile::{LocalRay, MAX_DEGREE, Patch, profile_point, ring_point};
pub use super::revolution_roots::{BRACKETED, PatchHit, patch_miss};

use super::math::trig::sin_cos;
use super::math::{FAR, TAU, unit};
use super::revolution_roots::first_root;

/// Relative error of a hit's position, as a fraction of the coordinates plus the surface's size: 16
/// EPS.
const REVOLUTION_ERROR: Real = roundings(9.6e-7);

/// Frame and attributes of a surface of revolution. A scene point p has the local coordinates
/// (x_axis . q, y_axis . q, z_axis . q) / scale with q = p - center; the axes are orthonormal.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Revolution {
    /// Local x axis in scene space, the direction of theta = 0.
    pub x_axis: Vec3,
    /// Scene units per local unit.
    pub scale: Real,
    /// Local y axis in scene space, the axis of revolution.
    pub y_axis: Vec3,
    /// Local units per scene unit.
    pub inv_scale: Real,
    /// Local z axis in scene space, the direction of theta = pi / 2.
    pub z_axis: Vec3,
    /// Number of profile segments; v spans all of them.
    pub segments: u32,
    /// Point on the axis at half the profile's height, scene units.
    pub center: Vec3,
    /// Index of the material.
    pub material: u32,
    /// Index of the light, or [`NONE`](super::table::NONE).
    pub light: u32,
    /// Source of the texture coordinates, one of the `UV_*` constants.
    pub uv: u32,
    /// Padding to 16 bytes, zero.
    pub padding: [u32; 2],
}

/// Surface data at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevolutionSurface {
    /// Point on the surface, scene units.
    pub position: Vec3,
    /// Bound on the distance along the normal from `position` to the true surface and to the ray's
    /// hit on it, scene units.
    pub error: Real,
    /// Unit normal; points outward if the profile runs upward.
    pub normal: Vec3,
    /// u around the axis, v along the profile over all its segments, both in [0, 1].
    pub uv: Vec2,
}

/// Clears the low half of the mantissa of `x`: products of two such numbers are exact.
fn leading_bits(x: Real) -> Real {
    Real::from_bits(x.to_bits() & LEADING)
}

/// Transforms the ray to the frame of `revolution` and moves its origin next to the center. The
/// move is exact up to one rounding of the result, however distant the origin is: distance and
/// direction are split so that no product rounds.
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

/// First hit of the ray with the full ring of the patch at a distance in [t_min, t_max), scene
/// units. `direction` is a unit vector.
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
    // clip the interval to the slab of the ring's heights
    if d.y.abs() > 1e-30 {
        let l0 = (piece.y_min - o.y) / d.y;
        let l1 = (piece.y_max - o.y) / d.y;
        begin = begin.max(l0.min(l1));
        end = end.min(l0.max(l1));
    } else if o.y < piece.y_min || o.y > piece.y_max {
        return patch_miss();
    }
    // clip to the outer cylinder and cut out the inner one, which contains no surface
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
    // search the part before the closest approach to the axis, then the part after it
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

/// Surface data at (theta, tau) of a hit.
pub fn revolution_surface(
    points: &[Vec2],
    revolution: &Revolution,
    piece: &Patch,
    theta: Real,
    tau: Real,
) -> RevolutionSurface {
    let mut at = ring_point(points, piece, theta, tau);
    let p = at.point * revolution.scale;
    // the tangent alone gives the normal, even on the axis; at a cusp, use the tangent next to it
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
