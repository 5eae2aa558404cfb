//! Instances: intersection with the kd-tree of the group that an instance places, and the surface
//! there. Twin: `shaders/geometry/instances.wgsl`.

use super::intersect::intersect_primitive;
use super::real::{Real, Vec2};
use super::shapes::instance::{
    Group, object_ray, placed_error, placed_normal, placed_point, placed_shading,
};
use super::shapes::kdtree::{Primitives, Tree, traverse_any, traverse_closest};
use super::shapes::ray::{Hit, Ray};
use super::shapes::triangle::RayShear;
use super::shapes::triangles::intersect_triangles;
use super::surface::{Surface, surface_at};
use super::tables::*;

/// Shapes of a group, tested against one ray in the group's space.
struct Members<'a> {
    scene: &'a SceneTables,
    shear: RayShear,
    any: bool,
}

impl Primitives for Members<'_> {
    fn intersect(&mut self, references: &[u32], ray: &Ray, hit: &mut Hit) {
        let count = references.iter().take_while(|r| kind_of(**r) == KIND_TRIANGLE).count();
        let (triangles, others) = references.split_at(count);
        intersect_triangles(&self.scene.triangles, triangles, &self.shear, ray, hit);
        for reference in others {
            if self.any && hit.reference != NONE {
                return;
            }
            intersect_primitive(self.scene, &self.shear, *reference, ray, hit);
        }
    }
}

/// The hit if the ray meets a shape of the instance in `(t_min, hit.t)`, else `hit`; with `any`,
/// the first shape found ends the search. Scenes without instances are not slowed down: the
/// function is separate from its caller and takes ray and hit by value, which leaves them in
/// registers there.
#[inline(never)]
pub fn intersect_instance(
    scene: &SceneTables,
    reference: u32,
    ray: Ray,
    any: bool,
    hit: Hit,
) -> Hit {
    let instance = &scene.instances[index_of(reference) as usize];
    let object = object_ray(instance, &ray, hit.t);
    let mut found = Hit::none(&object.ray);
    let tree = tree_of(scene, &scene.groups[instance.group as usize]);
    let members = Members { scene, shear: RayShear::new(&object.ray), any };
    if any {
        traverse_any(&tree, &object.ray, &mut found, members);
    } else {
        traverse_closest(&tree, &object.ray, &mut found, members);
    }
    if found.reference == NONE {
        return hit;
    }
    let t = object.start + found.t / object.length;
    if t > ray.t_min && t < hit.t {
        return Hit { t, reference, u: found.u, v: found.v, member: found.reference };
    }
    hit
}

fn tree_of<'a>(scene: &'a SceneTables, group: &Group) -> Tree<'a> {
    Tree {
        nodes: &scene.nodes[group.root as usize..],
        refs: &scene.refs[group.first_ref as usize..],
        bounds_min: group.bounds_min,
        bounds_max: group.bounds_max,
        primitive_size: group.primitive_size,
    }
}

/// Surface data at a hit with an instance. Instances do not emit and have no outlines.
#[inline(never)]
pub fn instance_surface(scene: &SceneTables, ray: Ray, hit: Hit) -> Surface {
    let instance = &scene.instances[index_of(hit.reference) as usize];
    let object = object_ray(instance, &ray, hit.t);
    let own = Hit { t: object.ray.t_max, reference: hit.member, ..hit };
    let mut s = surface_at(scene, &object.ray, &own);
    let n = placed_normal(instance, s.normal);
    let inverse_length: Real = 1.0 / n.dot(n).sqrt();
    s.error = placed_error(instance, s.error, s.normal, inverse_length);
    s.position = placed_point(instance, s.position);
    let smooth = s.shading != s.normal;
    s.normal = n * inverse_length;
    s.shading = if smooth { placed_shading(instance, s.shading, s.normal) } else { s.normal };
    if instance.material != NONE {
        s.material = instance.material;
    }
    s.light = NONE;
    s.outline = NONE;
    if instance.uv == UV_PLANAR {
        let origin = scene.materials[s.material as usize].planar_origin;
        s.uv = Vec2::new(s.position.x, s.position.z) * scene.world.unit + origin;
    }
    s
}
