//! Bezier curves and Bernstein polynomials on the host, in f64.

use glam::DVec2;
use std::ops::{Add, Mul};

/// Control points of the part of a Bezier curve (or Bernstein polynomial) over [a, b], by two de
/// Casteljau subdivisions.
pub fn restrict<T>(points: &[T], a: f64, b: f64) -> Vec<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let (_, upper) = split(points, a);
    if b >= 1.0 {
        return upper;
    }
    split(&upper, (b - a) / (1.0 - a)).0
}

/// Control points over [0, t] and over [t, 1].
pub fn split<T>(points: &[T], t: f64) -> (Vec<T>, Vec<T>)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let mut b = points.to_vec();
    let n = b.len();
    let mut lower = Vec::with_capacity(n);
    for k in 1..=n {
        lower.push(b[0]);
        for i in 0..n - k {
            b[i] = b[i] * (1.0 - t) + b[i + 1] * t;
        }
    }
    (lower, b)
}

/// Point of the curve at `t`.
pub fn point(points: &[DVec2], t: f64) -> DVec2 {
    split(points, t).1.first().copied().unwrap_or_default()
}

/// Control points of the derivative curve; empty for a single point.
pub fn derivative(points: &[DVec2]) -> Vec<DVec2> {
    let n = points.len().saturating_sub(1) as f64;
    points.windows(2).map(|w| (w[1] - w[0]) * n).collect()
}

/// Positions in (0, 1) at which the Bernstein polynomial changes its sign or touches zero, sorted,
/// accurate to about 1e-13. Empty for a polynomial within `noise` of zero everywhere.
pub fn roots(coefficients: &[f64], noise: f64) -> Vec<f64> {
    let mut found = Vec::new();
    if coefficients.iter().any(|c| c.abs() > noise) {
        isolate(coefficients, 0.0, 1.0, &mut found);
    }
    // a double root is accurate to half the digits: merge its two sides
    found.retain(|&t| t > 1e-6 && t < 1.0 - 1e-6);
    found.dedup_by(|b, a| *b - *a < 1e-6);
    found
}

fn isolate(c: &[f64], a: f64, b: f64, found: &mut Vec<f64>) {
    // the polynomial lies in the convex hull of its coefficients
    if c.iter().all(|&x| x > 0.0) || c.iter().all(|&x| x < 0.0) {
        return;
    }
    let middle = 0.5 * (a + b);
    if b - a < 1e-13 {
        if found.last().is_none_or(|&t| middle - t > 1e-9) {
            found.push(middle);
        }
        return;
    }
    let (lower, upper) = split(c, 0.5);
    isolate(&lower, a, middle, found);
    isolate(&upper, middle, b, found);
}

#[cfg(test)]
mod tests {
    use super::*;

    // Theory: de Casteljau subdivision describes the same curve; the roots of (t - 1/4)(t - 3/4)^2
    // are 1/4 and the double root 3/4.
    #[test]
    fn restriction_is_the_same_curve() {
        let p = [
            DVec2::new(0.0, 0.0),
            DVec2::new(1.0, 0.2),
            DVec2::new(0.3, 0.7),
            DVec2::new(0.5, 1.0),
        ];
        let q = restrict(&p, 0.3, 0.8);
        for i in 0..=10 {
            let s = f64::from(i) / 10.0;
            assert!(point(&q, s).distance(point(&p, 0.3 + 0.5 * s)) < 1e-15);
        }
        assert!(point(&q, 0.5).distance(point(&p, 0.54)) > 1e-3);
    }

    #[test]
    fn roots_are_found() {
        // t^3 - 7/4 t^2 + 15/16 t - 9/64 in Bernstein form.
        let (c1, c2, c3, c0) = (15.0 / 16.0, -7.0 / 4.0, 1.0, -9.0 / 64.0);
        let b = [c0, c0 + c1 / 3.0, c0 + 2.0 * c1 / 3.0 + c2 / 3.0, c0 + c1 + c2 + c3];
        let r = roots(&b, 0.0);
        assert_eq!(r.len(), 2, "{r:?}");
        assert!((r[0] - 0.25).abs() < 1e-9 && (r[1] - 0.75).abs() < 1e-6, "{r:?}");
        assert!(roots(&[1.0, 0.1, 1.0], 0.0).is_empty());
    }
}
