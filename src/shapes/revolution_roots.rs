//! Intersection of a ray with one patch of a surface of revolution. Twin:
//! `shaders/shapes/revolution_roots.wgsl`.
//!
//! In the half-plane (radius, y) a ray is a branch of a hyperbola: radius(l) = sqrt(x^2 + z^2) is
//! convex in the distance l, and y(l) is linear. On either side of the closest approach to the axis
//! both are monotone, so the chord coordinates s(l) and h(l) are bounded by their values and slopes
//! at the ends. The hits are the zeros of F(l) = h(l) - phi(s(l)). The search steps along the ray
//! over intervals that contain no root (by the range of F) or at most one (F' has a constant sign
//! there); other intervals are halved. A root is found by damped Newton iteration on the 3x3
//! system, started from the cone over the chord. If that system is singular (axis, silhouette,
//! cusp) or the iteration leaves the interval, a bracketed solve of F in l alone takes over, which
//! is regular everywhere.

use super::real::{Real, Vec2, Vec3, Vec4, root_roundings, roundings};

use super::math::FAR;
use super::math::trig::arctan2;
use super::revolution_profile::{
    LocalRay, Patch, RayPoint, RingPoint, profile_offset, ray_point, ring_point,
};

/// Greatest number of Newton steps.
pub const NEWTON_STEPS: u32 = 15;
/// Greatest number of times that one Newton step is halved.
pub const NEWTON_HALVINGS: u32 = 10;
/// Bit of [`PatchHit::steps`] that is set if the bracketed solve found the root.
pub const BRACKETED: u32 = 256;
/// Greatest number of intervals examined on one side of the axis.
const MARCH_LIMIT: u32 = 256;
/// Shortest interval, as a fraction of the first: closer pairs of roots are grazing hits that
/// rounding creates or removes.
const MARCH_LEAST: Real = root_roundings(1.0 / 8192.0);
/// Length by which a patch extends past its ends, in local units: several roundings of a local
/// coordinate.
const END_TOLERANCE: Real = roundings(3e-7);
/// Newton steps shorter than this (local units) may be pure rounding; see
/// [`Patch::step_tolerance`].
pub const STEP_TOLERANCE: Real = roundings(4e-7);
/// Residuals up to this size (local units) may be pure rounding.
const RESIDUAL_NOISE: Real = roundings(1e-6);

/// Hit of a ray with a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchHit {
    /// Distance along the ray, scene units ([`first_root`] returns local units); [`FAR`] if there
    /// is no hit.
    pub t: Real,
    /// Angle about the axis, radians.
    pub theta: Real,
    /// Parameter of the patch, 0 to 1.
    pub tau: Real,
    /// Newton steps taken, plus [`BRACKETED`].
    pub steps: u32,
}

/// Returns a miss.
pub fn patch_miss() -> PatchHit {
    PatchHit { t: FAR, theta: 0.0, tau: 0.0, steps: 0 }
}

/// One Newton step (dl, dtheta, dtau) for f = o + l d - S, and the determinant D = d . (S_theta x
/// S_tau); zero if D is negligible.
pub fn newton_step(direction: Vec3, f: Vec3, at: &RingPoint) -> Vec4 {
    let det = direction.dot(at.d_theta.cross(at.d_tau));
    if det * det <= (roundings(1e-8) * at.d_theta.dot(at.d_theta)) * at.d_tau.dot(at.d_tau) {
        return Vec4::ZERO;
    }
    let g = at.d_tau.cross(f);
    let dl = -at.d_theta.dot(g) / det;
    let d_theta = -direction.dot(g) / det;
    let d_tau = direction.dot(at.d_theta.cross(f)) / det;
    Vec4::new(dl, d_theta, d_tau, det)
}

/// Damped Newton iteration from (l, theta, tau), with l stored in `t`; `t` is [`FAR`] if it does
/// not converge.
fn newton(points: &[Vec2], piece: &Patch, ray: &LocalRay, start: PatchHit) -> PatchHit {
    let mut x = start;
    let mut error_sq = FAR;
    let mut step = Vec4::ZERO;
    let mut part = 1.0;
    let mut halvings = 0;
    for _ in 0..(NEWTON_STEPS + 1) * (NEWTON_HALVINGS + 1) {
        let l = x.t + step.x * part;
        let theta = x.theta + step.y * part;
        let tau = x.tau + step.z * part;
        let at = ring_point(points, piece, theta, tau);
        let f = (ray.origin + ray.direction * l) - at.point;
        let f_sq = f.dot(f);
        // accept the step if it reduces the residual; the curve is meaningless far outside the
        // patch
        if f_sq < error_sq && tau > -1.0 && tau < 2.0 {
            x = PatchHit { t: l, theta, tau, steps: x.steps };
            error_sq = f_sq;
            step = newton_step(ray.direction, f, &at);
            if step.w == 0.0 || x.steps == NEWTON_STEPS {
                break;
            }
            x.steps += 1;
            let moved = (step.x.abs() + step.y.abs() * at.d_theta.dot(at.d_theta).sqrt())
                + step.z.abs() * at.d_tau.dot(at.d_tau).sqrt();
            if moved <= piece.step_tolerance {
                return PatchHit {
                    t: x.t + step.x,
                    theta: x.theta + step.y,
                    tau: x.tau + step.z,
                    steps: x.steps,
                };
            }
            part = 1.0;
            halvings = 0;
        } else {
            // otherwise halve the step, unless the residual is already down to rounding
            if error_sq <= RESIDUAL_NOISE * RESIDUAL_NOISE {
                return x;
            }
            halvings += 1;
            if halvings > NEWTON_HALVINGS {
                break;
            }
            part *= 0.5;
        }
    }
    PatchHit { t: FAR, ..x }
}

/// Root of F between `a` and `b`, where F has opposite signs: regula falsi (Illinois) with a
/// bisection in every third step.
fn bracketed_root(
    points: &[Vec2],
    piece: &Patch,
    ray: &LocalRay,
    a: RayPoint,
    b: RayPoint,
) -> PatchHit {
    let mut low = a.l;
    let mut high = b.l;
    let mut f_low = 0.0;
    let mut f_high = 0.0;
    let mut rising = false;
    let mut at = a;
    let mut tau = 0.0;
    for i in 0..64 {
        let offset = profile_offset(points, piece, at, true);
        let f = offset.x;
        tau = offset.z;
        if i == 0 {
            f_low = f;
            at = b;
            continue;
        }
        if i == 1 {
            f_high = f;
            rising = f >= 0.0;
        } else if (f >= 0.0) == rising {
            high = at.l;
            f_high = f;
            f_low *= 0.5;
        } else {
            low = at.l;
            f_low = f;
            f_high *= 0.5;
        }
        let secant = low - f_low * ((high - low) / (f_high - f_low));
        let bisect = i % 3 == 0 || !(secant > low && secant < high);
        let l = if bisect { 0.5 * (low + high) } else { secant };
        if l <= low || l >= high {
            break;
        }
        at = ray_point(piece, ray, l);
    }
    if at.s < -END_TOLERANCE || at.s > piece.length + END_TOLERANCE {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * at.l;
    let z = ray.origin.z + ray.direction.z * at.l;
    PatchHit { t: at.l, theta: arctan2(z, x), tau, steps: BRACKETED }
}

/// Root of F between the chord points `a` and `b`, where F has opposite signs. `slack` bounds the
/// distance in s between the root and a point in between, per unit of |F| at that point.
fn find_root(
    points: &[Vec2],
    piece: &Patch,
    ray: &LocalRay,
    a: RayPoint,
    b: RayPoint,
    slack: Real,
) -> PatchHit {
    // initial guess: h = 0 is the cone over the chord; two Newton steps refine it
    let rise = b.h - a.h;
    let part = if rise.abs() > 1e-12 { (-a.h / rise).clamp(0.0, 1.0) } else { 0.5 };
    let mut l = a.l + (b.l - a.l) * part;
    let mut at = ray_point(piece, ray, l);
    for _ in 0..2 {
        if at.dh.abs() > 1e-12 {
            l = (l - at.h / at.dh).clamp(a.l, b.l);
            at = ray_point(piece, ray, l);
        }
    }
    let reach = (piece.phi_max.max(-piece.phi_min) + at.h.abs()) * slack + END_TOLERANCE;
    if at.s < -reach || at.s > piece.length + reach {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * l;
    let z = ray.origin.z + ray.direction.z * l;
    let tau = (at.s / piece.length).clamp(0.0, 1.0);
    // solve the 3x3 system; if that fails, solve F by bracketing
    let root = newton(points, piece, ray, PatchHit { t: l, theta: arctan2(z, x), tau, steps: 0 });
    let over = END_TOLERANCE / piece.length;
    if root.t >= a.l && root.t <= b.l && root.tau >= -over && root.tau <= 1.0 + over {
        return PatchHit { tau: root.tau.clamp(0.0, 1.0), ..root };
    }
    let bracketed = bracketed_root(points, piece, ray, a, b);
    PatchHit { steps: bracketed.steps | root.steps, ..bracketed }
}

/// Range (low, high) of F' between two chord points, given that h' and s' are monotone and phi'
/// lies in [d_phi_low, d_phi_high].
fn slope_range(a: RayPoint, b: RayPoint, d_phi_low: Real, d_phi_high: Real) -> Vec2 {
    let s_low = a.ds.min(b.ds);
    let s_high = a.ds.max(b.ds);
    let least = (d_phi_low * s_low)
        .min(d_phi_low * s_high)
        .min((d_phi_high * s_low).min(d_phi_high * s_high));
    let most = (d_phi_low * s_low)
        .max(d_phi_low * s_high)
        .max((d_phi_high * s_low).max(d_phi_high * s_high));
    Vec2::new(a.dh.min(b.dh) - most, a.dh.max(b.dh) - least)
}

/// First root of F in [begin, end], an interval on one side of the closest approach to the axis.
pub fn first_root(
    points: &[Vec2],
    piece: &Patch,
    ray: &LocalRay,
    begin: Real,
    end: Real,
) -> PatchHit {
    if begin >= end {
        return patch_miss();
    }
    let least = (end - begin) * MARCH_LEAST;
    let mut width = end - begin;
    let mut l = begin;
    let mut a = ray_point(piece, ray, l);
    for _ in 0..MARCH_LIMIT {
        if l >= end {
            break;
        }
        let next = (l + width).min(end);
        let b = ray_point(piece, ray, next);
        // a function whose slope lies in an interval deviates from its chord by at most a quarter
        // of that interval's width times the distance
        let quarter = 0.25 * (next - l);
        let bow_s = (b.ds - a.ds).abs() * quarter + END_TOLERANCE;
        let bow_h = (b.dh - a.dh).abs() * quarter;
        let s_low = a.s.min(b.s) - bow_s;
        let s_high = a.s.max(b.s) + bow_s;
        let past = (-s_low).max(s_high - piece.length).max(0.0) * piece.slope;
        let outside = s_low > piece.length
            || s_high < 0.0
            || a.h.min(b.h) - bow_h > piece.phi_max + past
            || a.h.max(b.h) + bow_h < piece.phi_min - past;
        // bound F' by the slope limit of the patch; unless F' may change sign, the sign of F
        // suffices
        if !outside {
            let mut range = slope_range(a, b, -piece.slope, piece.slope);
            let exact = range.x <= 0.0 && range.y >= 0.0;
            let mut f_a = Vec3::ZERO;
            let mut f_b = Vec3::ZERO;
            for i in 0..2 {
                f_a = f_b;
                f_b = profile_offset(points, piece, if i == 0 { a } else { b }, exact);
            }
            // if s is monotone, its ends bound phi'
            if exact && (a.ds > 0.0) == (b.ds > 0.0) {
                range = slope_range(
                    a,
                    b,
                    f_a.y.min(f_b.y) - piece.wobble,
                    f_a.y.max(f_b.y) + piece.wobble,
                );
            }
            // halve the interval if it may contain more than one root
            let bow = (range.y - range.x) * quarter;
            let touches =
                !exact || (f_a.x.min(f_b.x) - bow <= 0.0 && f_a.x.max(f_b.x) + bow >= 0.0);
            if touches && range.x <= 0.0 && range.y >= 0.0 && width > least {
                width *= 0.5;
                continue;
            }
            // at most one root is left: find it if F changes sign
            let crosses = touches && (f_a.x >= 0.0) != (f_b.x >= 0.0);
            if crosses {
                let most_ds = a.ds.abs().max(b.ds.abs());
                let steepness = range.x.max(-range.y) - piece.slope * most_ds;
                let slack = if steepness > 0.0 { 1.01 * most_ds / steepness } else { FAR };
                let root = find_root(points, piece, ray, a, b, slack);
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
