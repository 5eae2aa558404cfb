//! Ray traversal of the kd-tree. Twin: `shaders/shapes/kdtree.wgsl`.
//!
//! The stack of deferred far children is as deep as the tree. A node stores which of its children
//! are empty: these leaves, more than half of all, are neither read nor pushed. Both twins test the
//! same leaves in the same order, so ties in the distance resolve identically.
//!
//! The error of a computed hit is at most about 30 roundings of the primitive's largest coordinate
//! relative to the ray's origin. That coordinate is at most the hit distance plus the primitive's
//! extent. Every splitting plane is therefore treated as a slab of half-width
//! `SLACK (|t| + primitive_size)`, with the greatest `|t|` of the ray's interval in the node
//! (compare the interval padding of Ize 2013, "Robust BVH Ray Traversal"): a ray inside the slab
//! visits both children, and the nearest computed hit equals that of a brute-force search over all
//! primitives. The slab narrows with the interval, so distant geometry does not widen it. The
//! builder pads the few primitives that are larger than `primitive_size`.

use super::math::EPS;
use super::ray::{Hit, Ray};
use super::real::{Bits, Plain, Real, Vec3};
use super::table::NONE;
use bytemuck::Zeroable;

/// Greatest number of interior nodes above a leaf, and so the greatest number of deferred children.
pub const MAX_DEPTH: u32 = 32;
/// Half-width of the slab about a splitting plane, as a fraction of the hit distance plus the
/// primitive's size: 64 EPS. The watertight triangle test contributes at most about 30 EPS (7 EPS
/// is the most observed), the distance to the plane 3 EPS.
pub const SLACK: Real = 64.0 * EPS;
/// Replaces direction components that are (nearly) zero. So small that a slab parallel to the ray
/// and outside it is never reached within the tree, and one that contains the ray is never left.
const LEVEL: Real = 1e-20;

/// Node of the kd-tree in 8 bytes (16 in f64). Siblings are adjacent, the lower one at an even
/// index.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Zeroable)]
pub struct Node {
    /// Interior: bits of the splitting plane's position. Leaf: index of its first reference.
    pub word0: Bits,
    /// Interior: half the lower child's index << 4, | 8 if the upper child is empty, | 4 if the
    /// lower child is empty, | axis. Leaf: number of references << 2 | 3.
    pub word1: u32,
}

/// Index of an empty leaf: the root's unused sibling.
pub(super) const NOTHING: u32 = 1;

impl Node {
    /// Interior node split at `axis = position`. Its children are at `children`, which is even, and
    /// `children + 1`; `empty[i]` is true if child `i` is a leaf without references.
    pub fn interior(axis: usize, position: Real, children: u32, empty: [bool; 2]) -> Node {
        let empty = u32::from(empty[1]) << 3 | u32::from(empty[0]) << 2;
        Node { word0: position.to_bits(), word1: children << 3 | empty | axis as u32 }
    }

    /// Leaf with the `count` references from index `first`.
    pub fn leaf(first: u32, count: u32) -> Node {
        Node { word0: first as Bits, word1: count << 2 | 3 }
    }

    /// Returns true if the node has no children.
    #[inline]
    pub fn is_leaf(self) -> bool {
        self.word1 & 3 == 3
    }

    /// Interior: axis and position of the splitting plane, and index of the lower child.
    #[inline]
    pub fn plane(self) -> (usize, Real, u32) {
        ((self.word1 & 3) as usize, Real::from_bits(self.word0), self.children())
    }

    /// Interior: index of the lower child.
    #[inline(always)]
    fn children(self) -> u32 {
        self.word1 >> 3 & !1
    }

    /// Interior: returns true if the lower (0) or upper (1) child is an empty leaf.
    #[inline(always)]
    pub fn is_empty(self, child: u32) -> bool {
        self.word1 >> (2 + child) & 1 != 0
    }

    /// Leaf: range of its references.
    #[inline]
    pub fn range(self) -> std::ops::Range<usize> {
        let first = self.word0 as usize;
        first..first + (self.word1 >> 2) as usize
    }
}

/// kd-tree as the kernels read it; `nodes` has at least two entries.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    /// Nodes: the root, an empty leaf as its sibling, then pairs of siblings.
    pub nodes: &'a [Node],
    /// References in leaf order.
    pub refs: &'a [u32],
    /// Least corner of the bounding box of all primitives.
    pub bounds_min: Vec3,
    /// Greatest corner of that box.
    pub bounds_max: Vec3,
    /// Largest primitive extent (scene units) for which the slab about a plane covers the rounding
    /// of the intersection tests; the builder pads larger primitives.
    pub primitive_size: Real,
}

/// Deferred child: its index and the ray's interval in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Waiting {
    pub node: u32,
    pub begin: Real,
    pub end: Real,
}

/// Maximum in one instruction; `Real::max` takes four because it handles NaN.
#[inline]
pub(super) fn larger(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

/// Minimum in one instruction; see [`larger`].
#[inline]
pub(super) fn smaller(a: Real, b: Real) -> Real {
    if a < b { a } else { b }
}

#[inline]
fn reciprocal(d: Real) -> Real {
    1.0 / if d.abs() < LEVEL { LEVEL } else { d }
}

/// Per-ray constants of the traversal along one axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub origin: Real,
    pub inverse: Real,
    /// `SLACK` over the magnitude of the direction's component: half-width of a slab in t, per unit
    /// of distance.
    pub slack: Real,
    /// 1 if the ray reaches the upper child first, else 0.
    pub backward: u32,
}

/// Intersection tests for the primitives in leaves.
pub trait Primitives {
    /// Tests the primitives of a leaf, given by `references`, and replaces `hit` by any nearer hit.
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit);
    /// Runs the tests that were deferred to the end of the traversal.
    #[inline(always)]
    fn finish(&mut self, _ray: &Ray, _hit: &mut Hit) {}
    /// Prefetches the data that [`Primitives::intersect`] will read.
    fn expect(&self, _references: &[u32]) {}
}

impl<F: Fn(&[u32], &Ray, &mut Hit)> Primitives for F {
    #[inline(always)]
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit) {
        self(references, ray, hit);
    }
}

/// Sets `hit` to the nearest hit with a primitive of the tree, if that is nearer.
#[inline(always)]
pub fn traverse_closest(tree: &Tree, ray: &Ray, hit: &mut Hit, mut primitives: impl Primitives) {
    traverse(tree, ray, false, hit, &mut primitives);
    primitives.finish(ray, hit);
}

/// Tests leaves until something is hit; returns true if `hit` is then not [`NONE`].
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

/// Returns the per-axis constants of the ray and its interval, up to `t_max`, in the tree's box, or
/// `None` if it misses the box. The fourth entry, a copy of z, keeps two-bit axis indices in range.
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
        // descend to a leaf: near child first, the far one deferred if the ray enters it too
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

        // resume at the nearest deferred child that starts before the hit
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
