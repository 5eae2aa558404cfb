//! Profile of a surface of revolution, cut into patches, and rays in the profile's half-plane.
//! Twin: `shaders/shapes/revolution_profile.wgsl`.
//!
//! A surface is S(theta, tau) = (r cos theta, y, r sin theta) in a local frame whose axis is y and
//! in which the profile has size about one. The host cuts the profile into *patches*: short Bezier
//! curves that are graphs h = phi(s) over their chord, with |phi'| <= `slope` and phi within
//! [`phi_min`, `phi_max`].

use super::real::{Plain, Real, Vec2, Vec3, Vec4, roundings};
use bytemuck::Zeroable;

use super::math::trig::{kept, sin_cos};

/// Highest degree of a profile segment.
pub const MAX_DEGREE: usize = 15;

/// Short piece of a profile that is a graph over its chord, revolved about the axis. Local units. A
/// profile point (r, y) has the chord coordinates (s, h) relative to `origin`: s along `axis`, h
/// along (axis.y, -axis.x); so h grows outward on an upward chord.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Patch {
    /// Index of the revolution.
    pub revolution: u32,
    /// Segment of the profile.
    pub segment: u32,
    /// Index of the first control point; control points are in chord coordinates.
    pub first_point: u32,
    /// Degree of the piece, 1 to 15.
    pub degree: u32,
    /// Start of the chord (r, y).
    pub origin: Vec2,
    /// Direction of the chord (r, y), unit.
    pub axis: Vec2,
    /// Least radius, rounded down.
    pub r_min: Real,
    /// Greatest radius, rounded up.
    pub r_max: Real,
    /// Least height, rounded down.
    pub y_min: Real,
    /// Greatest height, rounded up.
    pub y_max: Real,
    /// Lower bound of phi, rounded down; at most 0.
    pub phi_min: Real,
    /// Upper bound of phi, rounded up; at least 0.
    pub phi_max: Real,
    /// Bound on |phi'|.
    pub slope: Real,
    /// Length of the chord.
    pub length: Real,
    /// Curve parameter of the segment at tau = 0.
    pub t0: Real,
    /// Curve parameter of the segment at tau = 1.
    pub t1: Real,
    /// Bound on how far phi' between two points leaves the range of its values at these points.
    pub wobble: Real,
    /// Newton steps shorter than this, in local units, end the root search.
    pub step_tolerance: Real,
}

/// Ray in local units. Its origin is a point of the scene ray near the surface's center.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay {
    /// Local coordinates of the origin.
    pub origin: Vec3,
    /// Distance of `origin` along the scene ray, scene units.
    pub start: Real,
    /// Local direction; a unit vector if the scene ray's direction is one.
    pub direction: Vec3,
    /// -1 for the part of the ray before its closest approach to the axis, 1 for the part after it.
    pub side: Real,
}

/// Point of a ray in chord coordinates; s(l) and h(l) are each convex or concave on either side of
/// the closest approach to the axis.
#[derive(Clone, Copy, Debug)]
pub struct RayPoint {
    /// Distance from the local origin, local units.
    pub l: Real,
    /// Coordinate along the chord.
    pub s: Real,
    /// Coordinate across the chord.
    pub h: Real,
    /// ds/dl.
    pub ds: Real,
    /// dh/dl.
    pub dh: Real,
}

/// Surface point with its two partial derivatives, local units.
#[derive(Clone, Copy, Debug)]
pub struct RingPoint {
    /// S(theta, tau).
    pub point: Vec3,
    /// dS/dtheta.
    pub d_theta: Vec3,
    /// dS/dtau.
    pub d_tau: Vec3,
}

/// Evaluates the patch's profile and its derivative at `tau` by de Casteljau: (s, h, ds/dtau,
/// dh/dtau).
pub fn profile_point(points: &[Vec2], piece: &Patch, tau: Real) -> Vec4 {
    let n = piece.degree;
    let mut b = [Vec2::ZERO; MAX_DEGREE + 1];
    for i in 0..=n {
        b[i as usize] = points[(piece.first_point + i) as usize];
    }
    for k in 1..n {
        for i in 0..=n - k {
            b[i as usize] += (b[i as usize + 1] - b[i as usize]) * tau;
        }
    }
    let leg = b[1] - b[0];
    let point = b[0] + leg * tau;
    let tangent = leg * n as Real;
    Vec4::new(point.x, point.y, tangent.x, tangent.y)
}

/// Evaluates the ray at distance `l`.
pub fn ray_point(piece: &Patch, ray: &LocalRay, l: Real) -> RayPoint {
    let o = ray.origin;
    let d = ray.direction;
    let x = o.x + d.x * l;
    let z = o.z + d.z * l;
    let radius = (x * x + z * z).sqrt();
    // the radius has a kink on the axis: use the one-sided slope there
    let outward = if radius > 0.0 {
        (x * d.x + z * d.z) / radius
    } else {
        ray.side * (d.x * d.x + d.z * d.z).sqrt()
    };
    let d_radius = if outward * ray.side > 0.0 { outward } else { 0.0 };
    let r = radius - piece.origin.x;
    let y = (o.y + d.y * l) - piece.origin.y;
    RayPoint {
        l,
        s: kept(piece.axis.x * r + piece.axis.y * y),
        h: kept(piece.axis.y * r - piece.axis.x * y),
        ds: kept(piece.axis.x * d_radius + piece.axis.y * d.y),
        dh: kept(piece.axis.y * d_radius - piece.axis.x * d.y),
    }
}

/// Parameter at chord coordinate `s`: Newton on the monotone s(tau), safeguarded by a bracket.
pub fn tau_at(points: &[Vec2], piece: &Patch, s: Real) -> Real {
    let mut low = 0.0;
    let mut high = 1.0;
    let mut tau = (s / piece.length).clamp(0.0, 1.0);
    for _ in 0..20 {
        let p = profile_point(points, piece, tau);
        let error = p.x - s;
        if error > 0.0 {
            high = tau;
        } else {
            low = tau;
        }
        let step = if p.z > 0.0 { error / p.z } else { 2.0 };
        let mut next = tau - step;
        if next < low || next > high {
            next = 0.5 * (low + high);
        }
        let moved = (next - tau).abs();
        tau = next;
        if moved <= roundings(1e-7) {
            break;
        }
    }
    tau
}

/// (F, phi'(s), tau) with F = h - phi(s); phi is continued past the chord's ends by its tangents.
/// Unless `exact`, F is replaced by +-1 outside the band that contains phi.
pub fn profile_offset(points: &[Vec2], piece: &Patch, at: RayPoint, exact: bool) -> Vec3 {
    let past = (-at.s).max(at.s - piece.length).max(0.0) * piece.slope;
    if !exact && at.h > piece.phi_max + past {
        return Vec3::new(1.0, 0.0, 0.0);
    }
    if !exact && at.h < piece.phi_min - past {
        return Vec3::new(-1.0, 0.0, 0.0);
    }
    let s = at.s.clamp(0.0, piece.length);
    let tau = tau_at(points, piece, s);
    let p = profile_point(points, piece, tau);
    let slope = if p.z > 0.0 { p.w / p.z } else { 0.0 };
    let d_phi = slope.clamp(-piece.slope, piece.slope);
    Vec3::new(at.h - (p.y + d_phi * (at.s - s)), d_phi, tau)
}

/// Evaluates S and its derivatives at (theta, tau).
pub fn ring_point(points: &[Vec2], piece: &Patch, theta: Real, tau: Real) -> RingPoint {
    let p = profile_point(points, piece, tau);
    let (sin, cos) = sin_cos(theta);
    // one addition at a time: Mesa rewrites e + (a b + c d)
    let r = (piece.origin.x + piece.axis.x * p.x) + piece.axis.y * p.y;
    let y = (piece.origin.y + piece.axis.y * p.x) - piece.axis.x * p.y;
    let dr = piece.axis.x * p.z + piece.axis.y * p.w;
    let dy = piece.axis.y * p.z - piece.axis.x * p.w;
    RingPoint {
        point: Vec3::new(r * cos, y, r * sin),
        d_theta: Vec3::new(-r * sin, 0.0, r * cos),
        d_tau: Vec3::new(dr * cos, dy, dr * sin),
    }
}
