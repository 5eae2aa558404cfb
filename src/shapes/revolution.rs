//! Bezier surfaces of revolution: ray intersection and surface data. Twin: `shaders/shapes/revolution.wgsl`.
//!
//! A surface is S(theta, tau) = (r cos theta, y, r sin theta) in a local frame whose axis is y and in which
//! the profile has size about one. The host cuts the profile into *patches*: short Bezier curves that are
//! graphs h = phi(s) over their chord, with |phi'| <= `slope` and phi within [`phi_min`, `phi_max`].
//!
//! In the half-plane (radius, y) a ray is a branch of a hyperbola, radius(l) = sqrt(x^2 + z^2) convex in the
//! distance l and y(l) linear. On either side of its closest approach to the axis both are monotone, so their
//! chord coordinates s(l) and h(l) are bounded by their ends and end slopes. F(l) = h(l) - phi(s(l)) is zero
//! at the hits. The search walks along the ray over intervals that either hold no root (h leaves the band of
//! phi, or s the chord), or at most one (|h'| > slope |s'|: F is monotone), or are halved. A root inside is found
//! by damped Newton on the 3x3 system, started from the chord's cone; where that system is singular (axis,
//! silhouette, cusp) or leaves the interval, by a bracketed solve of F in l alone, which is regular everywhere.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

use crate::math::trig::{arctan2, sin_cos};
use crate::math::{FAR, TAU, unit};

/// Largest degree of a profile segment.
pub const MAX_DEGREE: usize = 15;
/// Newton steps at most (DESIGN: 15).
pub const NEWTON_STEPS: u32 = 15;
/// Halvings of one Newton step at most.
pub const NEWTON_HALVINGS: u32 = 10;
/// Set in [`PatchHit::steps`] when the bracketed solve gave the root.
pub const BRACKETED: u32 = 256;
/// Intervals looked at on one side of the axis at most.
const MARCH_LIMIT: u32 = 256;
/// Shortest interval, as a part of the first: two roots closer than that are deeper than no rounding error.
const MARCH_LEAST: f32 = 1.0 / 8192.0;
/// Length by which a patch reaches past its ends, in local units; several roundings of a local coordinate.
const END_TOLERANCE: f32 = 3e-7;
/// Newton steps shorter than this (local units) end the iteration.
const STEP_TOLERANCE: f32 = 4e-7;
/// Residuals of this size may be rounding alone.
const RESIDUAL_NOISE: f32 = 1e-6;
/// Relative error of a hit's position, measured in the coordinates' and the surface's size: 16 roundings.
const POSITION_ERROR: f32 = 9.6e-7;

/// A surface of revolution's frame and attributes. A scene point p has the local coordinates
/// (x_axis . q, y_axis . q, z_axis . q) / scale with q = p - center; the axes are orthonormal.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Revolution {
    /// Local x axis in the scene; theta = 0 lies along it.
    pub x_axis: Vec3,
    /// Scene units per local unit.
    pub scale: f32,
    /// The axis of revolution.
    pub y_axis: Vec3,
    /// Local units per scene unit.
    pub inv_scale: f32,
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

/// A short piece of profile, a graph over its chord, turned about the axis. Local units. Chord coordinates
/// (s, h) of a profile point (r, y): s along `axis`, h along (axis.y, -axis.x), from `origin`; so h grows
/// outward on an upward chord.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Patch {
    /// Index of the revolution.
    pub revolution: u32,
    /// Segment of the profile.
    pub segment: u32,
    /// Index of the first control point; the points are chord coordinates.
    pub first_point: u32,
    /// Degree of the piece, 1 to 15.
    pub degree: u32,
    /// Chord start (r, y).
    pub origin: Vec2,
    /// Chord direction (r, y), unit.
    pub axis: Vec2,
    /// Least and largest radius, rounded outward.
    pub r_min: f32,
    /// See `r_min`.
    pub r_max: f32,
    /// Least and largest height, rounded outward.
    pub y_min: f32,
    /// See `y_min`.
    pub y_max: f32,
    /// Range of phi, rounded outward; holds 0.
    pub phi_min: f32,
    /// See `phi_min`.
    pub phi_max: f32,
    /// Bound on |phi'|.
    pub slope: f32,
    /// Length of the chord.
    pub length: f32,
    /// Curve parameter of the segment at tau = 0 and tau = 1.
    pub t0: f32,
    /// See `t0`.
    pub t1: f32,
    /// Between two points, phi' leaves the range of its values there by no more than this.
    pub wobble: f32,
    /// Zero.
    pub padding: u32,
}

/// Where a ray meets a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchHit {
    /// Distance along the ray, scene units; [`FAR`] when there is no hit.
    pub t: f32,
    /// Angle about the axis, radians.
    pub theta: f32,
    /// Parameter of the patch, 0 to 1.
    pub tau: f32,
    /// Newton steps taken, plus [`BRACKETED`].
    pub steps: u32,
}

/// The exact surface at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevolutionSurface {
    /// Point on the surface, scene units.
    pub position: Vec3,
    /// Bound on the distance from `position` to the true surface and to the ray's hit on it, across the
    /// surface, scene units.
    pub error: f32,
    /// Unit normal; outward where the profile is drawn upward.
    pub normal: Vec3,
    /// u around the axis, v along the profile over all its segments.
    pub uv: Vec2,
}

/// A ray in local units: `origin` is the point near the surface's center, `start` its distance along the
/// scene's ray in scene units.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay {
    /// Local origin.
    pub origin: Vec3,
    /// Scene distance of `origin`.
    pub start: f32,
    /// Local direction, as long as the scene's.
    pub direction: Vec3,
}

/// A profile point or ray point with its derivative, in chord coordinates (s, h, s', h').
type ChordPoint = Vec4;

/// A surface point with its two partial derivatives, local units.
#[derive(Clone, Copy, Debug)]
pub struct RingPoint {
    /// S(theta, tau).
    pub point: Vec3,
    /// dS/dtheta.
    pub d_theta: Vec3,
    /// dS/dtau.
    pub d_tau: Vec3,
}

/// No hit.
pub fn patch_miss() -> PatchHit {
    PatchHit { t: FAR, theta: 0.0, tau: 0.0, steps: 0 }
}

/// `x` with its last 12 bits cleared: products of two such numbers are exact.
fn leading_bits(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_f000)
}

/// The ray in the frame of `revolution`, its origin moved next to the center. The move is exact up to a
/// rounding of the result, however far the origin: distance and direction are split so that no product rounds.
pub fn local_ray(revolution: &Revolution, origin: Vec3, direction: Vec3) -> LocalRay {
    let high = Vec3::new(leading_bits(direction.x), leading_bits(direction.y), leading_bits(direction.z));
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
    LocalRay { origin: local_origin, start: far + near, direction: local_direction }
}

/// The patch's profile at `tau` with its derivative, by de Casteljau.
pub fn profile_point(points: &[Vec2], patch: &Patch, tau: f32) -> ChordPoint {
    let n = patch.degree;
    let mut b = [Vec2::ZERO; MAX_DEGREE + 1];
    for i in 0..=n {
        b[i as usize] = points[(patch.first_point + i) as usize];
    }
    for k in 1..n {
        for i in 0..=n - k {
            b[i as usize] += (b[i as usize + 1] - b[i as usize]) * tau;
        }
    }
    let leg = b[1] - b[0];
    let point = b[0] + leg * tau;
    let tangent = leg * n as f32;
    Vec4::new(point.x, point.y, tangent.x, tangent.y)
}

/// The ray at `l` in chord coordinates; `side` is -1 before the closest approach to the axis, 1 after it.
fn chord_point(patch: &Patch, ray: &LocalRay, l: f32, side: f32) -> ChordPoint {
    let o = ray.origin;
    let d = ray.direction;
    let x = o.x + d.x * l;
    let z = o.z + d.z * l;
    let radius = (x * x + z * z).sqrt();
    // On the axis the radius has a kink: its slope there is the one-sided one.
    let outward =
        if radius > 0.0 { (x * d.x + z * d.z) / radius } else { side * (d.x * d.x + d.z * d.z).sqrt() };
    let d_radius = if outward * side > 0.0 { outward } else { 0.0 };
    let r = radius - patch.origin.x;
    let y = (o.y + d.y * l) - patch.origin.y;
    Vec4::new(
        patch.axis.x * r + patch.axis.y * y,
        patch.axis.y * r - patch.axis.x * y,
        patch.axis.x * d_radius + patch.axis.y * d.y,
        patch.axis.y * d_radius - patch.axis.x * d.y,
    )
}

/// The parameter at chord coordinate `s`: Newton on the monotone s(tau), kept inside a bracket.
fn tau_at(points: &[Vec2], patch: &Patch, s: f32) -> f32 {
    let mut low = 0.0;
    let mut high = 1.0;
    let mut tau = (s / patch.length).clamp(0.0, 1.0);
    for _ in 0..20 {
        let p = profile_point(points, patch, tau);
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
        if moved <= 1e-7 {
            break;
        }
    }
    tau
}

/// F = h - phi(s) and phi'(s); phi is continued past the chord's ends by its tangents.
fn profile_offset(points: &[Vec2], patch: &Patch, at: ChordPoint) -> Vec2 {
    let s = at.x.clamp(0.0, patch.length);
    let p = profile_point(points, patch, tau_at(points, patch, s));
    let slope = if p.z > 0.0 { p.w / p.z } else { 0.0 };
    let d_phi = slope.clamp(-patch.slope, patch.slope);
    Vec2::new(at.y - (p.y + d_phi * (at.x - s)), d_phi)
}

/// Whether F >= 0.
fn above_profile(points: &[Vec2], patch: &Patch, at: ChordPoint) -> bool {
    // The band that holds phi, continued.
    let past = (-at.x).max(at.x - patch.length).max(0.0) * patch.slope;
    if at.y > patch.phi_max + past {
        return true;
    }
    if at.y < patch.phi_min - past {
        return false;
    }
    profile_offset(points, patch, at).x >= 0.0
}

/// S and its derivatives at (theta, tau).
pub fn ring_point(points: &[Vec2], patch: &Patch, theta: f32, tau: f32) -> RingPoint {
    let p = profile_point(points, patch, tau);
    let (sin, cos) = sin_cos(theta);
    let r = patch.origin.x + (patch.axis.x * p.x + patch.axis.y * p.y);
    let y = patch.origin.y + (patch.axis.y * p.x - patch.axis.x * p.y);
    let dr = patch.axis.x * p.z + patch.axis.y * p.w;
    let dy = patch.axis.y * p.z - patch.axis.x * p.w;
    RingPoint {
        point: Vec3::new(r * cos, y, r * sin),
        d_theta: Vec3::new(-r * sin, 0.0, r * cos),
        d_tau: Vec3::new(dr * cos, dy, dr * sin),
    }
}

/// One Newton step (dl, dtheta, dtau) for f = o + l d - S, and D = d . (S_theta x S_tau); zero where D is
/// as good as zero.
pub fn newton_step(direction: Vec3, f: Vec3, at: &RingPoint) -> Vec4 {
    let det = direction.dot(at.d_theta.cross(at.d_tau));
    let size = at.d_theta.dot(at.d_theta) * at.d_tau.dot(at.d_tau);
    if det * det <= 1e-8 * size {
        return Vec4::ZERO;
    }
    let g = at.d_tau.cross(f);
    let dl = -at.d_theta.dot(g) / det;
    let d_theta = -direction.dot(g) / det;
    let d_tau = direction.dot(at.d_theta.cross(f)) / det;
    Vec4::new(dl, d_theta, d_tau, det)
}

/// Damped Newton from (l, theta, tau), `t` standing for l; [`FAR`] in `t` when it does not converge.
fn newton(points: &[Vec2], patch: &Patch, ray: &LocalRay, start: PatchHit) -> PatchHit {
    let mut x = start;
    let mut at = ring_point(points, patch, x.theta, x.tau);
    let mut f = (ray.origin + ray.direction * x.t) - at.point;
    let mut error_sq = f.dot(f);
    for i in 0..NEWTON_STEPS {
        let step = newton_step(ray.direction, f, &at);
        if step.w == 0.0 {
            break;
        }
        let moved = (step.x.abs() + step.y.abs() * at.d_theta.dot(at.d_theta).sqrt())
            + step.z.abs() * at.d_tau.dot(at.d_tau).sqrt();
        if moved <= STEP_TOLERANCE {
            return PatchHit { t: x.t + step.x, theta: x.theta + step.y, tau: x.tau + step.z, steps: i + 1 };
        }
        let mut part = 1.0;
        let mut falls = false;
        for _ in 0..=NEWTON_HALVINGS {
            let l = x.t + step.x * part;
            let theta = x.theta + step.y * part;
            let tau = x.tau + step.z * part;
            // Far outside the patch the curve is of no use.
            if tau > -1.0 && tau < 2.0 {
                let trial = ring_point(points, patch, theta, tau);
                let g = (ray.origin + ray.direction * l) - trial.point;
                let g_sq = g.dot(g);
                if g_sq < error_sq {
                    x = PatchHit { t: l, theta, tau, steps: i + 1 };
                    at = trial;
                    f = g;
                    error_sq = g_sq;
                    falls = true;
                    break;
                }
                if error_sq <= RESIDUAL_NOISE * RESIDUAL_NOISE {
                    x.steps = i + 1;
                    return x;
                }
            }
            part *= 0.5;
        }
        if !falls {
            break;
        }
    }
    PatchHit { t: FAR, ..x }
}

/// The root of F in [a, b], at whose ends F has different signs: regula falsi (Illinois) with a bisection
/// every third time.
fn bracketed_root(points: &[Vec2], patch: &Patch, ray: &LocalRay, a: f32, b: f32, side: f32) -> PatchHit {
    let mut low = a;
    let mut high = b;
    let mut f_low = profile_offset(points, patch, chord_point(patch, ray, low, side)).x;
    let mut f_high = profile_offset(points, patch, chord_point(patch, ray, high, side)).x;
    let rising = f_high >= 0.0;
    let mut l = 0.5 * (low + high);
    for i in 0..60 {
        let secant = low - f_low * ((high - low) / (f_high - f_low));
        let bisect = i % 3 == 2 || !(secant > low && secant < high);
        l = if bisect { 0.5 * (low + high) } else { secant };
        if l <= low || l >= high {
            break;
        }
        let f = profile_offset(points, patch, chord_point(patch, ray, l, side)).x;
        if (f >= 0.0) == rising {
            high = l;
            f_high = f;
            f_low *= 0.5;
        } else {
            low = l;
            f_low = f;
            f_high *= 0.5;
        }
    }
    let at = chord_point(patch, ray, l, side);
    if at.x < -END_TOLERANCE || at.x > patch.length + END_TOLERANCE {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * l;
    let z = ray.origin.z + ray.direction.z * l;
    PatchHit { t: l, theta: arctan2(z, x), tau: tau_at(points, patch, at.x), steps: BRACKETED }
}

/// The root of F between the chord points `a` and `b` at the distances `l_a` and `l_b`, where F has different
/// signs. `slack` is how far in s, per unit of |F|, the root can lie from a place in between.
fn find_root(
    points: &[Vec2],
    patch: &Patch,
    ray: &LocalRay,
    l_a: f32,
    l_b: f32,
    a: ChordPoint,
    b: ChordPoint,
    slack: f32,
    side: f32,
) -> PatchHit {
    // h = 0 is the cone over the chord.
    let rise = b.y - a.y;
    let part = if rise.abs() > 1e-12 { (-a.y / rise).clamp(0.0, 1.0) } else { 0.5 };
    let mut l = l_a + (l_b - l_a) * part;
    let mut at = chord_point(patch, ray, l, side);
    for _ in 0..2 {
        if at.w.abs() > 1e-12 {
            l = (l - at.y / at.w).clamp(l_a, l_b);
            at = chord_point(patch, ray, l, side);
        }
    }
    let reach = (patch.phi_max.max(-patch.phi_min) + at.y.abs()) * slack + END_TOLERANCE;
    if at.x < -reach || at.x > patch.length + reach {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * l;
    let z = ray.origin.z + ray.direction.z * l;
    let tau = (at.x / patch.length).clamp(0.0, 1.0);
    let root = newton(points, patch, ray, PatchHit { t: l, theta: arctan2(z, x), tau, steps: 0 });
    let over = END_TOLERANCE / patch.length;
    if root.t >= l_a && root.t <= l_b && root.tau >= -over && root.tau <= 1.0 + over {
        return PatchHit { tau: root.tau.clamp(0.0, 1.0), ..root };
    }
    let bracketed = bracketed_root(points, patch, ray, l_a, l_b, side);
    PatchHit { steps: bracketed.steps | root.steps, ..bracketed }
}

/// Range (low, high) of F' between two chord points, where h' and s' are monotone and phi' lies in
/// [d_phi_low, d_phi_high].
fn slope_range(a: ChordPoint, b: ChordPoint, d_phi_low: f32, d_phi_high: f32) -> Vec2 {
    let s_low = a.z.min(b.z);
    let s_high = a.z.max(b.z);
    let least =
        (d_phi_low * s_low).min(d_phi_low * s_high).min((d_phi_high * s_low).min(d_phi_high * s_high));
    let most = (d_phi_low * s_low).max(d_phi_low * s_high).max((d_phi_high * s_low).max(d_phi_high * s_high));
    Vec2::new(a.w.min(b.w) - most, a.w.max(b.w) - least)
}

/// The first root of F in [begin, end], which lies on one side of the closest approach to the axis.
fn first_root(points: &[Vec2], patch: &Patch, ray: &LocalRay, begin: f32, end: f32, side: f32) -> PatchHit {
    if begin >= end {
        return patch_miss();
    }
    let least = (end - begin) * MARCH_LEAST;
    let mut width = end - begin;
    let mut l = begin;
    let mut a = chord_point(patch, ray, l, side);
    for _ in 0..MARCH_LIMIT {
        if l >= end {
            break;
        }
        let next = (l + width).min(end);
        let b = chord_point(patch, ray, next, side);
        // A function whose slope lies in an interval leaves the line between its ends by at most a quarter of
        // that interval times the distance.
        let quarter = 0.25 * (next - l);
        let bow_s = (b.z - a.z).abs() * quarter + END_TOLERANCE;
        let bow_h = (b.w - a.w).abs() * quarter;
        let s_low = a.x.min(b.x) - bow_s;
        let s_high = a.x.max(b.x) + bow_s;
        let past = (-s_low).max(s_high - patch.length).max(0.0) * patch.slope;
        let outside = s_low > patch.length
            || s_high < 0.0
            || a.y.min(b.y) - bow_h > patch.phi_max + past
            || a.y.max(b.y) + bow_h < patch.phi_min - past;
        if !outside {
            let mut range = slope_range(a, b, -patch.slope, patch.slope);
            let mut crosses = false;
            if range.x > 0.0 || range.y < 0.0 {
                crosses = above_profile(points, patch, a) != above_profile(points, patch, b);
            } else {
                let f_a = profile_offset(points, patch, a);
                let f_b = profile_offset(points, patch, b);
                // While s runs one way, phi' is known from its ends.
                if (a.z > 0.0) == (b.z > 0.0) {
                    range =
                        slope_range(a, b, f_a.y.min(f_b.y) - patch.wobble, f_a.y.max(f_b.y) + patch.wobble);
                }
                let bow = (range.y - range.x) * quarter;
                if f_a.x.min(f_b.x) - bow <= 0.0 && f_a.x.max(f_b.x) + bow >= 0.0 {
                    if range.x <= 0.0 && range.y >= 0.0 && width > least {
                        width *= 0.5;
                        continue;
                    }
                    crosses = (f_a.x >= 0.0) != (f_b.x >= 0.0);
                }
            }
            if crosses {
                let most_ds = a.z.abs().max(b.z.abs());
                let steepness = range.x.max(-range.y) - patch.slope * most_ds;
                let slack = if steepness > 0.0 { 1.01 * most_ds / steepness } else { FAR };
                let root = find_root(points, patch, ray, l, next, a, b, slack, side);
                if root.t < FAR {
                    return root;
                }
            }
        }
        l = next;
        a = b;
        width *= 2.0;
    }
    patch_miss()
}

/// The first hit of the ray with the patch's whole ring at a distance within (t_min, t_max), scene units.
/// `direction` is unit.
pub fn intersect_patch(
    points: &[Vec2],
    revolution: &Revolution,
    patch: &Patch,
    origin: Vec3,
    direction: Vec3,
    t_min: f32,
    t_max: f32,
) -> PatchHit {
    let ray = local_ray(revolution, origin, direction);
    let o = ray.origin;
    let d = ray.direction;
    let mut begin = (t_min - ray.start) * revolution.inv_scale;
    let mut end = (t_max - ray.start) * revolution.inv_scale;
    // The slab of the ring's heights.
    if d.y.abs() > 1e-30 {
        let l0 = (patch.y_min - o.y) / d.y;
        let l1 = (patch.y_max - o.y) / d.y;
        begin = begin.max(l0.min(l1));
        end = end.min(l0.max(l1));
    } else if o.y < patch.y_min || o.y > patch.y_max {
        return patch_miss();
    }
    // Its outer cylinder, and its inner one, which holds nothing.
    let a = (d.x * d.x + d.z * d.z).max(1e-20);
    let l_axis = -(o.x * d.x + o.z * d.z) / a;
    let x = o.x + d.x * l_axis;
    let z = o.z + d.z * l_axis;
    let axis_sq = x * x + z * z;
    let outer_sq = patch.r_max * patch.r_max - axis_sq;
    if outer_sq < 0.0 {
        return patch_miss();
    }
    let outer = (outer_sq / a).sqrt();
    let inner = ((patch.r_min * patch.r_min - axis_sq).max(0.0) / a).sqrt();
    begin = begin.max(l_axis - outer);
    end = end.min(l_axis + outer);
    let mut hit = first_root(points, patch, &ray, begin, end.min(l_axis - inner), -1.0);
    if hit.t >= FAR {
        hit = first_root(points, patch, &ray, begin.max(l_axis + inner), end, 1.0);
    }
    if hit.t < FAR {
        let t = ray.start + hit.t * revolution.scale;
        hit.t = if t > t_min && t < t_max { t } else { FAR };
    }
    hit
}

/// The surface at (theta, tau) of a hit.
pub fn revolution_surface(
    points: &[Vec2],
    revolution: &Revolution,
    patch: &Patch,
    theta: f32,
    tau: f32,
) -> RevolutionSurface {
    let at = ring_point(points, patch, theta, tau);
    let (sin, cos) = sin_cos(theta);
    // The tangent alone gives the normal, on the axis too; at a cusp the tangent next to it stands in.
    let mut tangent = profile_point(points, patch, tau);
    if tangent.z * tangent.z + tangent.w * tangent.w <= 1e-8 * patch.length * patch.length {
        tangent = profile_point(points, patch, tau + (0.5 - tau) * 0.001);
    }
    let dr = patch.axis.x * tangent.z + patch.axis.y * tangent.w;
    let dy = patch.axis.y * tangent.z - patch.axis.x * tangent.w;
    let n = unit(Vec3::new(dy * cos, -dr, dy * sin));
    let p = at.point * revolution.scale;
    let position =
        revolution.center + ((revolution.x_axis * p.x + revolution.y_axis * p.y) + revolution.z_axis * p.z);
    let normal = (revolution.x_axis * n.x + revolution.y_axis * n.y) + revolution.z_axis * n.z;
    let c = revolution.center;
    let size = revolution.scale + c.x.abs().max(c.y.abs()).max(c.z.abs());
    let t = patch.t0 + (patch.t1 - patch.t0) * tau;
    RevolutionSurface {
        position,
        error: POSITION_ERROR * size,
        normal,
        uv: Vec2::new(0.5 - theta / TAU, (patch.segment as f32 + t) / revolution.segments as f32),
    }
}
