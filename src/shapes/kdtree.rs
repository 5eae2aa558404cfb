//! Rays through the kd-tree. Twin: `shaders/shapes/kdtree.wgsl`.
//!
//! The far children that wait lie on a stack as deep as the tree. A node says which of its children
//! are empty: these leaves, which are more than half of all, are neither read nor put on the stack.
//! Both twins test the same leaves in the same order, so that ties in the distance end alike.
//!
//! A computed hit lies off its primitive by at most some 30 roundings of the largest coordinate of
//! the primitive as seen from the ray's origin. That is no more than the distance of the hit plus
//! the primitive's extent. So every plane is taken as a slab of half-width `SLACK (|t| +
//! primitive_size)`, with the greatest `|t|` in the ray's interval in the node (compare the
//! interval padding of Ize 2013, "Robust BVH Ray Traversal"): a ray that is in the slab visits both
//! sides, and the nearest computed hit is found exactly as by trying all primitives. The slab
//! shrinks with the interval, so geometry far away does not widen it. The builder pads the few
//! primitives that are larger than `primitive_size`.

use super::math::EPS;
use super::ray::{Hit, Ray};
use super::real::{Bits, Plain, Real, Vec3};
use super::table::NONE;
use bytemuck::Zeroable;

/// Greatest number of interior nodes above a leaf, and so of children that wait.
pub const MAX_DEPTH: u32 = 32;
/// Half-width of the slab about a plane, over the hit's distance plus the primitive's size: 64
/// roundings. The watertight triangle test is bounded by about 30 (7 is the most seen), the plane's
/// distance by 3.
pub const SLACK: Real = 64.0 * EPS;
/// Stands for a direction component that is (nearly) zero: so small that a slab which the ray runs
/// beside is never reached within the tree, and one which the ray runs in is never left.
const LEVEL: Real = 1e-20;

/// A node of the kd-tree in 8 bytes (16 in f64). Two siblings lie side by side, the lower one at an
/// even index.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Zeroable)]
pub struct Node {
    /// Interior: bits of the splitting plane's position. Leaf: index of its first reference.
    pub word0: Bits,
    /// Interior: half the index of the lower child << 4, | 8 or | 4 where the upper or lower child
    /// is empty, | axis. Leaf: number of references << 2 | 3.
    pub word1: u32,
}

/// Index of an empty leaf: the place beside the root.
pub(super) const NOTHING: u32 = 1;

impl Node {
    /// A node with two children, at `children`, which is even, and after it, split at `axis =
    /// position`; `empty`: which of them are leaves without references.
    pub fn interior(axis: usize, position: Real, children: u32, empty: [bool; 2]) -> Node {
        let empty = u32::from(empty[1]) << 3 | u32::from(empty[0]) << 2;
        Node { word0: position.to_bits(), word1: children << 3 | empty | axis as u32 }
    }

    /// A leaf with `count` references from `first` on.
    pub fn leaf(first: u32, count: u32) -> Node {
        Node { word0: first as Bits, word1: count << 2 | 3 }
    }

    /// Whether the node has no children.
    #[inline]
    pub fn is_leaf(self) -> bool {
        self.word1 & 3 == 3
    }

    /// Interior: axis and position of the plane, and index of the lower child.
    #[inline]
    pub fn plane(self) -> (usize, Real, u32) {
        ((self.word1 & 3) as usize, Real::from_bits(self.word0), self.children())
    }

    /// Interior: index of the lower child.
    #[inline(always)]
    fn children(self) -> u32 {
        self.word1 >> 3 & !1
    }

    /// Interior: whether the lower (0) or upper (1) child is an empty leaf.
    #[inline(always)]
    pub fn is_empty(self, child: u32) -> bool {
        self.word1 >> (2 + child) & 1 != 0
    }

    /// Leaf: the range of its references.
    #[inline]
    pub fn range(self) -> std::ops::Range<usize> {
        let first = self.word0 as usize;
        first..first + (self.word1 >> 2) as usize
    }
}

/// A kd-tree as the kernels see it; `nodes` has at least the first two.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    /// Nodes, the root first and an empty leaf beside it, then pairs of siblings.
    pub nodes: &'a [Node],
    /// References in the order of the leaves.
    pub refs: &'a [u32],
    /// Least corner of the box about everything.
    pub bounds_min: Vec3,
    /// Greatest corner.
    pub bounds_max: Vec3,
    /// Extent up to which the slab about a plane covers the rounding of triangles; larger ones are
    /// padded.
    pub primitive_size: Real,
}

/// A child that waits: its index and the ray's interval in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Waiting {
    pub node: u32,
    pub begin: Real,
    pub end: Real,
}

/// The larger of two numbers in one instruction; `Real::max` takes four, in case one is none.
#[inline]
pub(super) fn larger(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

/// The smaller of two numbers.
#[inline]
pub(super) fn smaller(a: Real, b: Real) -> Real {
    if a < b { a } else { b }
}

#[inline]
fn reciprocal(d: Real) -> Real {
    1.0 / if d.abs() < LEVEL { LEVEL } else { d }
}

/// What the walk needs to know of a ray along one axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub origin: Real,
    pub inverse: Real,
    /// `SLACK` over the direction's component: half-width of a slab in t, per unit of distance.
    pub slack: Real,
    /// 1 where the ray meets the upper child first.
    pub backward: u32,
}

/// What the primitives of leaves are.
pub trait Primitives {
    /// Tests those that `references`, a leaf's, name and replaces `hit` by anything nearer.
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit);
    /// Tests what was put off until the walk was over.
    #[inline(always)]
    fn finish(&mut self, _ray: &Ray, _hit: &mut Hit) {}
    /// Asks for what [`Primitives::intersect`] will read.
    fn expect(&self, _references: &[u32]) {}
}

impl<F: Fn(&[u32], &Ray, &mut Hit)> Primitives for F {
    #[inline(always)]
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit) {
        self(references, ray, hit);
    }
}

/// Lowers `hit` to the nearest hit with a primitive of the tree.
#[inline(always)]
pub fn traverse_closest(tree: &Tree, ray: &Ray, hit: &mut Hit, mut primitives: impl Primitives) {
    traverse(tree, ray, false, hit, &mut primitives);
    primitives.finish(ray, hit);
}

/// Whether `hit` is not [`NONE`] after testing the leaves of the tree until something is hit.
#[inline(always)]
pub fn traverse_any(
    tree: &Tree,
    ray: &Ray,
    hit: &mut Hit,
    mut primitives: impl Primitives,
) -> bool {
    traverse(tree, ray, true, hit, &mut primitives);
    if hit.reference == NONE {
        primitives.finish(ray, hit);
    }
    hit.reference != NONE
}

/// What the walk needs to know of a ray, and the part of it up to `t_max` that lies in the tree's
/// box, if any.
#[inline(always)]
pub(super) fn start(tree: &Tree, ray: &Ray, t_max: Real) -> Option<([Axis; 4], Real, Real)> {
    let inverse = Vec3::new(
        reciprocal(ray.direction.x),
        reciprocal(ray.direction.y),
        reciprocal(ray.direction.z),
    );
    let to_min = tree.bounds_min - ray.origin;
    let to_max = tree.bounds_max - ray.origin;
    let reach = to_min.abs().max(to_max.abs());
    let slack = SLACK * inverse.abs();
    let margin = slack * larger(larger(reach.x, reach.y), reach.z);
    let t0 = to_min * inverse;
    let t1 = to_max * inverse;
    let enter = t0.min(t1) - margin;
    let leave = t0.max(t1) + margin;
    let root_begin = larger(larger(larger(ray.t_min, enter.x), enter.y), enter.z);
    let root_end = smaller(smaller(smaller(t_max, leave.x), leave.y), leave.z);
    if root_begin > root_end {
        return None;
    }
    let axis = |i: usize| Axis {
        origin: ray.origin[i],
        inverse: inverse[i],
        slack: slack[i],
        backward: u32::from(inverse[i] < 0.0),
    };
    Some(([axis(0), axis(1), axis(2), axis(2)], root_begin, root_end))
}

#[inline(always)]
fn traverse(tree: &Tree, ray: &Ray, any: bool, hit: &mut Hit, primitives: &mut impl Primitives) {
    let Some((axes, root_begin, root_end)) = start(tree, ray, hit.t) else {
        return;
    };
    let mut stack = [Waiting::default(); MAX_DEPTH as usize];
    let mut waiting = 0;
    let mut index = 0u32;
    let mut begin = root_begin;
    let mut end = root_end;
    loop {
        let mut node = tree.nodes[index as usize];
        while !node.is_leaf() {
            let Axis { origin, inverse, slack, backward } = axes[(node.word1 & 3) as usize];
            let near = node.children() | backward;
            let far = near ^ 1;
            let t = (Real::from_bits(node.word0) - origin) * inverse;
            let margin = slack * (larger(end, -begin) + tree.primitive_size);
            let t_first = t - margin;
            let t_last = t + margin;
            let enter_near = (t_last >= begin) & !node.is_empty(backward);
            let enter_far = (t_first <= end) & !node.is_empty(backward ^ 1);
            if enter_near {
                if enter_far {
                    stack[waiting] = Waiting { node: far, begin: larger(begin, t_first), end };
                    waiting += 1;
                }
                index = near;
                end = smaller(end, t_last);
            } else if enter_far {
                index = far;
                begin = larger(begin, t_first);
            } else {
                index = NOTHING;
            }
            node = tree.nodes[index as usize];
        }

        let references = &tree.refs[node.range()];
        if !references.is_empty() {
            primitives.intersect(references, ray, hit);
            if any && hit.reference != NONE {
                return;
            }
        }

        loop {
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            Waiting { node: index, begin, end } = stack[waiting];
            if begin <= hit.t {
                end = smaller(end, hit.t);
                break;
            }
        }
    }
}
