//! Splits of large nodes by the surface area heuristic at evenly spaced planes.

use super::kdtree::{Heuristic, INTERSECTION_COST, Item};
use super::kdtree_clip::Geometry;
use super::real::Real;
use super::shapes::aabb::Aabb;

/// Number of bins per axis; the candidate planes lie between them.
const BINS: usize = 256;

/// Splitting plane.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub axis: usize,
    pub position: Real,
}

/// Number of items sampled to find where most of them lie.
const SAMPLE: usize = 1024;
/// Planes are spaced over the middle of the items if it is narrower than the cell by this factor.
const NARROW: Real = 1.0 / 16.0;

/// Range over which the planes are spaced. Along each axis this is the cell or, if a few distant
/// items make the cell much wider than the other items, the middle 98 % of the items plus a margin
/// of the same width.
fn bin_range(items: &[Item], cell: Aabb) -> Aabb {
    let mut range = cell;
    let sample = || items.iter().step_by(items.len() / SAMPLE + 1);
    for axis in 0..3 {
        let mut lows: Vec<Real> = sample().map(|i| i.bounds.min[axis]).collect();
        let mut highs: Vec<Real> = sample().map(|i| i.bounds.max[axis]).collect();
        if lows.is_empty() {
            return cell;
        }
        let outside = lows.len() / 100;
        let last = highs.len() - 1 - outside;
        let low = *lows.select_nth_unstable_by(outside, Real::total_cmp).1;
        let high = *highs.select_nth_unstable_by(last, Real::total_cmp).1;
        let width = high - low;
        if width > 0.0 && width < NARROW * (cell.max[axis] - cell.min[axis]) {
            range.min[axis] = (low - width).max(cell.min[axis]);
            range.max[axis] = (high + width).min(cell.max[axis]);
        }
    }
    range
}

/// Best of the evenly spaced planes, or `None` if no split is expected to reduce the cost.
pub(super) fn best_plane(items: &[Item], cell: Aabb) -> Option<Plane> {
    let range = bin_range(items, cell);
    let size = range.max - range.min;
    let scale = size.map(|s| if s > 0.0 { BINS as Real / s } else { 0.0 });
    // count the items that start and end in each bin
    let mut starts = [[0usize; BINS]; 3];
    let mut ends = [[0usize; BINS]; 3];
    for item in items {
        let first = (item.bounds.min - range.min) * scale;
        let last = (item.bounds.max - range.min) * scale;
        for axis in 0..3 {
            starts[axis][(first[axis] as usize).min(BINS - 1)] += 1;
            ends[axis][(last[axis] as usize).min(BINS - 1)] += 1;
        }
    }
    let mut best = None;
    let mut best_cost = INTERSECTION_COST * items.len() as f64;
    // sweep the planes
    for axis in 0..3 {
        let Some(heuristic) = Heuristic::new(cell, axis) else { continue };
        let mut left = 0;
        let mut right = items.len();
        for bin in 1..BINS {
            left += starts[axis][bin - 1];
            right -= ends[axis][bin - 1];
            let position = range.min[axis] + size[axis] * (bin as Real / BINS as Real);
            let cost = heuristic.cost(position, left, right);
            if cost < best_cost && position > cell.min[axis] && position < cell.max[axis] {
                best_cost = cost;
                best = Some(Plane { axis, position });
            }
        }
    }
    best
}

/// Distributes the items to the cells `low` and `high` of a split; items in the plane go to `low`.
pub(super) fn partition(
    geometry: &Geometry,
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
            let (a, b) = parts(geometry, item.prim, low, high);
            left.extend(a.map(|bounds| Item { prim: item.prim, bounds }));
            right.extend(b.map(|bounds| Item { prim: item.prim, bounds }));
        }
    }
    (left, right)
}

/// Boxes of a primitive clipped to two cells. If rounding removes it from both, it is kept in both.
pub(super) fn parts(
    geometry: &Geometry,
    prim: u32,
    low: Aabb,
    high: Aabb,
) -> (Option<Aabb>, Option<Aabb>) {
    match (geometry.clipped(prim, low), geometry.clipped(prim, high)) {
        (None, None) => (Some(low), Some(high)),
        parts => parts,
    }
}
