//! The box about the part of a primitive that lies in a cell (perfect splits).

use super::kdtree::Primitive;
use super::real::{Real, ToDouble, Vec3};
use super::shapes::aabb::Aabb;
use glam::DVec3;

/// The box about a whole primitive.
pub(super) fn whole(prim: &Primitive) -> Aabb {
    match prim {
        Primitive::Triangle(points) => Aabb::of_points(points),
        Primitive::Box(bounds) => *bounds,
    }
}

/// The box about what `cell` holds of `prim`, rounded outward but not out of the cell, or none.
pub(super) fn clipped(prim: &Primitive, cell: Aabb) -> Option<Aabb> {
    match prim {
        Primitive::Triangle(points) => clipped_triangle(points, cell),
        Primitive::Box(bounds) => Some(bounds.intersection(cell)).filter(|b| !b.is_empty()),
    }
}

/// A triangle cut by the six planes of a cell has at most nine corners.
const CORNERS: usize = 9;

/// Cuts the polygon by each plane of the cell in turn (Sutherland & Hodgman 1974), in f64. Where that is no more than the
/// kernels have, the corners are off by some roundings, for which the slab about each plane has room
/// (`shapes/kdtree.rs`).
fn clipped_triangle(points: &[Vec3; 3], cell: Aabb) -> Option<Aabb> {
    let mut polygon = [DVec3::ZERO; CORNERS];
    for (corner, point) in polygon.iter_mut().zip(points) {
        *corner = point.to_double();
    }
    let mut count = 3;
    let bounds = Aabb::of_points(points);
    for axis in 0..3 {
        if bounds.min[axis] < cell.min[axis] {
            count = cut(&mut polygon, count, axis, f64::from(cell.min[axis]), 1.0);
        }
        if bounds.max[axis] > cell.max[axis] {
            count = cut(&mut polygon, count, axis, f64::from(cell.max[axis]), -1.0);
        }
    }
    let corners = &polygon[..count];
    let low = corners.iter().copied().reduce(DVec3::min)?;
    let high = corners.iter().copied().reduce(DVec3::max)?;
    Some(Aabb { min: low.to_array().map(rounded_down).into(), max: high.to_array().map(rounded_up).into() })
        .map(|b: Aabb| Aabb { min: b.min.clamp(cell.min, cell.max), max: b.max.clamp(cell.min, cell.max) })
}

/// Keeps the corners with `side * (x - plane) >= 0` and adds those where an edge crosses.
fn cut(polygon: &mut [DVec3; CORNERS], count: usize, axis: usize, plane: f64, side: f64) -> usize {
    let old = *polygon;
    let mut kept = 0;
    let mut push = |p: DVec3| {
        // Rounding cannot make a corner more: a convex polygon crosses a plane at most twice.
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
