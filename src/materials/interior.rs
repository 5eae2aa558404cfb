//! Interior list: the glass bodies that contain a point. Twin: `shaders/materials/interior.wgsl`.
//!
//! If bodies overlap, the medium is the body with the highest priority, or the smaller one if
//! priorities are equal (Schmidt & Budge 2002, "Simple nested dielectrics in ray traced images").
//! Each body has a separate entry in the material table, sorted by rank, so the medium is the
//! smallest index in the list. The list is a set: hitting a face twice does not change it. In
//! scenes without overlapping bodies it holds one entry.

use super::Bsdf;
use super::geometry::surface::Surface;
use super::math::{FAR, offset_origin};
use super::real::{Real, Vec3};
use super::shapes::ray::Ray;
use super::tables::*;

/// Greatest length of an interior list; the lowest-ranked bodies are dropped beyond it.
pub const BODIES: usize = 8;

/// Glass material indices in ascending order, padded with [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interior {
    /// Material indices; the first one is the medium.
    pub bodies: [u32; BODIES],
}

/// List of one body, or an empty list for [`NONE`].
#[inline(always)]
pub const fn interior_of(body: u32) -> Interior {
    let mut bodies = [NONE; BODIES];
    bodies[0] = body;
    Interior { bodies }
}

/// Medium: a glass material index or [`NONE`].
#[inline(always)]
pub fn medium_of(interior: &Interior) -> u32 {
    interior.bodies[0]
}

/// Returns true if the list contains `body`.
pub fn holds(interior: &Interior, body: u32) -> bool {
    let mut found = false;
    for k in 0..BODIES {
        found |= interior.bodies[k] == body;
    }
    found
}

/// Inserts `body`.
#[inline(always)]
pub fn entered(scene: &SceneTables, interior: &Interior, body: u32) -> Interior {
    if scene.world.nested == 0 {
        return interior_of(body);
    }
    let mut next = *interior;
    let mut carry = body;
    for k in 0..BODIES {
        let here = next.bodies[k];
        next.bodies[k] = here.min(carry);
        carry = if here == carry { NONE } else { here.max(carry) };
    }
    next
}

/// Removes `body`.
#[inline(always)]
pub fn left(scene: &SceneTables, interior: &Interior, body: u32) -> Interior {
    if scene.world.nested == 0 {
        return interior_of(NONE);
    }
    let mut next = *interior;
    let mut gap = false;
    for k in 0..BODIES {
        gap |= next.bodies[k] == body;
        if gap {
            next.bodies[k] = if k + 1 < BODIES { next.bodies[k + 1] } else { NONE };
        }
    }
    next
}

/// Index of refraction of a medium.
pub fn ior_of(scene: &SceneTables, medium: u32) -> Real {
    if medium == NONE { 1.0 } else { scene.materials[medium as usize].ior }
}

/// Interior list of the ray with direction `-wo` before it hits `s`. A ray that hits glass from the
/// inside was inside that glass, even if the list did not contain it.
#[inline(always)]
pub fn interior_before(
    scene: &SceneTables,
    s: &Surface,
    wo: Vec3,
    interior: &Interior,
) -> Interior {
    let inside =
        Bsdf::of(scene.materials[s.material as usize].kind).is_body() && wo.dot(s.normal) < 0.0;
    if inside { entered(scene, interior, s.material) } else { *interior }
}

/// Interior list of the ray after it has passed the glass face `s`.
#[inline(always)]
pub fn interior_beyond(scene: &SceneTables, s: &Surface, wo: Vec3, before: &Interior) -> Interior {
    if wo.dot(s.normal) >= 0.0 {
        entered(scene, before, s.material)
    } else {
        left(scene, before, s.material)
    }
}

/// Index of refraction in front of a glass face divided by that behind it.
#[inline(always)]
pub fn relative_ior(
    scene: &SceneTables,
    s: &Surface,
    wo: Vec3,
    before: &Interior,
    beyond: &Interior,
) -> Real {
    let mut here = medium_of(before);
    if scene.world.nested == 0 && wo.dot(s.normal) >= 0.0 {
        here = NONE;
    }
    ior_of(scene, here) / ior_of(scene, medium_of(beyond))
}

/// Moves the ray and the interior list past a hidden face, one with the same index of refraction on
/// both sides, which neither refracts nor reflects. Returns false for any other face.
#[inline(always)]
pub fn passes_hidden(
    scene: &SceneTables,
    s: &Surface,
    ray: &mut Ray,
    interior: &mut Interior,
) -> bool {
    if scene.world.nested == 0 || !Bsdf::of(scene.materials[s.material as usize].kind).is_body() {
        return false;
    }
    let beyond = interior_beyond(scene, s, -ray.direction, interior);
    if ior_of(scene, medium_of(interior)) != ior_of(scene, medium_of(&beyond)) {
        return false;
    }
    let origin = offset_origin(s.position, s.error, s.normal, ray.direction);
    *ray = Ray { origin, t_min: 0.0, direction: ray.direction, t_max: FAR };
    *interior = beyond;
    true
}

/// Initial interior list of a photon from an infinitely distant light: the glass planes that it
/// approaches from inside.
pub fn interior_from(scene: &SceneTables, direction: Vec3) -> Interior {
    let mut interior = interior_of(NONE);
    for i in 0..scene.world.unbounded_count {
        let reference = scene.unbounded[i as usize];
        if kind_of(reference) == KIND_PLANE {
            let plane = &scene.planes[index_of(reference) as usize];
            let glass = Bsdf::of(scene.materials[plane.material as usize].kind).is_body();
            if glass && direction.dot(plane.normal) > 0.0 {
                interior = entered(scene, &interior, plane.material);
            }
        }
    }
    interior
}
