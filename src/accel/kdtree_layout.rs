//! The order of the nodes in memory: a walk down the tree should touch few cache lines.

use super::kdtree::Part;
use super::shapes::aabb::Aabb;
use super::shapes::kdtree::Node;

/// Pairs of siblings in a cache line of 64 bytes.
const LINE: usize = 4;

/// An interior node whose children have no place yet.
struct Open {
    /// Where it lies in the new order.
    place: usize,
    /// Where it lay in the old one.
    old: usize,
    cell: Aabb,
}

/// Puts the nodes of a tree in the order that rays walk them in: siblings side by side, and with
/// them in the cache line, one after the other, those children of the nodes in it that most rays
/// visit, by the area of their cells.
pub(super) fn laid_out(nodes: &[Part], bounds: Aabb) -> Vec<Node> {
    // Beside the root lies an empty leaf, so that pairs begin at even indices.
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
