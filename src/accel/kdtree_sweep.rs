//! Exact splits: every plane that bounds a primitive is a candidate (Wald & Havran 2006, section
//! 4.3).
//!
//! Per axis, a sorted list of events records the positions at which primitives end, lie in a plane
//! or start. A split filters the lists, which keeps them sorted, and merges in the events of the
//! primitives that straddle the plane.

use super::kdtree::{Heuristic, INTERSECTION_COST, Item, Part, Subtree};
use super::kdtree_bins::parts;
use super::kdtree_clip::Geometry;
use super::real::{Bits, Real, WideBits};
use super::shapes::aabb::Aabb;

/// Kinds of events, in their order at equal positions: the order in which the sweep processes them.
const END: Event = 0;
const PLANAR: Event = 1;
const START: Event = 2;

/// Position (in an order-preserving encoding), kind and item in one word, so that events sort as
/// integers.
type Event = WideBits;
/// Sorted events along each axis.
type Events = [Vec<Event>; 3];

const ITEM_BITS: u32 = 30;
const SIGN: Bits = 1 << (Bits::BITS - 1);

fn event(position: Real, kind: Event, item: usize) -> Event {
    // adding plus zero turns -0 into 0
    let bits = (position + 0.0).to_bits();
    let code = if bits & SIGN != 0 { !bits } else { bits | SIGN };
    Event::from(code) << 32 | kind << ITEM_BITS | item as Event
}

fn position(event: Event) -> Real {
    let code = (event >> 32) as Bits;
    Real::from_bits(if code & SIGN != 0 { code & !SIGN } else { !code })
}

fn kind(event: Event) -> Event {
    event >> ITEM_BITS & 3
}

fn item(event: Event) -> usize {
    (event & ((1 << ITEM_BITS) - 1)) as usize
}

fn push_events(events: &mut Events, bounds: Aabb, item: usize) {
    for (axis, events) in events.iter_mut().enumerate() {
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        if low == high {
            events.push(event(low, PLANAR, item));
        } else {
            events.push(event(low, START, item));
            events.push(event(high, END, item));
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
    Both,
}

/// Splitting plane, and the side that receives the primitives that lie in it.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    position: Real,
    planar_left: bool,
}

/// Builder of one subtree.
pub(super) struct Sweep<'a> {
    geometry: &'a Geometry<'a>,
    /// Primitive of each item.
    ids: Vec<u32>,
    /// Side of each item in the current split.
    sides: Vec<Side>,
    levels: u32,
    tree: Subtree,
}

impl<'a> Sweep<'a> {
    /// Builder for a subtree over `items`, at most `levels` deep.
    pub fn new(geometry: &'a Geometry<'a>, items: &[Item], levels: u32) -> Sweep<'a> {
        Sweep {
            geometry,
            ids: items.iter().map(|i| i.prim).collect(),
            sides: vec![Side::Both; items.len()],
            levels,
            tree: Subtree::default(),
        }
    }

    /// Builds the subtree of `cell`.
    pub fn build(mut self, items: &[Item], cell: Aabb) -> Subtree {
        let mut events = Events::default();
        for (i, item) in items.iter().enumerate() {
            push_events(&mut events, item.bounds, i);
        }
        events.iter_mut().for_each(|e| e.sort_unstable());
        self.node(events, items.len(), cell, 0);
        self.tree
    }

    fn node(&mut self, events: Events, count: usize, cell: Aabb, level: u32) {
        let split = if level < self.levels { best_split(&events, count, cell) } else { None };
        let Some(split) = split else {
            self.leaf(&events[0]);
            return;
        };
        let (low, high) = cell.split(split.axis, split.position);
        let ([left, right], [left_count, right_count]) = self.divide(events, split, low, high);
        let index = self.tree.nodes.len();
        self.tree.nodes.push(Part::Leaf { first: 0, count: 0 });
        self.node(left, left_count, low, level + 1);
        let upper = self.tree.nodes.len() as u32;
        self.tree.nodes[index] =
            Part::Split { axis: split.axis as u8, position: split.position, upper };
        self.node(right, right_count, high, level + 1);
    }

    fn leaf(&mut self, events: &[Event]) {
        let first = self.tree.refs.len();
        self.tree
            .refs
            .extend(events.iter().filter(|&&e| kind(e) != END).map(|&e| self.ids[item(e)]));
        self.tree.refs[first..].sort_unstable();
        let count = (self.tree.refs.len() - first) as u32;
        self.tree.nodes.push(Part::Leaf { first: first as u32, count });
    }

    /// Returns the events and the numbers of items in the two cells of a split.
    fn divide(
        &mut self,
        events: Events,
        split: Split,
        low: Aabb,
        high: Aabb,
    ) -> ([Events; 2], [usize; 2]) {
        // classify the items
        let mut counts = [0; 2];
        for &e in &events[split.axis] {
            let p = position(e);
            let side = match kind(e) {
                START if p >= split.position => Side::Right,
                START => Side::Both,
                END if p <= split.position => Side::Left,
                END => continue,
                _ if p < split.position || (p == split.position && split.planar_left) => Side::Left,
                _ => Side::Right,
            };
            self.sides[item(e)] = side;
        }
        // clip the items that straddle the plane to both cells
        let mut new = [Events::default(), Events::default()];
        for &e in events[split.axis].iter().filter(|&&e| kind(e) != END) {
            match self.sides[item(e)] {
                Side::Left => counts[0] += 1,
                Side::Right => counts[1] += 1,
                Side::Both => {
                    let (a, b) = parts(self.geometry, self.ids[item(e)], low, high);
                    for (side, part) in [a, b].into_iter().enumerate() {
                        if let Some(bounds) = part {
                            push_events(&mut new[side], bounds, item(e));
                            counts[side] += 1;
                        }
                    }
                }
            }
        }
        // filter the lists and merge in the new events
        let mut divided = [Events::default(), Events::default()];
        for (axis, events) in events.into_iter().enumerate() {
            for (side, wanted) in [Side::Left, Side::Right].into_iter().enumerate() {
                let added = &mut new[side][axis];
                added.sort_unstable();
                divided[side][axis] = merged(&events, added, |e| self.sides[item(e)] == wanted);
            }
        }
        (divided, counts)
    }
}

/// Merges the events for which `kept` holds with those in `added`.
fn merged(events: &[Event], added: &[Event], kept: impl Fn(Event) -> bool) -> Vec<Event> {
    let mut out = Vec::with_capacity(events.len() + added.len());
    let mut next = 0;
    for &e in events.iter().filter(|&&e| kept(e)) {
        while next < added.len() && added[next] < e {
            out.push(added[next]);
            next += 1;
        }
        out.push(e);
    }
    out.extend_from_slice(&added[next..]);
    out
}

/// Plane of least expected cost strictly inside the cell, or `None` if a leaf is cheaper.
fn best_split(events: &Events, count: usize, cell: Aabb) -> Option<Split> {
    let mut best = None;
    let mut best_cost = INTERSECTION_COST * count as f64;
    for (axis, events) in events.iter().enumerate() {
        let heuristic = Heuristic::new(cell, axis)?;
        let mut left = 0;
        let mut right = count;
        let mut i = 0;
        // gather the events at one position
        while i < events.len() {
            let here = events[i] >> 32;
            let mut numbers = [0; 3];
            while i < events.len() && events[i] >> 32 == here {
                numbers[kind(events[i]) as usize] += 1;
                i += 1;
            }
            let [ends, planar, starts] = numbers;
            right -= ends + planar;
            // cost of a split here, with the primitives in the plane on either side
            let p = position(here << 32);
            if p > cell.min[axis] && p < cell.max[axis] {
                let choices: &[bool] = if planar > 0 { &[true, false] } else { &[true] };
                for &planar_left in choices {
                    let (l, r) =
                        if planar_left { (left + planar, right) } else { (left, right + planar) };
                    let cost = heuristic.cost(p, l, r);
                    if cost < best_cost {
                        best_cost = cost;
                        best = Some(Split { axis, position: p, planar_left });
                    }
                }
            }
            left += starts + planar;
        }
    }
    best
}
