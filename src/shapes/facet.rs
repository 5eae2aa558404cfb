//! Facets: flat outlines. A disc about a point near the outline reaches beyond it, where no photon can lie; what is
//! found in it belongs to the part that the facet covers. Twin: `shaders/shapes/facet.wgsl`.

use super::math::trig::{arctan2, kept};
use super::math::{PI, unit};
use super::real::{Plain, Real, Vec2, Vec3};
use super::tables::NONE;
use bytemuck::Zeroable;

/// Least share: a facet of less area within the disc counts as one of this.
const SHARE_MIN: Real = 1e-6;
/// Photons of a facet lie within this many radii of its plane, and the rounding of their positions.
const DEPTH: Real = 0.02;
/// Beyond this ratio of radii a circle's segment within the smaller circle counts as a parabola's.
const SLIM: Real = 30.0;

/// The outline of a flat shape: a parallelogram `origin + s u + t v`, s and t in [0, 1], or a circle.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Facet {
    /// Corner, or centre. Its place across the plane does not matter.
    pub origin: Vec3,
    /// Radius of the circle; 0 for a parallelogram.
    pub radius: Real,
    /// First edge.
    pub u: Vec3,
    /// Bound of the distance of computed points from the plane.
    pub error: Real,
    /// Second edge.
    pub v: Vec3,
    /// Padding.
    pub pad0: u32,
    /// In-plane vector with `dual_u . u = 1` and `dual_u . v = 0`.
    pub dual_u: Vec3,
    /// Padding.
    pub pad1: u32,
    /// In-plane vector with `dual_v . v = 1` and `dual_v . u = 0`.
    pub dual_v: Vec3,
    /// Padding.
    pub pad2: u32,
}

/// What a facet is to a disc about one of its points.
#[derive(Clone, Copy, Debug)]
pub struct Clip {
    /// Whether the outline passes through the disc.
    pub crossed: bool,
    /// One over the share of the disc that the facet covers.
    pub whole: Real,
    /// The same of the disc of half the area about the same point.
    pub inner: Real,
    /// Farthest that photons of the facet may lie from its plane; 0 where it is not crossed.
    pub depth: Real,
}

/// Angle, seen from the origin, from place `start` to place `end` on a line that passes it at `distance`.
fn turn(distance: Real, start: Real, end: Real) -> Real {
    arctan2(distance * (kept(end) - start), distance * distance + start * end)
}

/// Signed area that the unit circle about the origin shares with the triangle of the origin and a piece of a line: the
/// line passes at `distance`, to the right where positive, and the piece goes from `start` to `end` along it.
fn wedge(distance: Real, start: Real, end: Real) -> Real {
    let half_sq = 1.0 - distance * distance;
    let half = half_sq.max(0.0).sqrt();
    let enter = start.max(-half);
    let leave = end.min(half);
    if half_sq <= 0.0 || enter >= leave {
        return 0.5 * turn(distance, start, end);
    }
    let outside = turn(distance, start, enter) + turn(distance, leave, end);
    0.5 * (outside + distance * (leave - enter))
}

fn cross_2d(a: Vec2, b: Vec2) -> Real {
    a.x * b.y - a.y * b.x
}

/// Area that the unit circle about the origin shares with the parallelogram `corner + s (width, 0) + t v`.
fn parallelogram_area(corner: Vec2, width: Real, v: Vec2) -> Real {
    let length = v.dot(v).sqrt();
    let along = v * (1.0 / length);
    let far = corner + v;
    let side = Vec2::new(corner.x + width, corner.y);
    let left_start = corner.dot(along);
    let right_start = side.dot(along);
    let front = wedge(-corner.y, corner.x, side.x);
    let right = wedge(cross_2d(side, along), right_start, right_start + length);
    let back = wedge(-far.y, far.x, far.x + width);
    let left = wedge(cross_2d(corner, along), left_start, left_start + length);
    ((front - back) + (right - left)).abs()
}

/// Area that the unit disc shares with one of `radius` whose centre is `distance` away.
fn discs_area(distance: Real, radius: Real) -> Real {
    if distance + 1.0 <= radius {
        return PI;
    }
    if distance + radius <= 1.0 {
        return PI * radius * radius;
    }
    let x = 0.5 * ((distance - radius) * (distance + radius) + 1.0) / distance;
    let y = (1.0 - x * x).max(0.0).sqrt();
    let near = arctan2(y, x) - x * y;
    if radius < SLIM {
        let rest = distance - x;
        return near + (kept(radius * radius * arctan2(y, rest)) - rest * y);
    }
    // the other segment is too slim for a difference: the first term of its series
    near + 0.666_666_7 * (y * y) * (y / radius)
}

/// Share of the disc of `radius` about `position`, a point of `facet`, that the facet covers.
pub fn facet_share(facet: &Facet, position: Vec3, normal: Vec3, radius: Real) -> Real {
    let scale = 1.0 / radius;
    let d = (facet.origin - position) * scale;
    let area = if facet.radius > 0.0 {
        discs_area(d.dot(d).sqrt(), facet.radius * scale)
    } else {
        let first = unit(facet.u);
        let second = normal.cross(first);
        let corner = Vec2::new(d.dot(first), d.dot(second));
        let v = Vec2::new(facet.v.dot(first), facet.v.dot(second)) * scale;
        parallelogram_area(corner, facet.u.dot(first) * scale, v)
    };
    (area / PI).clamp(SHARE_MIN, 1.0)
}

/// How facet `number`, if there is one, clips the disc of `radius` about its point `position`.
pub fn clip_at(facets: &[Facet], number: u32, position: Vec3, normal: Vec3, radius: Real) -> Clip {
    let mut clip = Clip { crossed: false, whole: 1.0, inner: 1.0, depth: 0.0 };
    if number == NONE {
        return clip;
    }
    let facet = &facets[number as usize];
    let d = position - facet.origin;
    if facet.radius > 0.0 {
        let within = facet.radius - radius;
        clip.crossed = within <= 0.0 || d.dot(d) > within * within;
    } else {
        let s = d.dot(facet.dual_u);
        let t = d.dot(facet.dual_v);
        let margin_s = s.min(1.0 - s).max(0.0);
        let margin_t = t.min(1.0 - t).max(0.0);
        let radius_sq = radius * radius;
        clip.crossed = margin_s * margin_s < radius_sq * facet.dual_u.dot(facet.dual_u)
            || margin_t * margin_t < radius_sq * facet.dual_v.dot(facet.dual_v);
    }
    if clip.crossed {
        clip.whole = 1.0 / facet_share(facet, position, normal, radius);
        clip.inner = 1.0 / facet_share(facet, position, normal, 0.707_106_77 * radius);
        clip.depth = DEPTH * radius + 2.0 * facet.error;
    }
    clip
}

/// Whether a point of the facet's plane lies within its outline.
pub fn on_facet(facet: &Facet, position: Vec3) -> bool {
    let d = position - facet.origin;
    if facet.radius > 0.0 {
        return d.dot(d) < facet.radius * facet.radius;
    }
    let s = d.dot(facet.dual_u);
    let t = d.dot(facet.dual_v);
    s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0
}
