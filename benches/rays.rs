//! Ray-shape intersection tests, ray traversal of the kd-tree, and its construction. Rates are rays
//! per second on one thread, or triangles per second on all threads for the build.

mod workload;

use caustica::low_level::accel::kdtree::{self, Primitive};
use caustica::low_level::geometry::intersect::{
    intersect_primitive, intersect_scene, intersect_scene_many, occluded,
};
use caustica::low_level::real::Real;
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::triangle::RayShear;
use caustica::low_level::tables::*;
use divan::{Bencher, black_box, counter::ItemsCount};

fn main() {
    divan::main();
}

/// Number of rays: enough to visit all of each tree, few enough for a run within a second.
const RAYS: usize = 1 << 14;

/// Shapes in the center, hit by many of the rays. The triangle is one of six. The profile is a
/// cubic curve, whose patch needs Newton's method.
const SHAPES: [(&str, u32, &str); 6] = [
    ("sphere", KIND_SPHERE, "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6"),
    (
        "rectangle",
        KIND_RECTANGLE,
        "type = \"rectangle\"\norigin = [-0.6, 0, -0.6]\nu = [0, 0, 1.2]\nv = [1.2, 0, 0]",
    ),
    ("triangle", KIND_TRIANGLE, ""),
    ("cuboid", KIND_CUBOID, "type = \"box\"\nmin = [-0.5, -0.5, -0.5]\nmax = [0.5, 0.5, 0.5]"),
    ("disc", KIND_DISC, "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 0.7"),
    (
        "revolution",
        KIND_REVOLUTION,
        "type = \"revolution\"\nprofile = [[0.3, -0.6], [0.9, -0.2], [0.1, 0.2], [0.6, 0.6]]",
    ),
];

#[divan::bench(args = SHAPES.map(|s| s.0))]
fn shape(bencher: Bencher, name: &str) {
    let Some((_, kind, text)) = SHAPES.iter().find(|s| s.0 == name) else { return };
    let packed =
        if text.is_empty() { workload::displaced_sphere(3, 2) } else { workload::packed(text) };
    let rays = workload::incoherent_rays(&packed, RAYS);
    let reference = reference(*kind, 0);
    bencher.counter(ItemsCount::new(RAYS)).bench_local(|| {
        let mut sum: Real = 0.0;
        for ray in black_box(&rays) {
            let mut hit = Hit::none(ray);
            intersect_primitive(&packed.tables, &RayShear::new(ray), reference, ray, &mut hit);
            sum += hit.u;
        }
        sum
    });
}

/// (nu, nv) of meshes with about 1e3 triangles (the tree fits the L1 cache), 1e4 (L2 cache), 1e5
/// (as in the comparison with Embree; the triangles exceed the L2 cache) and 1e6.
const MESHES: [(u32, u32); 4] = [(32, 17), (100, 51), (316, 159), (1000, 501)];

fn trace(bencher: Bencher, (nu, nv): (u32, u32), hit: impl Fn(&SceneTables, &Ray) -> bool) {
    let packed = workload::displaced_sphere(nu, nv);
    let rays = workload::incoherent_rays(&packed, RAYS);
    bencher
        .counter(ItemsCount::new(RAYS))
        .bench_local(|| black_box(&rays).iter().filter(|r| hit(&packed.tables, r)).count());
}

#[divan::bench(args = MESHES)]
fn closest_hit(bencher: Bencher, size: (u32, u32)) {
    trace(bencher, size, |scene, ray| intersect_scene(scene, ray).reference != NONE);
}

/// Several rays at a time, as the CPU engine traces photons in large scenes.
#[divan::bench(args = MESHES)]
fn closest_hit_side_by_side(bencher: Bencher, (nu, nv): (u32, u32)) {
    let packed = workload::displaced_sphere(nu, nv);
    let rays = workload::incoherent_rays(&packed, RAYS);
    bencher.counter(ItemsCount::new(RAYS)).bench_local(|| {
        let mut waiting = black_box(&rays).iter();
        let mut hits = 0;
        intersect_scene_many(&packed.tables, |_, last| {
            hits += usize::from(last.is_some_and(|hit| hit.reference != NONE));
            waiting.next().copied()
        });
        hits
    });
}

#[divan::bench(args = MESHES)]
fn any_hit(bencher: Bencher, size: (u32, u32)) {
    trace(bencher, size, occluded);
}

/// Without the smallest mesh, whose tree is built too fast to be timed.
#[divan::bench(args = [MESHES[1], MESHES[2], MESHES[3]], sample_count = 10)]
fn build(bencher: Bencher, (nu, nv): (u32, u32)) {
    let packed = workload::displaced_sphere(nu, nv);
    let triangles: Vec<Primitive> =
        packed.tables.triangles.iter().map(|t| Primitive::Triangle([t.p0, t.p1, t.p2])).collect();
    bencher
        .counter(ItemsCount::new(triangles.len()))
        .bench_local(|| kdtree::build(black_box(&triangles)));
}
