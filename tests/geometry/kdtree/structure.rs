//! Structure of the tree: completeness, perfect splits, predicted cost, and independence of the
//! number of threads.

use crate::brute_force::*;
use caustica::low_level::accel::kdtree::{INTERSECTION_COST, KdTree, Primitive, build};
use caustica::low_level::shapes::aabb::Aabb;
use caustica::low_level::shapes::kdtree::{MAX_DEPTH, traverse_closest};
use caustica::low_level::shapes::ray::{Hit, Ray};
use glam::{DVec3, Vec3};
use std::cell::Cell;

fn leaves(tree: &KdTree) -> Vec<(Aabb, Vec<u32>)> {
    let mut out = Vec::new();
    let mut open = vec![(0, tree.bounds)];
    while let Some((index, cell)) = open.pop() {
        let node = tree.nodes[index];
        if node.is_leaf() {
            out.push((cell, tree.refs[node.range()].to_vec()));
        } else {
            let (axis, position, lower) = node.plane();
            let (low, high) = cell.split(axis, position);
            open.extend([(lower as usize, low), (lower as usize + 1, high)]);
        }
    }
    out
}

/// Counts points of triangles that lie in a leaf which does not contain the triangle.
fn lost(mesh: &[[Vec3; 3]], tree: &KdTree) -> usize {
    let mut rng = Rng(2);
    let known = |p: Vec3, reference: u32| {
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let node = tree.nodes[index];
            if node.is_leaf() {
                if tree.refs[node.range()].contains(&reference) {
                    return true;
                }
            } else {
                let (axis, position, lower) = node.plane();
                // The point is rounded, so near a plane either side is accepted.
                if p[axis] <= position + 1e-6 {
                    open.push(lower as usize);
                }
                if p[axis] >= position - 1e-6 {
                    open.push(lower as usize + 1);
                }
            }
        }
        false
    };
    let mut count = 0;
    for (i, t) in mesh.iter().enumerate() {
        for _ in 0..20 {
            let (mut u, mut v) = (rng.signed().abs(), rng.signed().abs());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
            count += usize::from(!known(p, i as u32));
        }
    }
    count
}

/// Theory: every point of a primitive lies in a leaf that contains the primitive.
#[test]
fn no_point_of_a_triangle_is_lost() {
    for mesh in [displaced_torus(120, 60), displaced_sphere(40, 20)] {
        let mut tree = build(&prims(&mesh));
        assert_eq!(lost(&mesh, &tree), 0);
        let full = (0..tree.nodes.len())
            .find(|&i| tree.nodes[i].is_leaf() && !tree.nodes[i].range().is_empty());
        tree.nodes[full.expect("a mesh fills leaves")].word1 = 3;
        assert!(lost(&mesh, &tree) > 0, "planted");
    }
}

/// Counts children that their parent declares empty and that are not, or the reverse.
fn misnamed(tree: &KdTree) -> usize {
    let nodes = tree.nodes.iter().filter(|node| !node.is_leaf());
    nodes
        .map(|node| {
            let (_, _, lower) = node.plane();
            let wrong = |child: u32| {
                let it = tree.nodes[(lower + child) as usize];
                node.is_empty(child) != (it.is_leaf() && it.range().is_empty())
            };
            usize::from(wrong(0)) + usize::from(wrong(1))
        })
        .sum()
}

/// Theory: a node states for each child whether it is an empty leaf, and at least one is not.
#[test]
fn nodes_know_empty_children() {
    for (name, prims) in scenes() {
        let mut tree = build(&prims);
        assert_eq!(misnamed(&tree), 0, "{name}");
        let inner = tree.nodes.iter().filter(|node| !node.is_leaf());
        assert!(inner.clone().all(|node| !(node.is_empty(0) && node.is_empty(1))), "{name}");
        let full = (0..tree.nodes.len())
            .skip(2)
            .find(|&i| tree.nodes[i].is_leaf() && !tree.nodes[i].range().is_empty());
        if let Some(full) = full {
            tree.nodes[full].word1 = 3;
            assert_eq!(misnamed(&tree), 1, "{name}: planted");
        }
    }
}

/// Whether a plane separates triangle and box by more than `gap` (the 13 axes of Akenine-Moeller
/// 2001).
fn separated(t: &[Vec3; 3], cell: Aabb, gap: f64) -> bool {
    let c = (cell.min.as_dvec3() + cell.max.as_dvec3()) * 0.5;
    let h = (cell.max.as_dvec3() - cell.min.as_dvec3()) * 0.5;
    let p = t.map(|p| p.as_dvec3() - c);
    let e = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
    let mut axes = vec![DVec3::X, DVec3::Y, DVec3::Z, e[0].cross(e[1])];
    axes.extend(e.iter().flat_map(|e| [e.cross(DVec3::X), e.cross(DVec3::Y), e.cross(DVec3::Z)]));
    axes.iter().filter(|a| a.length() > 1e-12).any(|a| {
        let a = a.normalize();
        let reach = a.abs().dot(h);
        let d = p.map(|p| p.dot(a));
        d.iter().all(|&d| d > reach + gap) || d.iter().all(|&d| d < -reach - gap)
    })
}

/// Theory: with perfect splits a leaf contains only primitives that enter its cell. Splits by
/// bounding boxes would add many slanted triangles that do not.
#[test]
fn leaves_name_only_what_they_hold() {
    let mut rng = Rng(4);
    let mesh: Vec<[Vec3; 3]> = (0..2000)
        .map(|_| {
            let p = rng.point();
            [p, p + 0.4 * rng.point(), p + 0.4 * rng.point()]
        })
        .collect();
    let tree = build(&prims(&mesh));
    let wrong = |clipped: bool| -> usize {
        let tree = if clipped {
            tree.clone()
        } else {
            build(&mesh.iter().map(|t| Primitive::Box(Aabb::of_points(t))).collect::<Vec<_>>())
        };
        let count = |(cell, refs): &(Aabb, Vec<u32>)| {
            refs.iter().filter(|&&r| separated(&mesh[r as usize], *cell, 1e-6)).count()
        };
        leaves(&tree).iter().map(count).sum()
    };
    assert_eq!(wrong(true), 0);
    assert!(wrong(false) > 100, "planted: boxes in place of triangles: {}", wrong(false));
}

/// Theory (Santalo): of the uniformly distributed lines that cross a convex body, the share that
/// crosses a convex part of it is the ratio of surface areas. So the mean number of primitives
/// tested per line, with no hit to stop it, is the sum over leaves of area ratio times number, and
/// the heuristic's cost adds the same over all nodes.
#[test]
fn cost_is_what_random_lines_pay() {
    let mesh = displaced_torus(120, 60);
    let tree = build(&prims(&mesh));
    let expected: f64 = leaves(&tree)
        .iter()
        .map(|(cell, refs)| cell.half_area() / tree.bounds.half_area() * refs.len() as f64)
        .sum();
    let mut rng = Rng(9);
    let (mut lines, mut sum, mut sum_sq) = (0.0, 0.0, 0.0);
    for _ in 0..400_000 {
        // Uniform lines through a sphere around the box: a point on it, a cosine-distributed
        // direction inward.
        let n = rng.direction();
        let d = (rng.direction() - n).normalize_or(-n);
        let ray = Ray { origin: n * 2.0, t_min: 0.0, direction: d, t_max: 1e30 };
        let tests = Cell::new(0usize);
        traverse_closest(
            &tree.view(),
            &ray,
            &mut Hit::none(&ray),
            |leaf: &[u32], _: &Ray, _: &mut Hit| {
                tests.set(tests.get() + leaf.len());
            },
        );
        if crosses(tree.bounds, &ray) {
            lines += 1.0;
            sum += tests.get() as f64;
            sum_sq += (tests.get() as f64).powi(2);
        }
    }
    let mean = sum / lines;
    let sigma = ((sum_sq / lines - mean * mean) / lines).sqrt();
    println!("tests per line: {mean:.3} +- {sigma:.3}, expected {expected:.3}; {:?}", tree.stats);
    assert!((mean - expected).abs() < 4.0 * sigma + 1e-3 * expected);
    // The comparison detects an error of 5 %.
    assert!((mean - 1.05 * expected).abs() > 4.0 * sigma + 1e-3 * expected);
    assert!(tree.stats.cost > INTERSECTION_COST * expected);
    let one_leaf = INTERSECTION_COST * mesh.len() as f64;
    assert!(tree.stats.cost < 0.02 * one_leaf, "worth building");
}

fn crosses(b: Aabb, ray: &Ray) -> bool {
    let t0 = (b.min - ray.origin) / ray.direction;
    let t1 = (b.max - ray.origin) / ray.direction;
    t0.min(t1).max_element() <= t0.max(t1).min_element()
}

/// Depth and counts match the statistics, and the tree does not depend on the number of threads.
#[test]
fn one_input_one_tree() {
    let mesh = prims(&displaced_sphere(150, 75));
    let with = |threads: usize| {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        pool.install(|| build(&mesh))
    };
    let tree = with(1);
    assert!(mesh.len() > 1 << 14, "large enough to be split over threads");
    assert!(tree == with(3));
    let mut moved = mesh.clone();
    moved.swap(700, 7000);
    assert!(tree != build(&moved), "planted: two triangles swapped");
    let all = leaves(&tree);
    assert_eq!(all.len(), tree.stats.leaves);
    assert_eq!(all.iter().filter(|l| l.1.is_empty()).count(), tree.stats.empty_leaves);
    // An empty leaf lies next to the root.
    assert_eq!(2 * all.len(), tree.nodes.len());
    assert!(tree.stats.depth <= MAX_DEPTH);
    assert!(tree.refs.len() < 4 * mesh.len(), "{}", tree.refs.len());
}
