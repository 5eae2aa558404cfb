//! kd-tree over all bounded shapes, built by the surface area heuristic (Wald & Havran 2006, "On
//! building fast kd-trees for ray tracing, and on doing that in O(N log N)").
//!
//! Large nodes are split at one of several evenly spaced planes (`kdtree_bins`); below a few
//! thousand primitives, all planes that bound a primitive are candidates, taken from lists that
//! stay sorted (`kdtree_sweep`). Both clip primitives to the cells that they overlap ("perfect
//! splits", `kdtree_clip`). Finally, the nodes are ordered for traversal (`kdtree_layout`).

use super::kdtree_bins::{best_plane, partition};
use super::kdtree_clip::Geometry;
use super::kdtree_layout::laid_out;
use super::kdtree_sweep::Sweep;
use super::real::{Real, ToDouble, Vec3};
use super::shapes::aabb::Aabb;
use super::shapes::kdtree::{MAX_DEPTH, Node, Tree};
use crate::telemetry::stage::stage;
use rayon::prelude::*;

/// Primitive of the tree: geometry in the kernels' precision.
#[derive(Clone, Copy, Debug)]
pub enum Primitive {
    /// A triangle by its vertices.
    Triangle([Vec3; 3]),
    /// Any other shape, as a box that is guaranteed to contain all of its computed hits.
    Box(Aabb),
}

/// Statistics of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Expected cost, in node visits, of a ray that crosses the root's box: the surface area
    /// heuristic summed over the tree with [`INTERSECTION_COST`].
    pub cost: f64,
    /// Number of leaves.
    pub leaves: usize,
    /// Number of leaves without a primitive.
    pub empty_leaves: usize,
    /// Greatest number of primitives in one leaf.
    pub largest_leaf: usize,
    /// Number of interior nodes on the longest path.
    pub depth: u32,
}

/// kd-tree in the format that the kernels read.
#[derive(Clone, Debug, PartialEq)]
pub struct KdTree {
    /// Nodes: the root, an empty leaf as its sibling, then pairs of siblings.
    pub nodes: Vec<Node>,
    /// Indices of primitives, in leaf order.
    pub refs: Vec<u32>,
    /// Bounding box of all primitives; zero if there are none.
    pub bounds: Aabb,
    /// See [`Tree::primitive_size`].
    pub primitive_size: Real,
    /// Statistics of the tree.
    pub stats: Stats,
}

impl KdTree {
    /// View of the tree for [`crate::shapes::kdtree::traverse_closest`].
    pub fn view(&self) -> Tree<'_> {
        Tree {
            nodes: &self.nodes,
            refs: &self.refs,
            bounds_min: self.bounds.min,
            bounds_max: self.bounds.max,
            primitive_size: self.primitive_size,
        }
    }
}

/// Cost of a primitive's test relative to a node visit (`K_I / K_T` in the paper).
pub const INTERSECTION_COST: f64 = 0.3;
/// Factor on the cost of a plane that cuts off empty space (`lambda` in the paper).
const EMPTY_BONUS: f64 = 0.8;
/// Number of primitives above which a node is split at evenly spaced planes.
const SWEEP_LIMIT: usize = 1 << 13;

/// Primitive and the bounding box of its part in the cell.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub prim: u32,
    pub bounds: Aabb,
}

/// Node before its placement in memory.
#[derive(Clone, Copy)]
pub(super) enum Part {
    /// The lower child follows; `upper` is the index of the upper one.
    Split {
        axis: u8,
        position: Real,
        upper: u32,
    },
    Leaf {
        first: u32,
        count: u32,
    },
}

/// Subtree in depth-first order. Upper children and first references are relative to its start.
#[derive(Default)]
pub(super) struct Subtree {
    pub nodes: Vec<Part>,
    pub refs: Vec<u32>,
}

/// Surface area heuristic in one cell along one axis.
pub(super) struct Heuristic {
    /// Half-area of a cut across the axis over the half-area of the cell.
    cut: f64,
    /// Growth of the half-area ratio per unit along the axis.
    growth: f64,
    low: f64,
    high: f64,
}

impl Heuristic {
    /// `None` if the cell has no area.
    pub fn new(cell: Aabb, axis: usize) -> Option<Heuristic> {
        let d = cell.max.to_double() - cell.min.to_double();
        let (b, c) = (d[(axis + 1) % 3], d[(axis + 2) % 3]);
        let area = cell.half_area();
        (area > 0.0).then(|| Heuristic {
            cut: b * c / area,
            growth: (b + c) / area,
            low: f64::from(cell.min[axis]),
            high: f64::from(cell.max[axis]),
        })
    }

    /// Expected cost of a split at `position` with `left` and `right` primitives on the two sides.
    #[inline]
    pub fn cost(&self, position: Real, left: usize, right: usize) -> f64 {
        let p_left = self.cut + (f64::from(position) - self.low) * self.growth;
        let p_right = self.cut + (self.high - f64::from(position)) * self.growth;
        let bonus = if left == 0 || right == 0 { EMPTY_BONUS } else { 1.0 };
        bonus * (1.0 + INTERSECTION_COST * (p_left * left as f64 + p_right * right as f64))
    }
}

/// Builds the tree. The result does not depend on the number of threads.
pub fn build(prims: &[Primitive]) -> KdTree {
    let _stage = stage("kd-tree");
    let geometry = Geometry::new(prims);
    let mut items: Vec<Item> = prims
        .par_iter()
        .enumerate()
        .map(|(i, p)| Item { prim: i as u32, bounds: p.bounds() })
        .collect();
    let bounds = match items.iter().map(|i| i.bounds).reduce(Aabb::union) {
        Some(b) => b,
        None => Aabb { min: Vec3::ZERO, max: Vec3::ZERO },
    };
    items.par_iter_mut().for_each(|item| {
        if geometry.is_padded(item.prim) {
            item.bounds = geometry.clipped(item.prim, bounds).unwrap_or(bounds);
        }
    });
    let levels = 8.0 + 1.3 * (prims.len().max(1) as f64).log2();
    let Subtree { nodes, refs } =
        subtree(&geometry, items, bounds, MAX_DEPTH.min(levels.round() as u32));
    let nodes = laid_out(&nodes, bounds);
    let stats = stats(&nodes, bounds);
    KdTree { nodes, refs, bounds, primitive_size: geometry.size, stats }
}

fn subtree(geometry: &Geometry, items: Vec<Item>, cell: Aabb, levels: u32) -> Subtree {
    let plane =
        if items.len() > SWEEP_LIMIT && levels > 0 { best_plane(&items, cell) } else { None };
    let Some(plane) = plane else {
        return Sweep::new(geometry, &items, levels).build(&items, cell);
    };
    let (low, high) = cell.split(plane.axis, plane.position);
    let (left, right) = partition(geometry, &items, plane, low, high);
    drop(items);
    let (left, right) = rayon::join(
        || subtree(geometry, left, low, levels - 1),
        || subtree(geometry, right, high, levels - 1),
    );
    joined(plane.axis, plane.position, left, right)
}

fn joined(axis: usize, position: Real, left: Subtree, right: Subtree) -> Subtree {
    let mut nodes = Vec::with_capacity(1 + left.nodes.len() + right.nodes.len());
    nodes.push(Part::Split { axis: axis as u8, position, upper: 1 + left.nodes.len() as u32 });
    for (part, first_node, first_ref) in
        [(&left, 1, 0), (&right, 1 + left.nodes.len() as u32, left.refs.len() as u32)]
    {
        nodes.extend(part.nodes.iter().map(|n| match *n {
            Part::Split { axis, position, upper } => {
                Part::Split { axis, position, upper: upper + first_node }
            }
            Part::Leaf { first, count } => Part::Leaf { first: first + first_ref, count },
        }));
    }
    let mut refs = left.refs;
    refs.extend_from_slice(&right.refs);
    Subtree { nodes, refs }
}

fn stats(nodes: &[Node], bounds: Aabb) -> Stats {
    let root = bounds.half_area();
    let mut stats = Stats::default();
    let mut open = vec![(0, bounds, 0)];
    while let Some((index, cell, depth)) = open.pop() {
        let node = nodes[index];
        let p = if root > 0.0 { cell.half_area() / root } else { 1.0 };
        if node.is_leaf() {
            let count = node.range().len();
            stats.cost += p * INTERSECTION_COST * count as f64;
            stats.leaves += 1;
            stats.empty_leaves += usize::from(count == 0);
            stats.largest_leaf = stats.largest_leaf.max(count);
            stats.depth = stats.depth.max(depth);
        } else {
            let (axis, position, lower) = node.plane();
            let (low, high) = cell.split(axis, position);
            stats.cost += p;
            open.push((lower as usize + 1, high, depth + 1));
            open.push((lower as usize, low, depth + 1));
        }
    }
    stats
}
