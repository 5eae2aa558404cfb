//! The body of the car as an implicit surface, and its unwrapping: x = forward, y = up, z = to the right,
//! the ground at y = 0, in metres.

use crate::assets::numbers::{lerp, sin_cos};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Where the axles are, along x.
pub const AXLES: [f64; 2] = [1.22, -1.2];
/// Height of the axles, which is the radius of the tyres.
pub const WHEEL_RADIUS: f64 = 0.315;
/// Radius of the wheel arches about the axles.
const ARCH_RADIUS: f64 = 0.375;
/// Height of the body's lower edge.
pub const SILL: f64 = 0.22;
/// The lowest and highest angle of the unwrapping, about the axis at height [`AXIS_HEIGHT`].
const ANGLES: (f64, f64) = (-PI / 3.0, FRAC_PI_2);
/// Height of the axis about which the sections are unwrapped.
pub const AXIS_HEIGHT: f64 = 0.57;

/// Square root of the root of the sum of fourth powers: a rounded box where `length` is an ellipse.
fn length4(a: f64, b: f64) -> f64 {
    (a * a * a * a + b * b * b * b).sqrt().sqrt()
}

/// The smaller of `a` and `b`, rounded where they differ by less than `k` (polynomial smooth minimum).
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
    let front = ellipsoid(DVec3::new(AXLES[0] + 0.02, 0.45, 0.60), DVec3::new(0.62, 0.40, 0.20));
    let rear = ellipsoid(DVec3::new(AXLES[1] + 0.02, 0.45, 0.60), DVec3::new(0.60, 0.40, 0.21));
    let trunk = smooth_min(smooth_min(hull, bonnet, 0.16), tail, 0.16);
    let shell = smooth_min(trunk, cabin, 0.10);
    smooth_min(smooth_min(shell, front, 0.09), rear, 0.09)
}

/// The outward unit normal of [`body`] at `p`.
pub fn body_normal(p: DVec3) -> DVec3 {
    let e = 1e-4;
    let slope = |axis: DVec3| body(p + axis * e) - body(p - axis * e);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize()
}

/// The last point inside the body on the way from `from`, a point outside, back along `toward`: where a ray
/// from outside meets it. None if it does not, within `reach`.
pub fn meet(from: DVec3, toward: DVec3, reach: f64) -> Option<DVec3> {
    let steps = 120;
    let at = |t: f64| from + toward * (reach * t);
    let k = (1..=steps).find(|&k| body(at(f64::from(k) / f64::from(steps))) < 0.0)?;
    let (mut out, mut inside) = (f64::from(k - 1) / f64::from(steps), f64::from(k) / f64::from(steps));
    for _ in 0..24 {
        let middle = 0.5 * (out + inside);
        if body(at(middle)) < 0.0 { inside = middle } else { out = middle }
    }
    Some(at(out))
}

/// The body's right half unwrapped: `u` from nose to tail, `v` from under the sill to the roof's middle.
pub struct Unwrapping {
    /// (arc length from the nose as a fraction, x), fine enough for linear interpolation.
    table: Vec<(f64, f64)>,
}

impl Unwrapping {
    /// Measures the body.
    pub fn new() -> Unwrapping {
        let end = |sign: f64| {
            meet(DVec3::new(2.5 * sign, AXIS_HEIGHT, 0.0), -DVec3::X * sign, 2.0).map_or(sign, |p| p.x)
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

    /// The v of the body's lower edge at `x`: the sill, or the rim of a wheel arch.
    pub fn lower_edge(&self, x: f64) -> f64 {
        let low = AXLES.iter().fold(SILL, |low, axle| {
            let square = ARCH_RADIUS * ARCH_RADIUS - (x - axle) * (x - axle);
            if square > 0.0 { low.max(WHEEL_RADIUS + square.sqrt()) } else { low }
        });
        let (mut below, mut above) = (0.0, 0.7);
        for _ in 0..40 {
            let v = 0.5 * (below + above);
            if at_angle(x, lerp(ANGLES.0, ANGLES.1, v)).y < low { below = v } else { above = v }
        }
        above
    }

    /// Stations from nose to tail as u, with one at each edge of each arch and more beside these.
    pub fn stations(&self) -> Vec<f64> {
        let half = (ARCH_RADIUS * ARCH_RADIUS - (WHEEL_RADIUS - SILL) * (WHEEL_RADIUS - SILL)).sqrt();
        let mut stations = Vec::new();
        let mut even = |from: f64, to: f64, count: u32| {
            stations.extend((0..count).map(|k| lerp(from, to, f64::from(k) / f64::from(count))));
        };
        let edges = AXLES.map(|axle| (self.u(axle + half), self.u(axle - half)));
        even(0.0, edges[0].0, 14);
        let arch = |edges: (f64, f64)| -> Vec<f64> {
            let c = |k: u32| 0.5 - 0.5 * sin_cos(FRAC_PI_2 - PI * f64::from(k) / 16.0).0;
            (0..16).map(|k| lerp(edges.0, edges.1, c(k))).collect()
        };
        let mut middle = Vec::new();
        let count = 16;
        middle.extend((0..count).map(|k| lerp(edges[0].1, edges[1].0, f64::from(k) / f64::from(count))));
        let tail: Vec<f64> = (0..=14).map(|k| lerp(edges[1].1, 1.0, f64::from(k) / 14.0)).collect();
        stations.extend(arch(edges[0]));
        stations.extend(middle);
        stations.extend(arch(edges[1]));
        stations.extend(tail);
        stations
    }
}

/// Whether the section at `x` passes through a wheel well.
pub fn in_arch(x: f64) -> bool {
    AXLES.iter().any(|axle| (x - axle).abs() < ARCH_RADIUS)
}

/// Bends [-1, 1] so that samples crowd at both ends.
fn ends_closer(x: f64) -> f64 {
    x * (1.5 - 0.5 * x * x)
}

/// The mean radius of the section at `x`.
fn radius(x: f64) -> f64 {
    let centre = DVec3::new(x, AXIS_HEIGHT, 0.0);
    [0.0, 0.5, 1.0].iter().map(|v| at_angle(x, v * FRAC_PI_2) - centre).map(DVec3::length).sum::<f64>() / 3.0
}

/// Where the section at `x` is met by a ray that comes in at `angle` (0: level, pi/2: from above).
fn at_angle(x: f64, angle: f64) -> DVec3 {
    let (s, c) = sin_cos(angle);
    let out = DVec3::new(0.0, s, c);
    let centre = DVec3::new(x, AXIS_HEIGHT, 0.0);
    meet(centre + out * 1.2, -out, 1.2).unwrap_or(centre)
}
