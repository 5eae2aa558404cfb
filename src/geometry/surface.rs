//! Surface data at a hit: position, normals, texture coordinates, material. Twin:
//! `shaders/geometry/surface.wgsl`.

use super::instances::instance_surface;
use super::math::unit;
use super::real::{Real, Vec2, Vec3};
use super::shapes::cuboid::{cuboid_axis, cuboid_error, cuboid_normal, cuboid_project, cuboid_uv};
use super::shapes::disc::{disc_error, disc_uv, plane_error, plane_project};
use super::shapes::ray::{Hit, Ray};
use super::shapes::rectangle::{rectangle_error, rectangle_point};
use super::shapes::revolution::revolution_surface;
use super::shapes::sphere::{sphere_error, sphere_normal, sphere_project, sphere_uv};
use super::shapes::triangle::{triangle_error, triangle_normal, triangle_point};
use super::tables::*;

/// Surface data at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Point on the surface, in scene space.
    pub position: Vec3,
    /// Bound on the distance of `position` from the true surface, scene units.
    pub error: Real,
    /// Geometric unit normal on the shape's outer side.
    pub normal: Vec3,
    /// Material index.
    pub material: u32,
    /// Shading normal, on the same side as `normal`; interpolated on smooth meshes.
    pub shading: Vec3,
    /// Light index or [`NONE`].
    pub light: u32,
    /// Texture coordinates; on spheres only set if the material has a texture.
    pub uv: Vec2,
    /// Second coordinate of the shape's own (u, v): the profile parameter on surfaces of
    /// revolution, 0 elsewhere.
    pub v: Real,
    /// Index of the outline that contains the point, or [`NONE`].
    pub outline: u32,
}

/// Computes the surface data at `hit` of `ray`.
#[inline(always)]
pub fn surface_at(scene: &SceneTables, ray: &Ray, hit: &Hit) -> Surface {
    let index = index_of(hit.reference) as usize;
    let p = ray.origin + ray.direction * hit.t;
    let mut planar = UV_NATURAL;
    let mut s: Surface;
    match kind_of(hit.reference) {
        KIND_TRIANGLE => {
            let triangle = &scene.triangles[index];
            let n = triangle_normal(triangle);
            s = Surface {
                position: triangle_point(triangle, hit.u, hit.v),
                error: triangle_error(triangle),
                normal: n,
                material: triangle.material,
                shading: n,
                light: triangle.light,
                uv: Vec2::ZERO,
                v: 0.0,
                outline: NONE,
            };
            if triangle.attributes != NONE {
                let a = &scene.attributes[triangle.attributes as usize];
                let w = 1.0 - hit.u - hit.v;
                s.uv = Vec2::new(
                    a.u0 * w + a.u1 * hit.u + a.u2 * hit.v,
                    a.v0 * w + a.v1 * hit.u + a.v2 * hit.v,
                );
                s.outline = (a.outline_smooth >> 1).wrapping_sub(1);
                if a.outline_smooth & 1 == 1 {
                    let m = a.n0 * w + a.n1 * hit.u + a.n2 * hit.v;
                    if m.dot(m) > 0.0 {
                        let m = unit(m);
                        s.shading = if m.dot(n) >= 0.0 { m } else { -m };
                    }
                }
            }
        }
        KIND_SPHERE => {
            let sphere = &scene.spheres[index];
            let q = sphere_project(sphere, p);
            let n = sphere_normal(sphere, q);
            s = Surface {
                position: q,
                error: sphere_error(sphere, q),
                normal: n,
                material: sphere.material,
                shading: n,
                light: sphere.light,
                uv: Vec2::ZERO,
                v: 0.0,
                outline: NONE,
            };
            planar = sphere.uv;
            // skip the two arctangents for the many spheres without a texture
            if planar == UV_NATURAL && scene.materials[sphere.material as usize].textured != 0 {
                let uv = sphere_uv(n);
                s.uv = Vec2::new(uv.x, within_ends(scene, s.material, uv.y));
            }
        }
        KIND_RECTANGLE => {
            let rectangle = &scene.rectangles[index];
            s = Surface {
                position: rectangle_point(rectangle, hit.u, hit.v),
                error: rectangle_error(rectangle),
                normal: rectangle.normal,
                material: rectangle.material,
                shading: rectangle.normal,
                light: rectangle.light,
                uv: Vec2::new(hit.u, hit.v),
                v: 0.0,
                outline: rectangle.outline,
            };
            planar = rectangle.uv;
        }
        KIND_DISC => {
            let disc = &scene.discs[index];
            let q = plane_project(p, disc.center, disc.normal);
            s = Surface {
                position: q,
                error: disc_error(disc),
                normal: disc.normal,
                material: disc.material,
                shading: disc.normal,
                light: disc.light,
                uv: disc_uv(disc, q),
                v: 0.0,
                outline: disc.outline,
            };
            planar = disc.uv;
        }
        KIND_CUBOID => {
            let cuboid = &scene.cuboids[index];
            let q = cuboid_project(cuboid, p, hit.u);
            let n = cuboid_normal(hit.u);
            s = Surface {
                position: q,
                error: cuboid_error(cuboid),
                normal: n,
                material: cuboid.material,
                shading: n,
                light: cuboid.light,
                uv: cuboid_uv(cuboid, q, hit.u),
                v: 0.0,
                outline: cuboid.outline + cuboid_axis(hit.u),
            };
            planar = cuboid.uv;
        }
        KIND_REVOLUTION => {
            let patch = scene.patches[index];
            let revolution = scene.revolutions[patch.revolution as usize];
            let r = revolution_surface(&scene.profile_points, &revolution, &patch, hit.u, hit.v);
            s = Surface {
                position: r.position,
                error: r.error,
                normal: r.normal,
                material: revolution.material,
                shading: r.normal,
                light: revolution.light,
                uv: r.uv,
                v: r.uv.y,
                outline: NONE,
            };
            planar = revolution.uv;
            if planar == UV_NATURAL {
                s.uv.y = within_ends(scene, s.material, r.uv.y);
            }
        }
        KIND_INSTANCE => return instance_surface(scene, *ray, *hit),
        _ => {
            let plane = &scene.planes[index];
            let q = plane_project(p, plane.point, plane.normal);
            let d = q - plane.point;
            s = Surface {
                position: q,
                error: plane_error(plane, q),
                normal: plane.normal,
                material: plane.material,
                shading: plane.normal,
                light: NONE,
                uv: Vec2::new(plane.u0 + d.dot(plane.tangent), plane.v0 + d.dot(plane.bitangent)),
                v: 0.0,
                outline: plane.outline,
            };
            planar = plane.uv;
        }
    }
    if planar == UV_PLANAR {
        let origin = scene.materials[s.material as usize].planar_origin;
        s.uv = Vec2::new(s.position.x, s.position.z) * scene.world.unit + origin;
    }
    s
}

/// Clamps `v` of a shape whose v range ends at poles or rims to half a texel row from either end,
/// so that filtering does not mix in the opposite end.
fn within_ends(scene: &SceneTables, material: u32, v: Real) -> Real {
    if scene.textures.is_empty() {
        return v;
    }
    let index = scene.materials[material as usize].texture;
    if index == NONE || scene.textures[index as usize].kind != TEXTURE_IMAGE {
        return v;
    }
    let texture = &scene.textures[index as usize];
    let half = (0.5 / (texture.height as Real * texture.scale.y.abs())).min(0.5);
    v.max(half).min(1.0 - half)
}
