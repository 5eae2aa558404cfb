//! Intersection of a ray with the whole scene: shapes outside the kd-tree one by one, then the
//! kd-tree. Twin: `shaders/geometry/intersect.wgsl`.

use super::instances::intersect_instance;
use super::shapes::cuboid::intersect_cuboid;
use super::shapes::disc::{intersect_disc, intersect_plane};
use super::shapes::kdtree::{Primitives, Tree, traverse_any, traverse_closest};
use super::shapes::kdtree_stream::{Rays, fetch, traverse_closest_many};
use super::shapes::ray::{Hit, Ray};
use super::shapes::rectangle::intersect_rectangle;
use super::shapes::revolution::intersect_patch;
use super::shapes::simd4::LANES;
use super::shapes::sphere::intersect_sphere;
use super::shapes::triangle::{RayShear, intersect_triangle};
use super::shapes::triangles::intersect_triangles;
use super::tables::*;

/// Intersects a ray with the shape that `reference` identifies.
#[inline]
pub fn intersect_primitive(
    scene: &SceneTables,
    shear: &RayShear,
    reference: u32,
    ray: &Ray,
    hit: &mut Hit,
) {
    let index = index_of(reference) as usize;
    match kind_of(reference) {
        KIND_TRIANGLE => intersect_triangle(&scene.triangles[index], reference, shear, ray, hit),
        KIND_SPHERE => intersect_sphere(&scene.spheres[index], reference, ray, hit),
        KIND_RECTANGLE => intersect_rectangle(&scene.rectangles[index], reference, ray, hit),
        KIND_DISC => intersect_disc(&scene.discs[index], reference, ray, hit),
        KIND_CUBOID => intersect_cuboid(&scene.cuboids[index], reference, ray, hit),
        KIND_REVOLUTION => {
            let patch = &scene.patches[index];
            let revolution = &scene.revolutions[patch.revolution as usize];
            let points = &scene.profile_points;
            let at = intersect_patch(
                points,
                revolution,
                patch,
                ray.origin,
                ray.direction,
                ray.t_min,
                hit.t,
            );
            if at.t < hit.t {
                *hit = Hit { t: at.t, reference, u: at.theta, v: at.tau, ..*hit };
            }
        }
        _ => intersect_plane(&scene.planes[index], reference, ray, hit),
    }
}

/// Capacity of the set of deferred patches, in bits.
const PATCH_SET: usize = 128;

/// Returns true if tests of patches are deferred to the end of the tree traversal. A ring lies in
/// many leaves, and a root search is by far the most expensive test; deferral searches each patch
/// once, and only up to the nearest other hit. If the scene has more patches than the set has bits,
/// they are searched in each leaf.
pub fn has_patch_set(scene: &SceneTables) -> bool {
    !scene.patches.is_empty() && scene.patches.len() <= PATCH_SET
}

/// Shapes of a scene, tested against one ray.
struct Shapes<'a> {
    scene: &'a SceneTables,
    shear: RayShear,
    /// True if any hit ends the search.
    any: bool,
    /// Set of the patches, by index, in the leaves visited so far.
    put_off: u128,
}

impl<'a> Shapes<'a> {
    #[inline(always)]
    fn new(scene: &'a SceneTables, ray: &Ray, any: bool) -> Self {
        Shapes { scene, shear: shear_of(scene, ray), any, put_off: 0 }
    }
}

impl Primitives for Shapes<'_> {
    /// Prefetches both ends of each triangle, since some triangles straddle two cache lines.
    #[inline(always)]
    fn expect(&self, references: &[u32]) {
        for reference in references.iter().take_while(|r| kind_of(**r) == KIND_TRIANGLE) {
            let triangle = self.scene.triangles.get(index_of(*reference) as usize);
            fetch(triangle);
            fetch(triangle.map(|triangle| &triangle.attributes));
        }
    }

    /// Tests the triangles first, several at a time, then the other shapes in the order of their
    /// kinds.
    #[inline(always)]
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit) {
        let Shapes { scene, shear, any, .. } = *self;
        let shear = &shear;
        let count = references.iter().take_while(|r| kind_of(**r) == KIND_TRIANGLE).count();
        let (triangles, others) = references.split_at(count);
        if !triangles.is_empty() {
            intersect_triangles(&scene.triangles, triangles, shear, ray, hit);
        }
        let mut rest = others;
        while let Some(&first) = rest.first() {
            if any && hit.reference != NONE {
                return;
            }
            rest = match kind_of(first) {
                KIND_SPHERE | KIND_RECTANGLE => intersect_fours(scene, shear, rest, ray, hit),
                KIND_REVOLUTION if has_patch_set(scene) => {
                    self.put_off |= 1 << (first & (PATCH_SET as u32 - 1));
                    &rest[1..]
                }
                KIND_INSTANCE => {
                    *hit = intersect_instance(scene, first, *ray, any, *hit);
                    &rest[1..]
                }
                _ => {
                    intersect_primitive(scene, shear, first, ray, hit);
                    &rest[1..]
                }
            };
        }
    }

    /// Searches the deferred patches in the order of their indices.
    #[inline(always)]
    fn finish(&mut self, ray: &Ray, hit: &mut Hit) {
        while self.put_off != 0 {
            let reference = reference(KIND_REVOLUTION, self.put_off.trailing_zeros() as usize);
            self.put_off &= self.put_off - 1;
            intersect_primitive(self.scene, &self.shear, reference, ray, hit);
            if self.any && hit.reference != NONE {
                return;
            }
        }
    }
}

/// Tests the first of some references to spheres or rectangles together with the others of the same
/// group of four; returns the remaining references.
#[inline(always)]
fn intersect_fours<'a>(
    scene: &SceneTables,
    shear: &RayShear,
    references: &'a [u32],
    ray: &Ray,
    hit: &mut Hit,
) -> &'a [u32] {
    let lane = LANES as u32 - 1;
    let base = references[0] & !lane;
    let four = index_of(base) as usize / LANES;
    let mut mask = 0;
    let mut count = 0;
    while count < references.len() && references[count] & !lane == base {
        mask |= 1 << (references[count] & lane);
        count += 1;
    }
    let (these, others) = references.split_at(count);
    if kind_of(base) == KIND_RECTANGLE
        && let Some(rectangles) = scene.four_rectangles.get(four)
    {
        rectangles.intersect(base, mask, ray, hit);
    } else if kind_of(base) == KIND_SPHERE
        && let Some(spheres) = scene.four_spheres.get(four)
    {
        spheres.intersect(base, mask, ray, hit);
    } else {
        these.iter().for_each(|&reference| intersect_primitive(scene, shear, reference, ray, hit));
    }
    others
}

/// Per-ray constants of the triangle test; skips the three divisions if the scene has no triangles.
#[inline]
fn shear_of(scene: &SceneTables, ray: &Ray) -> RayShear {
    if scene.triangles.is_empty() { RayShear::NONE } else { RayShear::new(ray) }
}

/// Nearest hit of a ray; its reference is [`NONE`] if there is none.
#[inline(always)]
pub fn intersect_scene(scene: &SceneTables, ray: &Ray) -> Hit {
    let mut hit = intersect_unbounded(scene, ray);
    if !scene.nodes.is_empty() {
        traverse_closest(&tree(scene), ray, &mut hit, Shapes::new(scene, ray, false));
    }
    hit
}

/// [`intersect_scene`] for many rays. Calls `next` with one of
/// [`STREAM`](super::shapes::kdtree_stream::STREAM) lanes and the hit of the lane's previous ray,
/// and traces the ray that it returns, until it returns none for every lane. The order of the lanes
/// is unspecified.
#[inline(always)]
pub fn intersect_scene_many(
    scene: &SceneTables,
    mut next: impl FnMut(usize, Option<&Hit>) -> Option<Ray>,
) {
    if scene.nodes.is_empty() {
        let mut last = None;
        while let Some(ray) = next(0, last.as_ref()) {
            last = Some(intersect_scene(scene, &ray));
        }
        return;
    }
    let shapes = |ray: &Ray| Shapes::new(scene, ray, false);
    traverse_closest_many(&tree(scene), &mut Source { scene, next }, shapes);
}

/// Adapts a closure to [`Rays`]: intersects each ray with the shapes outside the tree.
struct Source<'a, N> {
    scene: &'a SceneTables,
    next: N,
}

impl<N: FnMut(usize, Option<&Hit>) -> Option<Ray>> Rays for Source<'_, N> {
    #[inline(always)]
    fn next(&mut self, lane: usize, last: Option<&Hit>) -> Option<(Ray, Hit)> {
        let ray = (self.next)(lane, last)?;
        Some((ray, intersect_unbounded(self.scene, &ray)))
    }
}

/// Nearest hit with a shape outside the tree.
#[inline(always)]
fn intersect_unbounded(scene: &SceneTables, ray: &Ray) -> Hit {
    let mut hit = Hit::none(ray);
    for i in 0..scene.world.unbounded_count {
        intersect_primitive(scene, &RayShear::NONE, scene.unbounded[i as usize], ray, &mut hit);
    }
    hit
}

/// Returns true if anything lies on the ray between `t_min` and `t_max`.
#[inline(always)]
pub fn occluded(scene: &SceneTables, ray: &Ray) -> bool {
    let mut hit = Hit::none(ray);
    for i in 0..scene.world.unbounded_count {
        intersect_primitive(scene, &RayShear::NONE, scene.unbounded[i as usize], ray, &mut hit);
        if hit.reference != NONE {
            return true;
        }
    }
    !scene.nodes.is_empty()
        && traverse_any(&tree(scene), ray, &mut hit, Shapes::new(scene, ray, true))
}

#[inline(always)]
fn tree(scene: &SceneTables) -> Tree<'_> {
    Tree {
        nodes: &scene.nodes,
        refs: &scene.refs,
        bounds_min: scene.world.bounds_min,
        bounds_max: scene.world.bounds_max,
        primitive_size: scene.world.primitive_size,
    }
}
