//! Distant geometry: the same hits, at the same cost.

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

/// Bounds of the unit-size mesh in every scene.
const MIDDLE: Aabb = Aabb { min: Vec3::splat(-1.4), max: Vec3::splat(1.4) };

/// Theory: as in `same_hits_as_exhaustive_search`, for rays around the unit-size mesh and around
/// the whole scene, also backward from their origins like light from infinity.
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
            // exclude the corners that rays start at, where t is 0 of either sign
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

/// Mean number of leaves that a ray enters, and of primitives that it tests there.
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

/// Theory: the cost of a ray that misses a distant vertex, ground or ball does not depend on its
/// distance. Bound: one and a half times the leaves and tests of the mesh alone, plus some leaves
/// of few large triangles. (Hits on a ground of size 1e6 may be off by more than the height of the
/// mesh, so the ground lies in each of its leaves. A thousand leaves would be visited if the slabs
/// were sized for the farthest corner.) Rays parallel to an axis stay within a slab for their whole
/// length, so they show an error first.
#[test]
fn far_geometry_costs_no_leaves() {
    let fine = displaced_torus(180, 90);
    let mut rng = Rng(43);
    // the last scenes: one has many large triangles, one has a ground in nearly all leaves
    for (name, mesh) in far_scenes().into_iter().rev().skip(2) {
        // with the unit-size mesh finer than the sweep's limit instead of coarser
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
