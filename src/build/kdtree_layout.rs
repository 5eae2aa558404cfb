//! The order of the nodes in memory: a walk down the tree should touch few cache lines.

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

/// Puts the nodes of a tree, in which a lower child follows its parent and the parent names the upper one, in the order
/// that rays walk them in: siblings side by side, and with them in the cache line, one after the other, those children of the nodes in it
/// that most rays visit, by the area of their cells.
pub(super) fn laid_out(nodes: &[Node], bounds: Aabb) -> Vec<Node> {
    // Beside the root lies an empty leaf, so that pairs begin at even indices.
    let mut out = Vec::with_capacity(nodes.len() + 1);
    out.extend([nodes[0], Node::leaf(0, 0)]);
    let mut heads = Vec::new();
    if !nodes[0].is_leaf() {
        heads.push(Open { place: 0, old: 0, cell: bounds });
    }
    let mut line = Vec::new();
    while let Some(head) = heads.pop() {
        line.push(head);
        for _ in 0..LINE {
            let area = |open: &Open| open.cell.half_area();
            let Some(widest) = (0..line.len()).max_by(|&a, &b| area(&line[a]).total_cmp(&area(&line[b])))
            else {
                break;
            };
            let Open { place, old, cell } = line.swap_remove(widest);
            let (axis, position, upper) = nodes[old].plane();
            let (low, high) = cell.split(axis, position);
            out[place] = Node::interior(axis, position, out.len() as u32);
            for (old, cell) in [(old + 1, low), (upper as usize, high)] {
                if !nodes[old].is_leaf() {
                    line.push(Open { place: out.len(), old, cell });
                }
                out.push(nodes[old]);
            }
        }
        heads.append(&mut line);
    }
    out
}
