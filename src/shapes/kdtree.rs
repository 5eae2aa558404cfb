//! Rays through the kd-tree. Twin: `shaders/shapes/kdtree.wgsl`.
//!
//! A short stack in a ring (Horn et al. 2007) remembers the far children that wait; when it is full it forgets its
//! oldest entry. One bit per level of the tree says at which levels a far child still waits (the restart trail of
//! Laine 2010), so a forgotten entry is found again by a walk down from the root: no node is ever dropped, and the
//! bits, read as a number, fall with every walk, so it ends whatever the rounding.
//!
//! A computed hit may lie off its primitive by a few roundings of the largest coordinate relative to the ray's
//! origin. So every plane is taken as a slab of half-width `SLACK` times that length: a ray that is in the slab
//! visits both sides, and the nearest computed hit is found exactly as by trying all primitives.

use super::math::EPS;
use super::ray::{Hit, NONE, Ray};
use super::real::{Bits, Plain, Real, Vec3};
use bytemuck::Zeroable;

/// Entries of the short stack.
pub const STACK: usize = 24;
/// Greatest number of interior nodes above a leaf: one bit each in a word.
pub const MAX_DEPTH: u32 = 32;
/// Half-width of the slab about a plane, relative to the largest coordinate of the tree's box as seen from the ray's
/// origin: 64 roundings. The watertight triangle test is bounded by about 30 (7 is the most seen), the plane's
/// distance by 3.
const SLACK: Real = 64.0 * EPS;
/// Stands for a direction component that is (nearly) zero: so small that a slab which the ray runs beside is never
/// reached within the tree, and one which the ray runs in is never left.
const LEVEL: Real = 1e-20;

/// A node of the kd-tree in 8 bytes (16 in f64). A left child follows its parent in memory.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Zeroable)]
pub struct Node {
    /// Interior: bits of the splitting plane's position. Leaf: index of its first reference.
    pub word0: Bits,
    /// Interior: index of the right child << 2 | axis. Leaf: number of references << 2 | 3.
    pub word1: u32,
}

impl Node {
    /// A node with two children, split at `axis = position`.
    pub fn interior(axis: usize, position: Real, right: u32) -> Node {
        Node { word0: position.to_bits(), word1: right << 2 | axis as u32 }
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

    /// Interior: axis and position of the plane, and index of the right child.
    #[inline]
    pub fn plane(self) -> (usize, Real, u32) {
        ((self.word1 & 3) as usize, Real::from_bits(self.word0), self.word1 >> 2)
    }

    /// Leaf: the range of its references.
    #[inline]
    pub fn range(self) -> std::ops::Range<usize> {
        let first = self.word0 as usize;
        first..first + (self.word1 >> 2) as usize
    }
}

/// A kd-tree as the kernels see it; `nodes` has at least the root.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    /// Nodes, the root first.
    pub nodes: &'a [Node],
    /// References in the order of the leaves.
    pub refs: &'a [u32],
    /// Least corner of the box about everything.
    pub bounds_min: Vec3,
    /// Greatest corner.
    pub bounds_max: Vec3,
}

/// A child that waits: its index and the ray's interval in it.
#[derive(Clone, Copy, Default)]
struct Waiting {
    node: u32,
    begin: Real,
    end: Real,
}

#[inline]
fn reciprocal(d: Real) -> Real {
    1.0 / if d.abs() < LEVEL { LEVEL } else { d }
}

/// Lowers `hit` to the nearest hit with a primitive of the tree. `intersect(reference, ray, hit)` tests one
/// primitive and replaces `hit` by anything nearer.
#[inline]
pub fn traverse_closest(tree: &Tree, ray: &Ray, hit: &mut Hit, intersect: impl Fn(u32, &Ray, &mut Hit)) {
    traverse::<STACK>(tree, ray, false, hit, intersect);
}

/// Whether `hit` is not [`NONE`] after testing primitives of the tree until one is hit.
#[inline]
pub fn traverse_any(tree: &Tree, ray: &Ray, hit: &mut Hit, intersect: impl Fn(u32, &Ray, &mut Hit)) -> bool {
    traverse::<STACK>(tree, ray, true, hit, intersect);
    hit.reference != NONE
}

/// [`traverse_closest`], or [`traverse_any`] if `any`, with a stack of `SIZE` entries; the answer does not depend on it.
#[inline]
pub fn traverse<const SIZE: usize>(
    tree: &Tree,
    ray: &Ray,
    any: bool,
    hit: &mut Hit,
    intersect: impl Fn(u32, &Ray, &mut Hit),
) {
    let inverse =
        Vec3::new(reciprocal(ray.direction.x), reciprocal(ray.direction.y), reciprocal(ray.direction.z));
    let to_min = tree.bounds_min - ray.origin;
    let to_max = tree.bounds_max - ray.origin;
    let reach = to_min.abs().max(to_max.abs());
    let slack = (SLACK * reach.x.max(reach.y).max(reach.z)) * inverse.abs();
    let t0 = to_min * inverse;
    let t1 = to_max * inverse;
    let enter = t0.min(t1) - slack;
    let leave = t0.max(t1) + slack;
    let root_begin = ray.t_min.max(enter.x).max(enter.y).max(enter.z);
    let root_end = hit.t.min(leave.x).min(leave.y).min(leave.z);
    if root_begin > root_end {
        return;
    }
    // Per axis: origin, inverse direction, slack.
    let axes: [[Real; 4]; 4] = [
        [ray.origin.x, inverse.x, slack.x, 0.0],
        [ray.origin.y, inverse.y, slack.y, 0.0],
        [ray.origin.z, inverse.z, slack.z, 0.0],
        [0.0; 4],
    ];

    let mut stack = [Waiting::default(); SIZE];
    let mut top = 0;
    let mut stored = 0;
    // Bit `level`: a far child of this level's node on the path waits.
    let mut waiting = 0u32;
    // Above this level the path is known from `waiting`.
    let mut known = 0u32;
    let mut level = 0u32;
    let mut index = 0u32;
    let mut begin = root_begin;
    let mut end = root_end;
    loop {
        let mut node = tree.nodes[index as usize];
        while !node.is_leaf() {
            let [origin, inverse, slack, _] = axes[(node.word1 & 3) as usize];
            let right = node.word1 >> 2;
            let near = if inverse > 0.0 { index + 1 } else { right };
            let far = if inverse > 0.0 { right } else { index + 1 };
            let t = (Real::from_bits(node.word0) - origin) * inverse;
            let t_first = t - slack;
            let t_last = t + slack;
            if t_first > end {
                index = near;
            } else if t_last < begin {
                index = far;
            } else {
                let bit = 1u32 << level;
                if level >= known {
                    waiting |= bit;
                }
                if waiting & bit != 0 {
                    top = if top + 1 == SIZE { 0 } else { top + 1 };
                    stack[top] = Waiting { node: far, begin: begin.max(t_first), end };
                    stored = if stored == SIZE { SIZE } else { stored + 1 };
                    index = near;
                    end = end.min(t_last);
                } else {
                    index = far;
                    begin = begin.max(t_first);
                }
            }
            level += 1;
            node = tree.nodes[index as usize];
        }
        known = 0;

        for &reference in &tree.refs[node.range()] {
            intersect(reference, ray, hit);
            if any && hit.reference != NONE {
                return;
            }
        }

        loop {
            if waiting == 0 {
                return;
            }
            level = 31 - waiting.leading_zeros();
            waiting ^= 1u32 << level;
            if stored == 0 {
                known = level + 1;
                level = 0;
                index = 0;
                begin = root_begin;
                end = root_end;
                break;
            }
            Waiting { node: index, begin, end } = stack[top];
            top = if top == 0 { SIZE - 1 } else { top - 1 };
            stored -= 1;
            level += 1;
            if begin <= hit.t {
                break;
            }
        }
    }
}
