//! The body of the car as an implicit surface, and its unwrapping: x = forward, y = up, z = to the
//! right, the ground at y = 0, in metres.

use crate::assets::numbers::{lerp, sin_cos, smoothstep};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Where the axles are, along x.
pub const AXLES: [f64; 2] = [1.22, -1.2];
/// Height of the axles, which is the radius of the tyres.
pub const WHEEL_RADIUS: f64 = 0.315;
/// Radius of the wheel arches about the axles.
const ARCH_RADIUS: f64 = 0.375;
/// Over what length, along x, the arches run out into the sill.
const ARCH_FOOT: f64 = 0.06;
/// Height of the underside between the wheel wells.
pub const FLOOR: f64 = 0.2;
/// The v of the sill in the unwrapping.
const SILL_V: f64 = 0.33;
/// The lowest and highest angle of the unwrapping, about the axis at height [`AXIS_HEIGHT`].
const ANGLES: (f64, f64) = (-FRAC_PI_2, FRAC_PI_2);
/// Height of the axis about which the sections are unwrapped.
pub const AXIS_HEIGHT: f64 = 0.57;

/// Square root of the root of the sum of fourth powers: a rounded box where `length` is an ellipse.
fn length4(a: f64, b: f64) -> f64 {
    (a * a * a * a + b * b * b * b).sqrt().sqrt()
}

/// The smaller of `a` and `b`, rounded where they differ by less than `k` (polynomial smooth
/// minimum).
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0);
    a.min(b) - h * h / (4.0 * k)
}

/// Below zero inside the body, above outside; about the distance near the surface.
pub fn body(p: DVec3) -> f64 {
    let z = p.z.abs();
    let ellipsoid = |c: DVec3, r: DVec3| {
        let q = (DVec3::new(p.x, p.y, z) - c) / r;
        (q.length() - 1.0) * r.min_element()
    };
    let hull = {
        let q = (p - DVec3::new(-0.02, 0.56, 0.0)) / DVec3::new(1.88, 0.37, 0.70);
        (length4(q.x, length4(q.y, q.z)) - 1.0) * 0.37
    };
    let cabin = {
        let q = (p - DVec3::new(-0.36, 0.72, 0.0)) / DVec3::new(1.28, 0.72, 0.665);
        (DVec2::new(q.x, length4(q.y, q.z)).length() - 1.0) * 0.6
    };
    let bonnet = ellipsoid(DVec3::new(0.85, 0.56, 0.0), DVec3::new(1.14, 0.46, 0.58));
    let tail = ellipsoid(DVec3::new(-0.95, 0.58, 0.0), DVec3::new(1.10, 0.44, 0.60));
    let front = ellipsoid(DVec3::new(AXLES[0] + 0.02, 0.45, 0.57), DVec3::new(0.60, 0.40, 0.22));
    let rear = ellipsoid(DVec3::new(AXLES[1] + 0.02, 0.45, 0.57), DVec3::new(0.58, 0.40, 0.23));
    let trunk = smooth_min(smooth_min(hull, bonnet, 0.16), tail, 0.16);
    let shell = smooth_min(trunk, cabin, 0.10);
    smooth_min(smooth_min(shell, front, 0.15), rear, 0.15)
}

/// The outward unit normal of [`body`] at `p`.
pub fn body_normal(p: DVec3) -> DVec3 {
    let e = 1e-4;
    let slope = |axis: DVec3| body(p + axis * e) - body(p - axis * e);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize()
}

/// The last point inside the body on the way from `from`, a point outside, back along `toward`:
/// where a ray from outside meets it. None if it does not, within `reach`.
pub fn meet(from: DVec3, toward: DVec3, reach: f64) -> Option<DVec3> {
    let steps = 120;
    let at = |t: f64| from + toward * (reach * t);
    let k = (1..=steps).find(|&k| body(at(f64::from(k) / f64::from(steps))) < 0.0)?;
    let (mut out, mut inside) =
        (f64::from(k - 1) / f64::from(steps), f64::from(k) / f64::from(steps));
    for _ in 0..24 {
        let middle = 0.5 * (out + inside);
        if body(at(middle)) < 0.0 { inside = middle } else { out = middle }
    }
    Some(at(out))
}

/// The body's right half unwrapped: `u` from nose to tail, `v` from under the sill to the roof's
/// middle.
pub struct Unwrapping {
    /// (arc length from the nose as a fraction, x), fine enough for linear interpolation.
    table: Vec<(f64, f64)>,
}

impl Unwrapping {
    /// Measures the body.
    pub fn new() -> Unwrapping {
        let end = |sign: f64| {
            meet(DVec3::new(2.5 * sign, AXIS_HEIGHT, 0.0), -DVec3::X * sign, 2.0)
                .map_or(sign, |p| p.x)
        };
        let (nose, tail) = (end(1.0) - 1e-4, end(-1.0) + 1e-4);
        let (center, half) = (0.5 * (nose + tail), 0.5 * (nose - tail));
        let steps = 900;
        let mut table: Vec<(f64, f64)> = Vec::new();
        let (mut length, mut last) = (0.0, DVec2::new(nose, 0.0));
        for k in 0..=steps {
            let x = center + half * sin_cos(FRAC_PI_2 + PI * f64::from(k) / f64::from(steps)).0;
            let x = center + half * ends_closer((x - center) / half);
            let at = DVec2::new(x, self::radius(x));
            length += (at - last).length();
            last = at;
            table.push((length, x));
        }
        table.iter_mut().for_each(|entry| entry.0 /= length);
        Unwrapping { table }
    }

    /// x at the fraction `u` of the way from nose to tail.
    pub fn x(&self, u: f64) -> f64 {
        let k = self.table.partition_point(|entry| entry.0 < u).clamp(1, self.table.len() - 1);
        let ((u0, x0), (u1, x1)) = (self.table[k - 1], self.table[k]);
        lerp(x0, x1, ((u - u0) / (u1 - u0)).clamp(0.0, 1.0))
    }

    /// The fraction `u` at which `x` lies.
    pub fn u(&self, x: f64) -> f64 {
        let k = self.table.partition_point(|entry| entry.1 > x).clamp(1, self.table.len() - 1);
        let ((u0, x0), (u1, x1)) = (self.table[k - 1], self.table[k]);
        lerp(u0, u1, ((x - x0) / (x1 - x0)).clamp(0.0, 1.0))
    }

    /// The point of the surface at (u, v); its z is not negative.
    pub fn point(&self, u: f64, v: f64) -> DVec3 {
        at_angle(self.x(u), lerp(ANGLES.0, ANGLES.1, v))
    }

    /// The v of the body's lower edge at `x`: the sill, which draws in under nose and tail, or the
    /// rim of a wheel arch, which runs out into the sill.
    pub fn lower_edge(&self, x: f64) -> f64 {
        let ends = smoothstep(1.66, 1.92, x).max(smoothstep(-1.66, -1.94, x));
        let sill = SILL_V * (1.0 - ends);
        let d = AXLES.iter().map(|axle| (x - axle).abs()).fold(f64::MAX, f64::min);
        let rim = WHEEL_RADIUS + (ARCH_RADIUS * ARCH_RADIUS - d * d).max(0.0).sqrt();
        let (mut below, mut above) = (0.2, 0.8);
        for _ in 0..40 {
            let v = 0.5 * (below + above);
            if at_angle(x, lerp(ANGLES.0, ANGLES.1, v)).y < rim { below = v } else { above = v }
        }
        lerp(above, sill, smoothstep(ARCH_RADIUS, ARCH_RADIUS + ARCH_FOOT, d))
    }

    /// Stations from nose to tail as u, with one at each edge of each arch and more beside these.
    pub fn stations(&self) -> Vec<f64> {
        // x where each stretch ends, into how many steps it is cut, and whether these crowd at its
        // ends
        let mut stretches = Vec::new();
        for (axle, before) in AXLES.iter().zip([12, 16]) {
            stretches.push((axle + ARCH_RADIUS + ARCH_FOOT, before, false));
            stretches.push((axle + ARCH_RADIUS, 3, false));
            stretches.push((axle - ARCH_RADIUS, 16, true));
            stretches.push((axle - ARCH_RADIUS - ARCH_FOOT, 3, false));
        }
        stretches.push((-f64::INFINITY, 12, false));
        let mut stations = vec![0.0];
        let mut from = 0.0;
        for (x, steps, crowded) in stretches {
            let to = self.u(x.max(self.table[self.table.len() - 1].1));
            for k in 1..=steps {
                let t = f64::from(k) / f64::from(steps);
                let t = if crowded { 0.5 - 0.5 * sin_cos(FRAC_PI_2 - PI * t).0 } else { t };
                stations.push(lerp(from, to, t));
            }
            from = to;
        }
        stations
    }
}

/// Whether the section at `x` passes through a wheel well.
pub fn in_arch(x: f64) -> bool {
    AXLES.iter().any(|axle| (x - axle).abs() < ARCH_RADIUS + ARCH_FOOT)
}

/// Bends [-1, 1] so that samples crowd at both ends.
fn ends_closer(x: f64) -> f64 {
    x * (1.5 - 0.5 * x * x)
}

/// The mean radius of the section at `x`.
fn radius(x: f64) -> f64 {
    let centre = DVec3::new(x, AXIS_HEIGHT, 0.0);
    [0.0, 0.5, 1.0]
        .iter()
        .map(|v| at_angle(x, v * FRAC_PI_2) - centre)
        .map(DVec3::length)
        .sum::<f64>()
        / 3.0
}

/// Where the section at `x` is met by a ray that comes in at `angle` (0: level, pi/2: from above).
fn at_angle(x: f64, angle: f64) -> DVec3 {
    let (s, c) = sin_cos(angle);
    let out = DVec3::new(0.0, s, c);
    let centre = DVec3::new(x, AXIS_HEIGHT, 0.0);
    meet(centre + out * 1.2, -out, 1.2).unwrap_or(centre)
}
