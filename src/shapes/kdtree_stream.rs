//! Traversal of the kd-tree for [`STREAM`] rays at a time: while one ray waits for memory, the
//! others advance, four per instruction. Each ray tests the same leaves in the same order as in
//! [`traverse_closest`](super::kdtree::traverse_closest), so its hit is bit-identical. CPU engine
//! only: on a GPU the lanes are rays already.
//!
//! The traversal proceeds in rounds. In each round, rays at interior nodes take one step down, by
//! the operations of `kdtree.rs`. Rays that reach a leaf wait there for two rounds: one to prefetch
//! the leaf's references, one to prefetch the primitives that these name.

use super::kdtree::{Axis, MAX_DEPTH, NOTHING, Primitives, Tree, Waiting, smaller, start};
use super::ray::{Hit, Ray};
use super::real::{Bits, Real, Reals, Words};
use wide::{CmpGe, CmpLe, CmpLt};

/// Number of rays in flight: one per bit of the `u64` sets, few enough for their stacks to fit in
/// the L1 cache.
pub const STREAM: usize = 64;
/// Number of values per SIMD instruction.
const LANES: usize = 4;
const GROUPS: usize = STREAM / LANES;
/// One number per ray.
#[derive(Clone, Copy)]
struct Each([Reals; GROUPS]);

/// One index per ray.
#[derive(Clone, Copy)]
struct EachIndex([Words; GROUPS]);

impl Each {
    const ZERO: Each = Each([Reals::ZERO; GROUPS]);

    #[inline(always)]
    fn of(&mut self, lane: usize) -> &mut Real {
        let all: &mut [Real; STREAM] = bytemuck::cast_mut(&mut self.0);
        &mut all[lane]
    }
}

impl EachIndex {
    #[inline(always)]
    fn of(&mut self, lane: usize) -> &mut Bits {
        let all: &mut [Bits; STREAM] = bytemuck::cast_mut(&mut self.0);
        &mut all[lane]
    }
}

#[inline(always)]
fn numbers(words: Words) -> Reals {
    bytemuck::cast(words)
}

#[inline(always)]
fn words(numbers: Reals) -> Words {
    bytemuck::cast(numbers)
}

/// Mask of the lanes in which bit `bit` of `word` is set.
#[inline(always)]
fn has(word: Words, bit: u32) -> Reals {
    let bit = Words::splat(1 << bit);
    numbers((word & bit).cmp_eq(bit))
}

/// Iterates over the lanes of a set, lowest first.
#[inline(always)]
fn each(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let lane = set.trailing_zeros() as usize;
            set &= set - 1;
            lane % STREAM
        })
    })
}

/// Prefetches the cache line of `what` on x86-64; does nothing elsewhere.
#[inline(always)]
pub fn fetch<T>(what: Option<&T>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(what) = what {
        safe_arch::prefetch_t0(what);
    }
}

/// [`Axis`] of every ray.
struct Axes {
    origin: Each,
    inverse: Each,
    slack: Each,
}

/// State of the traversal steps, one lane per ray.
struct Steps {
    axes: [Axes; 3],
    /// Index of the current node, and its two words.
    node: EachIndex,
    word0: Each,
    word1: EachIndex,
    /// The ray's interval in the node.
    begin: Each,
    end: Each,
    /// See [`Tree::primitive_size`].
    size: Real,
    /// Far child that may have to be pushed, and its interval.
    far: EachIndex,
    far_begin: Each,
    far_end: Each,
}

/// Sets of rays after a step.
struct Moves {
    /// Entered both children: the far one must be pushed.
    push: u64,
    /// Entered neither child.
    pop: u64,
    /// Are at a leaf.
    leaf: u64,
}

impl Steps {
    /// Moves each ray at an interior node to the child that it enters first, if any.
    #[inline(always)]
    fn step(&mut self) -> Moves {
        let [x, y, z] = &self.axes;
        let one = Words::splat(1);
        let size = Reals::splat(self.size);
        let mut moves = Moves { push: 0, pop: 0, leaf: 0 };
        for i in 0..GROUPS {
            let word1 = self.word1.0[i];
            let (low, high) = (has(word1, 0), has(word1, 1));
            let along =
                |x: &Each, y: &Each, z: &Each| high.blend(z.0[i], low.blend(y.0[i], x.0[i]));
            let origin = along(&x.origin, &y.origin, &z.origin);
            let inverse = along(&x.inverse, &y.inverse, &z.inverse);
            let slack = along(&x.slack, &y.slack, &z.slack);
            let backward = inverse.cmp_lt(Reals::ZERO);
            let near = ((word1 >> 3) & !one) | (words(backward) & one);
            let far = near ^ one;
            let t = (self.word0.0[i] - origin) * inverse;
            let (begin, end) = (self.begin.0[i], self.end.0[i]);
            let margin = slack * (end.fast_max(-begin) + size);
            let (t_first, t_last) = (t - margin, t + margin);
            let (lower_empty, upper_empty) = (has(word1, 2), has(word1, 3));
            let leaf = low & high;
            let enter_near =
                t_last.cmp_ge(begin) & !(backward.blend(upper_empty, lower_empty) | leaf);
            let enter_far =
                t_first.cmp_le(end) & !(backward.blend(lower_empty, upper_empty) | leaf);
            let only_far = enter_far & !enter_near;
            let far_begin = begin.fast_max(t_first);
            self.far.0[i] = far;
            self.far_begin.0[i] = far_begin;
            self.far_end.0[i] = end;
            let node = numbers(self.node.0[i]);
            self.node.0[i] =
                words(enter_near.blend(numbers(near), only_far.blend(numbers(far), node)));
            self.begin.0[i] = only_far.blend(far_begin, begin);
            self.end.0[i] = enter_near.blend(end.fast_min(t_last), end);
            let set = |mask: Reals| (mask.move_mask() as u64) << (LANES * i);
            moves.push |= set(enter_near & enter_far);
            moves.pop |= set(!(enter_near | enter_far | leaf));
            moves.leaf |= set(leaf);
        }
        moves
    }
}

/// Source of the rays and receiver of their hits.
pub trait Rays {
    /// Returns the next ray for this lane and its nearest hit with the shapes outside the tree;
    /// `last` is the hit of the lane's previous ray, if there was one.
    fn next(&mut self, lane: usize, last: Option<&Hit>) -> Option<(Ray, Hit)>;
}

/// Ray in flight, with its hit so far.
struct Walk<P> {
    ray: Ray,
    hit: Hit,
    primitives: P,
}

/// Deferred children of one ray.
#[derive(Clone, Copy)]
struct Stack {
    count: usize,
    children: [Waiting; MAX_DEPTH as usize],
}

struct Flight<'a, R, P, F> {
    tree: &'a Tree<'a>,
    rays: &'a mut R,
    primitives: F,
    /// Set of lanes without a ray.
    idle: u64,
    steps: Steps,
    stacks: [Stack; STREAM],
    walks: [Option<Walk<P>>; STREAM],
}

/// Finds the nearest hit of each of `rays` with the primitives of the tree.
#[inline(always)]
pub fn traverse_closest_many<P: Primitives>(
    tree: &Tree,
    rays: &mut impl Rays,
    primitives: impl Fn(&Ray) -> P,
) {
    let nowhere = EachIndex([Words::splat(Bits::from(NOTHING)); GROUPS]);
    let axes = || Axes { origin: Each::ZERO, inverse: Each::ZERO, slack: Each::ZERO };
    let steps = Steps {
        axes: [axes(), axes(), axes()],
        node: nowhere,
        word0: Each::ZERO,
        word1: nowhere,
        begin: Each::ZERO,
        end: Each::ZERO,
        size: tree.primitive_size,
        far: nowhere,
        far_begin: Each::ZERO,
        far_end: Each::ZERO,
    };
    let stacks = [Stack { count: 0, children: [Waiting::default(); MAX_DEPTH as usize] }; STREAM];
    let walks = std::array::from_fn(|_| None);
    Flight { tree, rays, primitives, idle: 0, steps, stacks, walks }.fly();
}

impl<R: Rays, P: Primitives, F: Fn(&Ray) -> P> Flight<'_, R, P, F> {
    /// Runs rounds until no lane has a ray.
    #[inline(always)]
    fn fly(&mut self) {
        let all = u64::MAX;
        for lane in each(all) {
            self.take(lane, None);
        }
        // lanes that wait at a leaf: all, those that reached it last round, and those one round
        // earlier
        let (mut held, mut early, mut late) = (0, 0, 0);
        while self.idle != all {
            held &= !late;
            for lane in each(late) {
                self.leaf(lane);
            }
            for lane in each(early) {
                self.expect_primitives(lane);
            }
            late = early;
            for lane in 0..STREAM {
                let node = self.tree.nodes[*self.steps.node.of(lane) as usize];
                *self.steps.word0.of(lane) = Real::from_bits(node.word0);
                *self.steps.word1.of(lane) = Bits::from(node.word1);
            }
            let Moves { push, pop, leaf } = self.steps.step();
            for lane in each(push) {
                self.push(lane);
            }
            for lane in each(pop) {
                self.next(lane);
            }
            early = leaf & !held & !self.idle;
            for lane in each(early) {
                self.expect_references(lane);
            }
            held |= early;
            for lane in 0..STREAM {
                fetch(self.tree.nodes.get(*self.steps.node.of(lane) as usize));
            }
        }
    }

    /// Pushes the far child.
    #[inline(always)]
    fn push(&mut self, lane: usize) {
        let Steps { far, far_begin, far_end, .. } = &mut self.steps;
        let stack = &mut self.stacks[lane];
        #[allow(clippy::unnecessary_cast)] // indices have the width of `Real`, which may be 64 bits
        let node = *far.of(lane) as u32;
        stack.children[stack.count] =
            Waiting { node, begin: *far_begin.of(lane), end: *far_end.of(lane) };
        stack.count += 1;
    }

    /// Resumes at the nearest deferred child; if there is none, finishes the ray and takes the
    /// next.
    #[inline(always)]
    fn next(&mut self, lane: usize) {
        let Some(walk) = &mut self.walks[lane] else {
            return;
        };
        let stack = &mut self.stacks[lane];
        while stack.count > 0 {
            stack.count -= 1;
            let Waiting { node, begin, end } = stack.children[stack.count];
            if begin <= walk.hit.t {
                *self.steps.node.of(lane) = Bits::from(node);
                *self.steps.begin.of(lane) = begin;
                *self.steps.end.of(lane) = smaller(end, walk.hit.t);
                return;
            }
        }
        walk.primitives.finish(&walk.ray, &mut walk.hit);
        let hit = walk.hit;
        self.take(lane, Some(hit));
    }

    /// Takes the next ray that meets the tree's box. Not inlined: it runs once in dozens of steps,
    /// and its code is large, since the caller's shading may be inlined into it.
    #[inline(never)]
    fn take(&mut self, lane: usize, mut last: Option<Hit>) {
        while let Some((ray, hit)) = self.rays.next(lane, last.as_ref()) {
            if let Some((axes, begin, end)) = start(self.tree, &ray, hit.t) {
                for (each, Axis { origin, inverse, slack, .. }) in
                    self.steps.axes.iter_mut().zip(axes)
                {
                    *each.origin.of(lane) = origin;
                    *each.inverse.of(lane) = inverse;
                    *each.slack.of(lane) = slack;
                }
                *self.steps.node.of(lane) = 0;
                *self.steps.begin.of(lane) = begin;
                *self.steps.end.of(lane) = end;
                let primitives = (self.primitives)(&ray);
                self.walks[lane] = Some(Walk { ray, hit, primitives });
                return;
            }
            last = Some(hit);
        }
        *self.steps.node.of(lane) = Bits::from(NOTHING);
        self.idle |= 1 << lane;
    }

    /// Tests the primitives of the leaf and resumes.
    #[inline(always)]
    fn leaf(&mut self, lane: usize) {
        let node = self.tree.nodes[*self.steps.node.of(lane) as usize];
        if let Some(walk) = &mut self.walks[lane] {
            walk.primitives.intersect(&self.tree.refs[node.range()], &walk.ray, &mut walk.hit);
        }
        self.next(lane);
    }

    #[inline(always)]
    fn expect_references(&mut self, lane: usize) {
        let node = self.tree.nodes[*self.steps.node.of(lane) as usize];
        fetch(self.tree.refs.get(node.range().start));
    }

    #[inline(always)]
    fn expect_primitives(&mut self, lane: usize) {
        let node = self.tree.nodes[*self.steps.node.of(lane) as usize];
        if let Some(walk) = &self.walks[lane] {
            walk.primitives.expect(&self.tree.refs[node.range()]);
        }
    }
}
