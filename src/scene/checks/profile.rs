//! Checks of the Bezier profiles of surfaces of revolution.

use std::ops::Range;

use glam::DVec2;

use crate::scene::diagnostics::Report;

/// Largest gap between two joined segments, relative to the extent of the profile.
const JOIN_TOLERANCE: f64 = 1e-9;
/// Largest negative radius that counts as rounding, relative to the largest control radius.
const RADIUS_TOLERANCE: f64 = 1e-12;
/// Most bisections of the parameter interval while the sign of the radius is undecided.
const MOST_HALVINGS: u32 = 40;

/// One Bezier curve of a profile, with its position in the source.
pub(crate) struct Curve {
    /// Control points (radius, height), at least two.
    pub points: Vec<DVec2>,
    pub span: Range<usize>,
    /// Byte range of each control point.
    pub point_spans: Vec<Range<usize>>,
}

impl Curve {
    fn span_of(&self, point: usize) -> Range<usize> {
        self.point_spans.get(point).unwrap_or(&self.span).clone()
    }
}

/// Segments of the profile after the checks: joined, not entirely on the axis, and without a
/// negative radius.
pub(crate) fn profile(report: &mut Report, mut curves: Vec<Curve>) -> Option<Vec<Vec<DVec2>>> {
    let before = report.errors.found();
    for curve in &curves {
        check_curve(report, curve);
    }
    join(report, &mut curves);
    let segments = || curves.into_iter().map(|curve| curve.points).collect();
    (report.errors.found() == before).then(segments)
}

fn check_curve(report: &mut Report, curve: &Curve) {
    let radii: Vec<_> = curve.points.iter().map(|point| point.x).collect();
    let largest = radii.iter().fold(0.0f64, |most, radius| most.max(radius.abs()));
    if largest == 0.0 {
        let message = "the profile lies on the axis and sweeps no surface";
        let label = "expected a control point with a radius above 0";
        report.error(curve.span.clone(), message, label, None);
    } else if curve.points.iter().all(|point| *point == curve.points[0]) {
        let message = "the profile is a single point";
        report.error(curve.span.clone(), message, "expected different control points", None);
    } else if let Some(radius) = negative(&radii, RADIUS_TOLERANCE * largest, MOST_HALVINGS) {
        let worst = (0..radii.len()).min_by(|&a, &b| radii[a].total_cmp(&radii[b])).unwrap_or(0);
        let message = format!("the profile crosses the axis: its radius falls to {radius:.3e}");
        let help = Some(
            "a control radius may be negative only if the curve stays right of the axis".to_owned(),
        );
        report.error(curve.span_of(worst), message, "expected a larger radius here", help);
    }
}

/// A value below `-tolerance` of a polynomial in Bernstein form on [0, 1], if there is one. Bisects
/// the interval until the hull of the coefficients decides.
fn negative(coefficients: &[f64], tolerance: f64, halvings: u32) -> Option<f64> {
    let (first, last) = (coefficients[0], coefficients[coefficients.len() - 1]);
    if let Some(value) = [first, last].into_iter().find(|&value| value < -tolerance) {
        return Some(value);
    }
    if halvings == 0 || coefficients.iter().all(|&value| value >= -tolerance) {
        return None;
    }
    let mut left = vec![first];
    let mut right = vec![last];
    let mut row = coefficients.to_vec();
    while row.len() > 1 {
        row = row.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        left.push(row[0]);
        right.push(row[row.len() - 1]);
    }
    right.reverse();
    negative(&left, tolerance, halvings - 1).or_else(|| negative(&right, tolerance, halvings - 1))
}

/// Makes each segment start exactly where the previous one ends, or reports the gap.
fn join(report: &mut Report, curves: &mut [Curve]) {
    let points = curves.iter().flat_map(|curve| &curve.points);
    let extent = points.fold(0.0f64, |most, point| most.max(point.abs().max_element()));
    for index in 1..curves.len() {
        let (Some(&end), Some(&start)) =
            (curves[index - 1].points.last(), curves[index].points.first())
        else {
            continue;
        };
        if start.distance(end) > JOIN_TOLERANCE * extent {
            let message =
                format!("segment {index} does not start where segment {} ends", index - 1);
            let label = format!("expected [{}, {}]", end.x, end.y);
            report.error(curves[index].span_of(0), message, label, None);
        }
        curves[index].points[0] = end;
    }
}

#[cfg(test)]
mod tests {
    use super::negative;

    /// Theory: a quadratic with coefficients (a, b, a) has its minimum (a + b) / 2 in the middle,
    /// so it is negative exactly when b < -a.
    #[test]
    fn sign_of_a_quadratic() {
        for (b, expected) in
            [(1.0, false), (-0.999, false), (-1.0, false), (-1.001, true), (-3.0, true)]
        {
            assert_eq!(negative(&[1.0, b, 1.0], 1e-12, 40).is_some(), expected, "b = {b}");
        }
    }

    /// Theory: the degree-15 curve has one control value c, the others are one. B_7,15 is at most
    /// 0.203042 (at t = 7/15), so 1 + (c - 1) 0.203042 is negative exactly when c < 1 - 1/0.203042
    /// = -3.92509.
    #[test]
    fn sign_at_degree_fifteen() {
        let curve = |c: f64| {
            let mut coefficients = vec![1.0; 16];
            coefficients[7] = c;
            coefficients
        };
        assert!(negative(&curve(-3.925), 1e-12, 40).is_none());
        assert!(negative(&curve(-3.9252), 1e-12, 40).is_some());
    }
}
