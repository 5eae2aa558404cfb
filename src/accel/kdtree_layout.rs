//! Order of the nodes in memory, chosen so that a descent touches few cache lines.

use super::kdtree::Part;
use super::shapes::aabb::Aabb;
use super::shapes::kdtree::Node;

/// Number of sibling pairs in a cache line of 64 bytes.
const LINE: usize = 4;

/// Interior node whose children are not placed yet.
struct Open {
    /// Index in the new order.
    place: usize,
    /// Index in the old order.
    old: usize,
    cell: Aabb,
}

/// Arranges the nodes of a tree for traversal: siblings are adjacent, and a cache line is filled,
/// one pair after another, with the children of those of its nodes that most rays visit, by the
/// area of their cells.
pub(super) fn laid_out(nodes: &[Part], bounds: Aabb) -> Vec<Node> {
    // the root's sibling is an empty leaf, so that pairs start at even indices
    let mut out = vec![Node::leaf(0, 0); 2];
    let mut heads = Vec::new();
    let put = |out: &mut Vec<Node>, open: &mut Vec<Open>, place: usize, old: usize, cell| {
        match nodes[old] {
            Part::Leaf { first, count } => out[place] = Node::leaf(first, count),
            Part::Split { .. } => open.push(Open { place, old, cell }),
        }
    };
    put(&mut out, &mut heads, 0, 0, bounds);
    let mut line = Vec::new();
    while let Some(head) = heads.pop() {
        line.push(head);
        // place the children of the widest open nodes until the line is full
        for _ in 0..LINE {
            let area = |open: &Open| open.cell.half_area();
            let Some(widest) =
                (0..line.len()).max_by(|&a, &b| area(&line[a]).total_cmp(&area(&line[b])))
            else {
                break;
            };
            let Open { place, old, cell } = line.swap_remove(widest);
            if let Part::Split { axis, position, upper } = nodes[old] {
                let (lower, upper, axis) = (old + 1, upper as usize, axis as usize);
                let (low, high) = cell.split(axis, position);
                let children = out.len();
                let empty =
                    [lower, upper].map(|old| matches!(nodes[old], Part::Leaf { count: 0, .. }));
                out[place] = Node::interior(axis, position, children as u32, empty);
                out.extend([Node::leaf(0, 0); 2]);
                put(&mut out, &mut line, children, lower, low);
                put(&mut out, &mut line, children + 1, upper, high);
            }
        }
        heads.append(&mut line);
    }
    out
}
