//! Irradiance in closed form, f64. Receivers are points `x` with unit normal `n`; sources have
//! radiance 1 unless stated otherwise.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Irradiance under a polygon wholly above the horizon (Lambert 1760; Baum et al. 1989): half the
/// sum over the edges of the angle each subtends times the cosine of its plane's normal. The
/// corners run counter-clockwise seen from the lit side; the result is negative for a polygon that
/// faces away.
pub fn polygon(x: DVec3, n: DVec3, corners: &[DVec3]) -> f64 {
    let sum: f64 = (0..corners.len())
        .map(|i| {
            let a = (corners[i] - x).normalize();
            let b = (corners[(i + 1) % corners.len()] - x).normalize();
            let cross = b.cross(a);
            cross.length().atan2(a.dot(b)) * cross.normalize_or_zero().dot(n)
        })
        .sum();
    0.5 * sum
}

/// Irradiance under a sphere wholly above the horizon: pi (R/d)^2 cos.
pub fn sphere(x: DVec3, n: DVec3, center: DVec3, radius: f64) -> f64 {
    let to = center - x;
    PI * radius * radius / to.length_squared() * to.normalize().dot(n)
}

/// Irradiance at distance `a` from the axis of a parallel disc of radius `r` at height `h`.
pub fn disc(a: f64, h: f64, r: f64) -> f64 {
    let s = a * a + h * h;
    0.5 * PI * (1.0 - (s - r * r) / ((s + r * r).powi(2) - 4.0 * r * r * a * a).sqrt())
}

/// A convex surface for the midpoint rule: `n_s` x `n_t` points with their area vector elements.
/// `point(s, t)`, s and t in [0, 1], returns a point and its area vector element.
pub struct Surface(Vec<(DVec3, DVec3)>);

impl Surface {
    pub fn new(point: impl Fn(f64, f64) -> (DVec3, DVec3), n_s: u32, n_t: u32) -> Self {
        let middle = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
        let row = |i: u32| (0..n_t).map(move |j| (middle(i, n_s), middle(j, n_t)));
        Self((0..n_s).flat_map(row).map(|(s, t)| point(s, t)).collect())
    }

    /// Irradiance under the surface, wholly above the horizon.
    pub fn irradiance(&self, x: DVec3, n: DVec3) -> f64 {
        let element = |&(p, area): &(DVec3, DVec3)| {
            let to = p - x;
            let d2 = to.length_squared();
            (-to.dot(area)).max(0.0) * to.dot(n).max(0.0) / (d2 * d2)
        };
        self.0.iter().map(element).sum::<f64>() / self.0.len() as f64
    }
}

/// A cubic profile (radius, height) turned about y through `base`: point and outward area vector of
/// (t, theta / 2 pi).
pub fn revolution(base: DVec3, profile: [[f64; 2]; 4]) -> impl Fn(f64, f64) -> (DVec3, DVec3) {
    move |t, turn| {
        let s = 1.0 - t;
        let b = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let d = [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t];
        let at = |w: [f64; 4], k: usize| (0..4).map(|i| w[i] * profile[i][k]).sum::<f64>();
        let (sin, cos) = (TAU * turn).sin_cos();
        let p = base + DVec3::new(at(b, 0) * cos, at(b, 1), at(b, 0) * sin);
        let area = DVec3::new(at(d, 1) * cos, -at(d, 0), at(d, 1) * sin) * (at(b, 0) * TAU);
        (p, area)
    }
}

/// Theory: a square of side 2 a at height h seen from below its middle is four times a corner's,
/// and its quadrature must equal the polygon's sum, as a disc's must. An inscribed fine polygon
/// approaches a disc, and a sphere as a surface equals the sphere.
#[test]
fn closed_forms_agree_with_quadrature() {
    let x = DVec3::new(0.2, 0.0, -0.1);
    let n = DVec3::Y;
    let square =
        [[-0.3, 0.3], [0.3, 0.3], [0.3, -0.3], [-0.3, -0.3]].map(|c| DVec3::new(c[0], 0.7, -c[1]));
    let flat =
        |s: f64, t: f64| (DVec3::new(0.6 * s - 0.3, 0.7, 0.6 * t - 0.3), DVec3::NEG_Y * 0.36);
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 2e-5, "{a} {b}");
    close(polygon(x, n, &square), Surface::new(flat, 200, 200).irradiance(x, n));
    let ring: Vec<DVec3> = (0..4000)
        .map(|i| TAU * i as f64 / 4000.0)
        .map(|a| DVec3::new(0.4 * a.cos(), 0.6, 0.4 * a.sin()))
        .collect();
    close(disc(x.length(), 0.6, 0.4), polygon(x, n, &ring));
    let center = DVec3::new(0.3, 0.9, 0.2);
    let ball = |s: f64, t: f64| {
        let (z, (sin, cos)) = (2.0 * s - 1.0, (TAU * t).sin_cos());
        let w = DVec3::new((1.0 - z * z).sqrt() * cos, z, (1.0 - z * z).sqrt() * sin);
        (center + w * 0.25, w * 4.0 * PI * 0.0625)
    };
    close(sphere(x, n, center, 0.25), Surface::new(ball, 1000, 1000).irradiance(x, n));
    // a straight profile is a cylinder: its area vectors sum to its area
    let tube = revolution(DVec3::ZERO, [[0.5, 0.0], [0.5, 0.2], [0.5, 0.4], [0.5, 0.6]]);
    let area: f64 = (0..100).map(|i| tube(0.5, i as f64 / 100.0).1.length()).sum::<f64>() / 100.0;
    close(area, TAU * 0.5 * 0.6);
}
