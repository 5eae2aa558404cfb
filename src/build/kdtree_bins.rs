//! Splits of large nodes: the surface area heuristic at evenly spaced planes.

use super::kdtree::{Heuristic, INTERSECTION_COST, Item, Primitive};
use super::kdtree_clip::clipped;
use super::real::Real;
use super::shapes::aabb::Aabb;

/// Planes tried per axis, plus one.
const BINS: usize = 256;

/// A splitting plane.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub axis: usize,
    pub position: Real,
}

/// The best of the evenly spaced planes, or none if no split is expected to pay.
pub(super) fn best_plane(items: &[Item], cell: Aabb) -> Option<Plane> {
    let size = cell.max - cell.min;
    let scale = size.map(|s| if s > 0.0 { BINS as Real / s } else { 0.0 });
    let mut starts = [[0usize; BINS]; 3];
    let mut ends = [[0usize; BINS]; 3];
    for item in items {
        let first = (item.bounds.min - cell.min) * scale;
        let last = (item.bounds.max - cell.min) * scale;
        for axis in 0..3 {
            starts[axis][(first[axis] as usize).min(BINS - 1)] += 1;
            ends[axis][(last[axis] as usize).min(BINS - 1)] += 1;
        }
    }
    let mut best = None;
    let mut best_cost = INTERSECTION_COST * items.len() as f64;
    for axis in 0..3 {
        let Some(heuristic) = Heuristic::new(cell, axis) else { continue };
        let mut left = 0;
        let mut right = items.len();
        for bin in 1..BINS {
            left += starts[axis][bin - 1];
            right -= ends[axis][bin - 1];
            let position = cell.min[axis] + size[axis] * (bin as Real / BINS as Real);
            let cost = heuristic.cost(position, left, right);
            if cost < best_cost && position > cell.min[axis] && position < cell.max[axis] {
                best_cost = cost;
                best = Some(Plane { axis, position });
            }
        }
    }
    best
}

/// The items of the two cells `low` and `high` beside `plane`; what lies in the plane goes to the first.
pub(super) fn partition(
    prims: &[Primitive],
    items: &[Item],
    plane: Plane,
    low: Aabb,
    high: Aabb,
) -> (Vec<Item>, Vec<Item>) {
    let mut left = Vec::with_capacity(items.len() / 2);
    let mut right = Vec::with_capacity(items.len() / 2);
    for item in items {
        if item.bounds.max[plane.axis] <= plane.position {
            left.push(*item);
        } else if item.bounds.min[plane.axis] >= plane.position {
            right.push(*item);
        } else {
            let (a, b) = parts(prims, item.prim, low, high);
            left.extend(a.map(|bounds| Item { prim: item.prim, bounds }));
            right.extend(b.map(|bounds| Item { prim: item.prim, bounds }));
        }
    }
    (left, right)
}

/// The boxes of a primitive in two cells. Should rounding take it from both, it stays in both.
pub(super) fn parts(prims: &[Primitive], prim: u32, low: Aabb, high: Aabb) -> (Option<Aabb>, Option<Aabb>) {
    let prim = &prims[prim as usize];
    match (clipped(prim, low), clipped(prim, high)) {
        (None, None) => (Some(low), Some(high)),
        parts => parts,
    }
}
