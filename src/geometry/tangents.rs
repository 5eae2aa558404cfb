//! Derivatives of a surface point by its texture coordinates, for maps that bend its normal. Twin:
//! `shaders/geometry/tangents.wgsl`.

use super::math::trig::sin_cos;
use super::math::{PI, TAU, basis};
use super::real::{Real, Vec2, Vec3, roundings};
use super::shapes::cuboid::cuboid_normal;
use super::shapes::instance::placed_direction;
use super::shapes::ray::Hit;
use super::shapes::revolution_profile::ring_point;
use super::surface::Surface;
use super::tables::*;

/// Least distance from the axis of a sphere, over its radius, and least slope of a surface with
/// planar texture coordinates, at which derivatives are taken.
const LEAST: Real = 1e-3;

/// Derivatives of a surface point by u and v, scene units.
#[derive(Clone, Copy, Debug)]
pub struct Tangents {
    /// Derivative by u.
    pub u: Vec3,
    /// Derivative by v.
    pub v: Vec3,
}

/// Derivatives at a hit, whose surface is `s`. Where they do not span the tangent plane, a frame of
/// unit vectors replaces them.
#[inline(never)]
pub fn tangents_at(scene: &SceneTables, hit: Hit, s: Surface) -> Tangents {
    let instance = kind_of(hit.reference) == KIND_INSTANCE;
    let mut reference = hit.reference;
    if instance {
        reference = hit.member;
    }
    let mut t = shape_tangents(scene, reference, hit.u, hit.v, s.uv);
    let mut planar = planar_of(scene, reference);
    if instance {
        let placed = &scene.instances[index_of(hit.reference) as usize];
        t = Tangents { u: placed_direction(placed, t.u), v: placed_direction(placed, t.v) };
        planar = placed.uv == UV_PLANAR;
    }
    if planar {
        t = planar_tangents(scene, s.normal);
    }
    let area = t.u.cross(t.v).dot(s.normal).abs();
    let lengths = (t.u.dot(t.u) * t.v.dot(t.v)).sqrt();
    if area > roundings(1e-5) * lengths {
        return t;
    }
    let (u, v) = basis(s.normal);
    Tangents { u, v }
}

/// Returns true if the texture coordinates of a shape are its world coordinates (x, z).
fn planar_of(scene: &SceneTables, reference: u32) -> bool {
    let index = index_of(reference) as usize;
    let source = match kind_of(reference) {
        KIND_SPHERE => scene.spheres[index].uv,
        KIND_RECTANGLE => scene.rectangles[index].uv,
        KIND_DISC => scene.discs[index].uv,
        KIND_CUBOID => scene.cuboids[index].uv,
        KIND_REVOLUTION => scene.revolutions[scene.patches[index].revolution as usize].uv,
        KIND_PLANE => scene.planes[index].uv,
        _ => UV_NATURAL,
    };
    source == UV_PLANAR
}

fn planar_tangents(scene: &SceneTables, normal: Vec3) -> Tangents {
    let mut slope = normal.y;
    if slope.abs() < LEAST {
        slope = LEAST;
    }
    let scale = 1.0 / scene.world.unit;
    Tangents {
        u: Vec3::new(1.0, -normal.x / slope, 0.0) * scale,
        v: Vec3::new(0.0, -normal.z / slope, 1.0) * scale,
    }
}

/// Derivatives by the shape's own texture coordinates `uv`, in the space of the shape.
fn shape_tangents(scene: &SceneTables, reference: u32, u: Real, v: Real, uv: Vec2) -> Tangents {
    let index = index_of(reference) as usize;
    match kind_of(reference) {
        KIND_TRIANGLE => {
            let triangle = &scene.triangles[index];
            let (e1, e2) = (triangle.p1 - triangle.p0, triangle.p2 - triangle.p0);
            if triangle.attributes == NONE {
                return Tangents { u: Vec3::ZERO, v: Vec3::ZERO };
            }
            let a = &scene.attributes[triangle.attributes as usize];
            let (du1, du2) = (a.u1 - a.u0, a.u2 - a.u0);
            let (dv1, dv2) = (a.v1 - a.v0, a.v2 - a.v0);
            let determinant = du1 * dv2 - du2 * dv1;
            if determinant == 0.0 {
                return Tangents { u: Vec3::ZERO, v: Vec3::ZERO };
            }
            let inverse = 1.0 / determinant;
            Tangents { u: (e1 * dv2 - e2 * dv1) * inverse, v: (e2 * du1 - e1 * du2) * inverse }
        }
        KIND_SPHERE => {
            let sphere = &scene.spheres[index];
            let (sin, cos) = sin_cos((0.5 - uv.x) * TAU);
            let (height, ring) = sin_cos((uv.y - 0.5) * PI);
            let r = ring.max(LEAST) * (TAU * sphere.radius);
            Tangents {
                u: Vec3::new(sin * r, 0.0, -cos * r),
                v: Vec3::new(-cos * height, ring, -sin * height) * (PI * sphere.radius),
            }
        }
        KIND_RECTANGLE => {
            let rectangle = &scene.rectangles[index];
            Tangents { u: rectangle.u, v: rectangle.v }
        }
        KIND_DISC => {
            let disc = &scene.discs[index];
            let (t, b) = basis(disc.normal);
            Tangents { u: t * (2.0 * disc.radius), v: b * (2.0 * disc.radius) }
        }
        KIND_CUBOID => {
            let cuboid = &scene.cuboids[index];
            let d = cuboid.upper - cuboid.lower;
            let n = cuboid_normal(u);
            if n.x != 0.0 {
                return Tangents {
                    u: Vec3::new(0.0, 0.0, -n.x * d.z),
                    v: Vec3::new(0.0, d.y, 0.0),
                };
            }
            if n.y != 0.0 {
                return Tangents {
                    u: Vec3::new(d.x, 0.0, 0.0),
                    v: Vec3::new(0.0, 0.0, -n.y * d.z),
                };
            }
            Tangents { u: Vec3::new(n.z * d.x, 0.0, 0.0), v: Vec3::new(0.0, d.y, 0.0) }
        }
        KIND_REVOLUTION => {
            let patch = &scene.patches[index];
            let revolution = &scene.revolutions[patch.revolution as usize];
            let at = ring_point(&scene.profile_points, patch, u, v);
            let along = revolution.segments as Real / (patch.t1 - patch.t0);
            let d_u = at.d_theta * (-TAU * revolution.scale);
            let d_v = at.d_tau * (along * revolution.scale);
            Tangents {
                u: (revolution.x_axis * d_u.x + revolution.y_axis * d_u.y)
                    + revolution.z_axis * d_u.z,
                v: (revolution.x_axis * d_v.x + revolution.y_axis * d_v.y)
                    + revolution.z_axis * d_v.z,
            }
        }
        _ => {
            let plane = &scene.planes[index];
            let (t, b) = (plane.tangent, plane.bitangent);
            Tangents { u: t * (1.0 / t.dot(t)), v: b * (1.0 / b.dot(b)) }
        }
    }
}
