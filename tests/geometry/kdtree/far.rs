//! Geometry far away from what rays meet: the same hits, and no more work.

use super::{differ, mismatches};
use crate::brute_force::*;
use caustica::low_level::accel::kdtree::{KdTree, build};
use caustica::low_level::shapes::aabb::Aabb;
use caustica::low_level::shapes::kdtree::traverse_closest;
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::shapes::triangle::RayShear;
use glam::Vec3;
use std::cell::Cell;

/// Where the mesh of size one lies in every scene.
const MIDDLE: Aabb = Aabb { min: Vec3::splat(-1.4), max: Vec3::splat(1.4) };

/// Theory: as `same_hits_as_exhaustive_search`, for rays about the mesh of size one and for rays
/// about the whole; also backward from their origins, as light from infinity comes.
#[test]
fn same_hits_as_exhaustive_search_with_far_geometry() {
    let mut rng = Rng(41);
    for (name, mesh) in far_scenes() {
        let prims = prims(&mesh);
        let tree = build(&prims);
        let mut rays = rays_about(MIDDLE, &prims, &tree.view(), 6000, &mut rng);
        rays.extend(crate::brute_force::rays(&prims, &tree.view(), 2000, &mut rng));
        for (i, ray) in rays.iter_mut().enumerate().filter(|(i, _)| i % 3 == 0) {
            ray.t_min = if i % 2 == 0 { -1e30 } else { -2.0 };
            // off the corners that rays start at, where t is 0 of either sign
            ray.origin -= ray.direction * 0.37;
        }
        let truth: Vec<Hit> = rays.iter().map(|r| exhaustive(&prims, r)).collect();
        let hits = truth.iter().filter(|h| h.reference != NONE).count();
        println!("{name}: {:?}, size {}, {hits} hits", tree.stats, tree.primitive_size);
        assert!(hits > 2000, "{name}");
        assert_eq!(mismatches(&prims, &tree, &rays, &truth), 0, "{name}");
        let alone: Vec<Hit> = rays.iter().map(|ray| closest(&prims, &tree.view(), ray)).collect();
        assert_eq!(differ(&prims, &tree, &rays, &alone), 0, "{name}");
    }
}

/// Leaves that a ray enters, and primitives that it tests there, on average.
fn work(mesh: &[[Vec3; 3]], tree: &KdTree, rays: &[Ray]) -> (f64, f64) {
    let prims = prims(mesh);
    let (leaves, tests) = (Cell::new(0usize), Cell::new(0usize));
    for ray in rays {
        let shear = RayShear::new(ray);
        traverse_closest(
            &tree.view(),
            ray,
            &mut Hit::none(ray),
            |leaf: &[u32], ray: &Ray, hit: &mut Hit| {
                leaves.set(leaves.get() + 1);
                tests.set(tests.get() + leaf.len());
                leaf.iter().for_each(|&r| intersect(&prims, &shear, r, ray, hit));
            },
        );
    }
    (leaves.get() as f64 / rays.len() as f64, tests.get() as f64 / rays.len() as f64)
}

/// Theory: what a ray that misses it costs does not depend on how far away a vertex, a ground or a
/// ball lies. Bound: one and a half times the leaves and tests of the mesh alone, and some leaves
/// of few large triangles more. (Hits with a ground of 1e6 may be off by more than the mesh is
/// high, so that it lies in each of its leaves; a thousand leaves would be visited if the slabs
/// went with the farthest corner.) Rays parallel to an axis run within a slab for all their length,
/// and are the ones to suffer first.
#[test]
fn far_geometry_costs_no_leaves() {
    let fine = displaced_torus(180, 90);
    let mut rng = Rng(43);
    // the last scenes: one is crowded with large triangles, one has a ground in nearly all of its leaves
    for (name, mesh) in far_scenes().into_iter().rev().skip(2) {
        // the mesh of size one, finer than the sweep's limit in place of below it
        for fine in [None, Some(&fine)] {
            let alone = fine.cloned().unwrap_or_else(|| displaced_torus(60, 30));
            let mesh = match fine {
                None => mesh.clone(),
                Some(fine) => {
                    let far = mesh.iter().filter(|t| t.iter().any(|p| p.abs().max_element() > 1.5));
                    fine.iter().chain(far).copied().collect()
                }
            };
            let (plain, far) = (build(&prims(&alone)), build(&prims(&mesh)));
            let rays: Vec<Ray> = (0..4000)
                .map(|i| {
                    let origin = rng.point() * 1.4;
                    let aim = rng.point() - origin;
                    let mut direction = aim / aim.length();
                    if i % 2 == 0 {
                        direction = Vec3::ZERO;
                        direction[i / 2 % 3] = if i % 4 == 0 { -1.0 } else { 1.0 };
                    }
                    Ray {
                        origin,
                        t_min: if i % 5 == 0 { -1e30 } else { 0.0 },
                        direction,
                        t_max: 1e30,
                    }
                })
                .collect();
            let (leaves, tests) = work(&alone, &plain, &rays);
            let (far_leaves, far_tests) = work(&mesh, &far, &rays);
            println!(
                "{name}: {leaves:.2} leaves, {tests:.2} tests; {far_leaves:.2}, {far_tests:.2}"
            );
            assert!(
                far_leaves < 1.5 * leaves + 9.0,
                "{name}: {far_leaves} leaves, {leaves} without"
            );
            assert!(far_tests < 1.5 * tests + 36.0, "{name}: {far_tests} tests, {tests} without");
        }
    }
}
