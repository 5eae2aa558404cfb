//! Bounding box of the part of a primitive that lies in a cell (perfect splits).

use super::kdtree::Primitive;
use super::math::EPS;
use super::real::{Real, ToDouble, Vec3};
use super::shapes::aabb::Aabb;
use super::shapes::kdtree::SLACK;
use glam::DVec3;
use rayon::prelude::*;

/// Triangles this many times wider than the lower quartile are padded; for all others the
/// traversal's slabs are wide enough, yet thin relative to most triangles.
const OUTLIER: Real = 64.0;

/// Primitives of a tree, and the size above which they need padding.
pub(super) struct Geometry<'a> {
    prims: &'a [Primitive],
    /// Largest extent of a triangle that needs no padding.
    pub size: Real,
}

impl<'a> Geometry<'a> {
    pub fn new(prims: &'a [Primitive]) -> Geometry<'a> {
        let mut sizes: Vec<Real> = prims.par_iter().filter_map(Primitive::size).collect();
        let largest = sizes.par_iter().copied().reduce(|| 0.0, Real::max);
        let quartile = sizes.len() / 4;
        let typical = match sizes.is_empty() {
            true => 0.0,
            false => *sizes.select_nth_unstable_by(quartile, Real::total_cmp).1,
        };
        Geometry { prims, size: largest.min(OUTLIER * typical) }
    }

    /// Returns true if a primitive is so large that its computed hits may lie farther from it than
    /// the slabs about the splitting planes allow for.
    pub fn is_padded(&self, prim: u32) -> bool {
        self.prims[prim as usize].size().is_some_and(|size| size > self.size)
    }

    /// Bounding box of the part of a primitive in `cell`, rounded outward but not beyond the cell,
    /// or `None` if there is none.
    pub fn clipped(&self, prim: u32, cell: Aabb) -> Option<Aabb> {
        match &self.prims[prim as usize] {
            Primitive::Triangle(points) if self.is_padded(prim) => clipped_large(points, cell),
            Primitive::Triangle(points) => clipped_triangle(points, cell),
            Primitive::Box(bounds) => Some(bounds.intersection(cell)).filter(|b| !b.is_empty()),
        }
    }
}

impl Primitive {
    /// Bounding box of the whole primitive.
    pub(super) fn bounds(&self) -> Aabb {
        match self {
            Primitive::Triangle(points) => Aabb::of_points(points),
            Primitive::Box(bounds) => *bounds,
        }
    }

    /// Largest extent of a triangle along an axis; `None` for boxes, which contain all of their
    /// hits already.
    fn size(&self) -> Option<Real> {
        match self {
            Primitive::Triangle(points) => {
                let bounds = Aabb::of_points(points);
                Some((bounds.max - bounds.min).max_element())
            }
            Primitive::Box(_) => None,
        }
    }
}

/// Greatest number of corners of a triangle clipped by the six planes of a cell.
const CORNERS: usize = 9;

/// Part of a triangle in a cell: a convex polygon.
struct Polygon {
    corners: [DVec3; CORNERS],
    count: usize,
}

/// Bounding box of the part of a triangle in `cell`.
fn clipped_triangle(points: &[Vec3; 3], cell: Aabb) -> Option<Aabb> {
    let part = polygon(points, cell).bounds(0.0)?;
    // in f64 the corners are rounded like the kernels' numbers, but never beyond the triangle
    let slop = if f64::from(EPS) < f64::EPSILON { Real::EPSILON * magnitude(points) } else { 0.0 };
    let whole = Aabb::of_points(points);
    let (min, max) = ((part.min - slop).max(whole.min), (part.max + slop).min(whole.max));
    Some(Aabb { min: min.clamp(cell.min, cell.max), max: max.clamp(cell.min, cell.max) })
}

/// Bounding box of the computed hits in `cell` of a triangle that is too large for the slabs about
/// the splitting planes.
///
/// A hit near a point q with weights w deviates from the triangle by at most
/// `SLACK sum w_i |p_i - q|`, plus an error in proportion to its distance from the ray's origin. If
/// one vertex is distant, this is small near the other two; the padding is therefore computed for
/// the part in the cell enlarged by the previous padding, as long as that at least halves it.
fn clipped_large(points: &[Vec3; 3], cell: Aabb) -> Option<Aabb> {
    let whole = Aabb::of_points(points);
    let slop = f64::EPSILON * f64::from(4.0 * magnitude(points));
    let mut pad = f64::from(SLACK * (whole.max - whole.min).max_element());
    loop {
        let grown = |b: Aabb| {
            let min = (b.min.to_double() - pad).to_array().map(rounded_down);
            Aabb {
                min: min.into(),
                max: (b.max.to_double() + pad).to_array().map(rounded_up).into(),
            }
        };
        let part = polygon(points, grown(cell));
        let bounds = part.bounds(pad)?;
        let local = f64::from(SLACK) * part.reach(points) + slop;
        if local > 0.5 * pad {
            return Some(bounds.intersection(cell)).filter(|b| !b.is_empty());
        }
        pad = local;
    }
}

/// Largest absolute coordinate.
fn magnitude(points: &[Vec3; 3]) -> Real {
    points.iter().map(|p| p.abs().max_element()).fold(0.0, Real::max)
}

/// Clips the triangle by each plane of the cell in turn (Sutherland & Hodgman 1974), in f64.
fn polygon(points: &[Vec3; 3], cell: Aabb) -> Polygon {
    let mut corners = [DVec3::ZERO; CORNERS];
    for (corner, point) in corners.iter_mut().zip(points) {
        *corner = point.to_double();
    }
    let mut count = 3;
    let bounds = Aabb::of_points(points);
    for axis in 0..3 {
        if bounds.min[axis] < cell.min[axis] {
            count = cut(&mut corners, count, axis, f64::from(cell.min[axis]), 1.0);
        }
        if bounds.max[axis] > cell.max[axis] {
            count = cut(&mut corners, count, axis, f64::from(cell.max[axis]), -1.0);
        }
    }
    Polygon { corners, count }
}

impl Polygon {
    /// Bounding box, widened by `pad` and rounded outward, or `None` for an empty polygon.
    fn bounds(&self, pad: f64) -> Option<Aabb> {
        let corners = &self.corners[..self.count];
        let low = corners.iter().copied().reduce(DVec3::min)? - pad;
        let high = corners.iter().copied().reduce(DVec3::max)? + pad;
        Some(Aabb {
            min: low.to_array().map(rounded_down).into(),
            max: high.to_array().map(rounded_up).into(),
        })
    }

    /// Bound on `sum w_i |p_i - q|` over the polygon's points q with weights w in the triangle
    /// `points`: linear in q except for the distances, which grow by at most the polygon's extent.
    fn reach(&self, points: &[Vec3; 3]) -> f64 {
        let [a, b, c] = points.map(Vec3::to_double);
        let normal = (b - a).cross(c - a);
        let area_sq = normal.length_squared();
        let corners = &self.corners[..self.count];
        let distances = |q: DVec3| [a, b, c].map(|p| (p - q).abs().max_element());
        let bound = |q: &DVec3| {
            let weight =
                |from: DVec3, to: DVec3| (to - from).cross(*q - from).dot(normal) / area_sq;
            let weights = [weight(b, c), weight(c, a), weight(a, b)];
            let sum =
                distances(*q).iter().zip(weights).map(|(d, w)| d * w.clamp(0.0, 1.0)).sum::<f64>();
            let extent =
                corners.iter().map(|other| (*other - *q).abs().max_element()).fold(0.0, f64::max);
            // a triangle without area has no weights
            if area_sq > 0.0 { sum + extent } else { f64::MAX }
        };
        corners.iter().map(bound).fold(0.0, f64::max)
    }
}

/// Keeps the corners with `side * (x - plane) >= 0` and adds one where an edge crosses the plane.
fn cut(polygon: &mut [DVec3; CORNERS], count: usize, axis: usize, plane: f64, side: f64) -> usize {
    let old = *polygon;
    let mut kept = 0;
    let mut push = |p: DVec3| {
        // rounding cannot add a corner: a convex polygon crosses a plane at most twice
        if kept < CORNERS {
            polygon[kept] = p;
            kept += 1;
        }
    };
    for i in 0..count {
        let a = old[i];
        let b = old[if i + 1 == count { 0 } else { i + 1 }];
        let da = side * (a[axis] - plane);
        let db = side * (b[axis] - plane);
        if da >= 0.0 {
            push(a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            let mut p = a + (b - a) * (da / (da - db));
            p[axis] = plane;
            push(p);
        }
    }
    kept
}

fn rounded_down(x: f64) -> Real {
    let y = x as Real;
    if f64::from(y) > x { y.next_down() } else { y }
}

fn rounded_up(x: f64) -> Real {
    let y = x as Real;
    if f64::from(y) < x { y.next_up() } else { y }
}
