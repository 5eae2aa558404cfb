//! Point-in-body test by ray casting. Twin: `shaders/materials/enclosing.wgsl`.
//!
//! A closed body contains a point if a ray from the point, in any direction, leaves the body before
//! it enters it. An open sheet, such as a water surface, contains a point if a ray along the
//! sheet's mean normal leaves through it.

use super::Bsdf;
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::surface_at;
use super::interior::{Interior, entered, holds, interior_of, left};
use super::math::{FAR, offset_origin};
use super::real::Vec3;
use super::shapes::ray::Ray;
use super::tables::*;

/// Greatest number of surfaces that one ray passes.
const FACES: u32 = 256;
/// Unit direction of the rays for closed bodies, oblique so that it rarely hits edges of
/// axis-aligned models.
const LOOK: Vec3 = Vec3::new(0.3104505, 0.8912933, 0.3304795);

/// Interior list at `position` on a lamp or lens whose medium is `known`: a glass material index,
/// [`NONE`], or [`ASTRIDE`] if it must be determined for each point.
#[inline(always)]
pub fn interior_at(scene: &SceneTables, known: u32, position: Vec3) -> Interior {
    if known == ASTRIDE { enclosing(scene, position) } else { interior_of(known) }
}

/// Interior list at `position`.
pub fn enclosing(scene: &SceneTables, position: Vec3) -> Interior {
    // closed bodies first, then each open sheet along its mean normal
    let mut interior = looked(scene, position, LOOK, NONE, &interior_of(NONE));
    for k in 0..scene.world.body_count {
        let body = scene.world.body_first + k;
        let direction = scene.materials[body as usize].reflectance;
        if direction.dot(direction) > 0.0 {
            interior = looked(scene, position, direction, body, &interior);
        }
    }
    interior
}

/// Adds to `known` the bodies that a ray along `direction` leaves without having entered them: all
/// closed bodies if `body` is [`NONE`], otherwise only the open sheet `body`.
fn looked(
    scene: &SceneTables,
    position: Vec3,
    direction: Vec3,
    body: u32,
    known: &Interior,
) -> Interior {
    let mut found = *known;
    let mut ahead = interior_of(NONE);
    let mut origin = position;
    for _ in 0..FACES {
        let ray = Ray { origin, t_min: 0.0, direction, t_max: FAR };
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        let m = &scene.materials[s.material as usize];
        let closed = Bsdf::of(m.kind).is_body() && m.reflectance.dot(m.reflectance) == 0.0;
        if s.material == body || (body == NONE && closed) {
            if direction.dot(s.normal) < 0.0 {
                ahead = entered(scene, &ahead, s.material);
            } else if holds(&ahead, s.material) {
                ahead = left(scene, &ahead, s.material);
            } else {
                found = entered(scene, &found, s.material);
            }
            if body != NONE {
                break;
            }
        }
        origin = offset_origin(s.position, s.error, s.normal, direction);
    }
    found
}
