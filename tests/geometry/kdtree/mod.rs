//! The kd-tree against exhaustive search and theory.

mod device;
mod far;
mod structure;
mod triangles;

use crate::brute_force::*;
use caustica::low_level::accel::kdtree::{KdTree, Primitive, build};
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::shapes::triangle::RayShear;
use glam::Vec3;
use std::time::Instant;

/// Counts rays for which the tree's answer differs from exhaustive search. The nearest `t` must
/// agree bit for bit; if several primitives share it, any of them may be returned.
fn mismatches(prims: &[Primitive], tree: &KdTree, rays: &[Ray], truth: &[Hit]) -> usize {
    let wrong = |ray: &Ray, want: &Hit| {
        let got = closest(prims, &tree.view(), ray);
        let any = any(prims, &tree.view(), ray);
        let mut again = Hit::none(ray);
        if got.reference != NONE {
            intersect(prims, &RayShear::new(ray), got.reference, ray, &mut again);
        }
        got.t.to_bits() != want.t.to_bits()
            || again.t.to_bits() != got.t.to_bits()
            || (got.reference == NONE) != (want.reference == NONE)
            || (any.reference == NONE) != (want.reference == NONE)
    };
    rays.iter().zip(truth).filter(|(r, t)| wrong(r, t)).count()
}

/// Counts rays whose hit differs in any bit when they are traced in a stream.
fn differ(prims: &[Primitive], tree: &KdTree, rays: &[Ray], one_by_one: &[Hit]) -> usize {
    let many = closest_many(prims, &tree.view(), rays);
    let bits = |h: &Hit| (h.t.to_bits(), h.reference, h.u.to_bits(), h.v.to_bits());
    many.iter().zip(one_by_one).filter(|(a, b)| bits(a) != bits(b)).count()
}

/// Theory: in a stream each ray tests the leaves that it tests alone, in the same order. So every
/// bit of its hit is the same, whatever other rays are in the stream: none, fewer than lanes, or
/// many.
#[test]
fn side_by_side_as_one_by_one() {
    let mut rng = Rng(17);
    for (name, prims) in scenes().into_iter().filter(|(_, prims)| !prims.is_empty()) {
        let tree = build(&prims);
        let all = rays(&prims, &tree.view(), 4000, &mut rng);
        for rays in [&all[..], &all[..5], &all[..64], &all[..0]] {
            let truth: Vec<Hit> =
                rays.iter().map(|ray| closest(&prims, &tree.view(), ray)).collect();
            assert_eq!(differ(&prims, &tree, rays, &truth), 0, "{name}");
        }
    }
    // planted error: a tree without one of its leaves
    let prims = prims(&displaced_torus(60, 30));
    let mut tree = build(&prims);
    let rays = rays(&prims, &tree.view(), 20_000, &mut rng);
    let truth: Vec<Hit> = rays.iter().map(|ray| closest(&prims, &tree.view(), ray)).collect();
    let full = (0..tree.nodes.len())
        .find(|&i| tree.nodes[i].is_leaf() && !tree.nodes[i].range().is_empty());
    tree.nodes[full.expect("a torus fills leaves")].word1 = 3;
    assert!(differ(&prims, &tree, &rays, &truth) > 0);
}

/// Theory: a tree omits only what a ray cannot hit. So for every ray the nearest t equals that of
/// exhaustive search bit for bit.
#[test]
fn same_hits_as_exhaustive_search() {
    let mut rng = Rng(7);
    for (name, prims) in scenes() {
        let tree = build(&prims);
        let count = if prims.len() > 5000 { 2000 } else { 8000 };
        let rays = rays(&prims, &tree.view(), count, &mut rng);
        let truth: Vec<Hit> = rays.iter().map(|r| exhaustive(&prims, r)).collect();
        let hits = truth.iter().filter(|h| h.reference != NONE).count();
        let wrong = mismatches(&prims, &tree, &rays, &truth);
        println!("{name}: {} primitives, {:?}, {hits} hits of {count}", prims.len(), tree.stats);
        assert_eq!(wrong, 0, "{name}");
        assert_eq!(hits > 0, !prims.is_empty(), "{name}");
    }
}

/// The comparison above must detect a tree that lost one leaf's primitives.
#[test]
fn an_emptied_leaf_is_noticed() {
    let prims = prims(&displaced_torus(60, 30));
    let mut tree = build(&prims);
    let mut rng = Rng(3);
    let rays = rays(&prims, &tree.view(), 20_000, &mut rng);
    let truth: Vec<Hit> = rays.iter().map(|r| exhaustive(&prims, r)).collect();
    assert_eq!(mismatches(&prims, &tree, &rays, &truth), 0);
    let fullest = (0..tree.nodes.len())
        .filter(|&i| tree.nodes[i].is_leaf())
        .max_by_key(|&i| tree.nodes[i].range().len())
        .expect("every tree has a leaf");
    tree.nodes[fullest].word1 = 3;
    assert!(mismatches(&prims, &tree, &rays, &truth) > 0);
}

/// Counts rays from inside a closed mesh that leave without a hit. Every ray aims at a vertex or at
/// a point of an edge, where a test that rounds differently for the two neighbours lets some pass.
fn leaks(
    mesh: &[[Vec3; 3]],
    tree: &KdTree,
    inside: impl Fn(&mut Rng) -> Vec3,
    count: usize,
) -> usize {
    let prims = prims(mesh);
    let mut rng = Rng(11);
    let leaked = |rng: &mut Rng| {
        let origin = inside(rng);
        let t = mesh[rng.below(mesh.len())];
        let (a, b) = (t[rng.below(3)], t[rng.below(3)]);
        let target = a + (b - a) * if rng.below(3) == 0 { 0.0 } else { 0.5 + 0.5 * rng.signed() };
        let d = target - origin;
        let ray = Ray { origin, t_min: 0.0, direction: d / d.length(), t_max: 1e30 };
        closest(&prims, &tree.view(), &ray).reference == NONE
    };
    (0..count).filter(|_| leaked(&mut rng)).count()
}

/// Theory: a ray from inside a closed surface meets it.
#[test]
fn closed_meshes_are_watertight() {
    let sphere = displaced_sphere(120, 60);
    let tree = build(&prims(&sphere));
    assert_eq!(leaks(&sphere, &tree, |rng| rng.point() * 0.5, 500_000), 0);
    let torus = displaced_torus(120, 60);
    let mut tree = build(&prims(&torus));
    let tube = |rng: &mut Rng| {
        let d = Vec3::new(rng.signed(), 0.0, rng.signed() + 1e-3);
        d / d.length() + rng.point() * 0.1
    };
    assert_eq!(leaks(&torus, &tree, tube, 500_000), 0);
    // Planted error: one leaf lost.
    let full = (0..tree.nodes.len())
        .find(|&i| tree.nodes[i].is_leaf() && !tree.nodes[i].range().is_empty());
    tree.nodes[full.expect("a torus fills leaves")].word1 = 3;
    assert!(leaks(&torus, &tree, tube, 500_000) > 0);
}

/// The mesh and the rays of the comparison with Embree. Prints the rate, which depends on the
/// machine, and checks the hits.
#[test]
fn rates() {
    let mesh = displaced_sphere(316, 158);
    assert_eq!(mesh.len(), 99_856);
    let small = prims(&mesh);
    let start = Instant::now();
    let tree = build(&small);
    println!(
        "build {} triangles: {:.3} s, {:?}, {} refs",
        small.len(),
        start.elapsed().as_secs_f64(),
        tree.stats,
        tree.refs.len()
    );
    let mut rng = Rng(5);
    let rays: Vec<Ray> = (0..1 << 19)
        .map(|_| {
            let origin = rng.direction() * 2.0;
            let d = rng.point() * 0.7 - origin;
            Ray { origin, t_min: 0.0, direction: d / d.length(), t_max: 1e30 }
        })
        .collect();
    let triangles: Vec<_> = mesh.iter().map(|t| triangle(*t)).collect();
    let start = Instant::now();
    let hits = rays
        .iter()
        .filter(|ray| {
            let shear = RayShear::new(ray);
            let mut hit = Hit::none(ray);
            caustica::low_level::shapes::kdtree::traverse_closest(
                &tree.view(),
                ray,
                &mut hit,
                |leaf: &[u32], ray: &Ray, hit: &mut Hit| {
                    caustica::low_level::shapes::triangles::intersect_triangles(
                        &triangles, leaf, &shear, ray, hit,
                    )
                },
            );
            hit.reference != NONE
        })
        .count();
    let seconds = start.elapsed().as_secs_f64();
    println!("closest hits: {:.3} M rays/s, one thread", rays.len() as f64 / seconds * 1e-6);
    // Every such ray enters the ball of radius 0.7 sqrt 3 and most of the cube lies inside the
    // surface.
    assert!(hits > rays.len() * 9 / 10);

    let large = prims(&displaced_sphere(1000, 500));
    let start = Instant::now();
    let tree = build(&large);
    println!(
        "build {} triangles: {:.3} s, {:?}, {} refs",
        large.len(),
        start.elapsed().as_secs_f64(),
        tree.stats,
        tree.refs.len()
    );
}
