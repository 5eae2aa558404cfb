//! Bezier profiles of surfaces of revolution: validation, and cutting into flat pieces.

use super::bezier::{derivative, point, restrict, roots};
use crate::shapes::revolution::MAX_DEGREE;
use glam::{DQuat, DVec2, DVec3};

/// Slope over the chord up to which a piece of profile counts as flat: a bend of about 11 degrees
/// to either side.
const FLAT_SLOPE: f64 = 0.2;
/// Greatest number of halvings of a segment; a piece that still bends becomes a straight sliver.
const MAX_DEPTH: u32 = 24;
/// Fraction of its length by which a patch overlaps its neighbour on the same segment, so that no
/// hit is lost between them: both are the same polynomial there.
const OVERLAP: f64 = 1.0 / 64.0;

/// Reason why a profile does not define a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// A segment has too few or too many control points.
    #[error("segment {segment} has {points} control points; a Bezier segment has 2 to {}", MAX_DEGREE + 1)]
    Degree {
        /// Index of the segment.
        segment: usize,
        /// Its number of control points.
        points: usize,
    },
    /// A coordinate, the scale or the placement is NaN or infinite, or the scale is not positive.
    #[error(
        "the profile or its transform holds a number that is not finite, or a scale that is not positive"
    )]
    NotFinite,
    /// The surface is empty: all points coincide or lie on the axis.
    #[error("the profile encloses no surface: it is a point, or lies on the axis")]
    Empty,
}

/// Rotation, uniform scale and translation from the profile's coordinates to the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rotation, applied first.
    pub rotation: DQuat,
    /// Scale, positive.
    pub scale: f64,
    /// Translation, applied last, scene units.
    pub translation: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { rotation: DQuat::IDENTITY, scale: 1.0, translation: DVec3::ZERO }
    }
}

/// Piece [t0, t1] of a segment that is a graph over its chord.
pub struct Piece {
    /// Curve parameter of the segment at its start.
    pub t0: f64,
    /// Curve parameter of the segment at its end.
    pub t1: f64,
    /// Control points (radius, height).
    pub points: Vec<DVec2>,
    /// Bound on |phi'|, the slope over the chord.
    pub slope: f64,
    /// Bound on how far phi' leaves the range of its values at the ends.
    pub wobble: f64,
}

/// Checks that a profile and its placement are valid.
///
/// # Errors
/// The number of control points of a segment is out of range, or a number is not finite.
pub fn check(segments: &[Vec<DVec2>], placement: &Placement) -> Result<(), ProfileError> {
    for (segment, points) in segments.iter().enumerate() {
        if !(2..=MAX_DEGREE + 1).contains(&points.len()) {
            return Err(ProfileError::Degree { segment, points: points.len() });
        }
    }
    let finite = segments.iter().flatten().all(|p| p.is_finite())
        && placement.rotation.is_finite()
        && placement.translation.is_finite()
        && placement.scale.is_finite()
        && placement.scale > 0.0;
    if finite { Ok(()) } else { Err(ProfileError::NotFinite) }
}

/// Cuts a segment (local units) at its cusps and where it crosses the axis, then halves the parts
/// until every piece is a flat graph over its chord. Pieces on the negative side of the axis are
/// mirrored to radius >= 0.
pub fn pieces(segment: &[DVec2]) -> Vec<Piece> {
    let mut out = Vec::new();
    let extent = segment.iter().fold(0.0_f64, |a, p| a.max(p.distance(segment[0])));
    if extent < 1e-9 {
        return out;
    }
    let velocity = derivative(segment);
    let speed = velocity.iter().fold(0.0_f64, |a, v| a.max(v.length()));
    // cut at the axis and at cusps
    let component =
        |points: &[DVec2], of: fn(&DVec2) -> f64| points.iter().map(of).collect::<Vec<f64>>();
    let mut cuts = roots(&component(segment, |p| p.x), 1e-12);
    let stops = [component(&velocity, |v| v.x), component(&velocity, |v| v.y)];
    let stops = stops.iter().flat_map(|c| roots(c, 1e-12 * speed));
    cuts.extend(stops.filter(|&t| point(&velocity, t).length() < 1e-6 * speed));
    cuts.extend([0.0, 1.0]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a < 1e-6);
    for w in cuts.windows(2) {
        let side = if point(segment, 0.5 * (w[0] + w[1])).x < 0.0 {
            DVec2::new(-1.0, 1.0)
        } else {
            DVec2::ONE
        };
        let mirrored: Vec<DVec2> = segment.iter().map(|&p| p * side).collect();
        halve(&mirrored, [w[0], w[1]], w[0], w[1], 0, &mut out);
    }
    out
}

fn halve(segment: &[DVec2], limits: [f64; 2], t0: f64, t1: f64, depth: u32, out: &mut Vec<Piece>) {
    let over = OVERLAP * (t1 - t0);
    let (a, b) = ((t0 - over).max(limits[0]), (t1 + over).min(limits[1]));
    let points = restrict(segment, a, b);
    if let Some((slope, wobble)) = slopes(&points) {
        out.push(Piece { t0: a, t1: b, points, slope, wobble });
    } else if depth < MAX_DEPTH {
        let middle = 0.5 * (t0 + t1);
        halve(segment, limits, t0, middle, depth + 1, out);
        halve(segment, limits, middle, t1, depth + 1, out);
    } else {
        let ends = vec![points[0], points[points.len() - 1]];
        out.push(Piece { t0: a, t1: b, points: ends, slope: 0.0, wobble: 0.0 });
    }
}

/// Bounds on |dh/ds| of a curve over its chord and on how far dh/ds leaves the range of its values
/// at the ends, from the legs of the control polygon (variation diminishing: dh/ds is a rational
/// Bezier function with their slopes as coefficients). `None` if the curve is not a flat graph.
fn slopes(points: &[DVec2]) -> Option<(f64, f64)> {
    let chord = points[points.len() - 1] - points[0];
    let length = chord.length();
    if length < 1e-12 {
        return None;
    }
    let e = chord / length;
    // skip legs of zero length (at a cusp), which do not affect the tangent
    let legs = points.windows(2).map(|w| w[1] - w[0]).filter(|leg| leg.length() > 1e-7 * length);
    let slope =
        |leg: DVec2| if e.dot(leg) > 0.0 { leg.perp_dot(e) / e.dot(leg) } else { f64::INFINITY };
    let slopes: Vec<f64> = legs.map(slope).collect();
    let bound = slopes.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    if bound > FLAT_SLOPE {
        return None;
    }
    let variation: f64 = slopes.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let net = slopes[slopes.len() - 1] - slopes[0];
    Some((bound, 0.5 * (variation - net.abs())))
}
