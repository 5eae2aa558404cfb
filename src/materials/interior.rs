//! The bodies of glass that a place lies in. Twin: `shaders/materials/interior.wgsl`.
//!
//! Where bodies overlap, one of them is the medium: that of the highest priority and, of equal ones, the
//! smaller (Schmidt & Budge 2002, "Simple nested dielectrics in ray traced images"). Glass materials stand
//! in that order in the table of materials, one for each body, so that the least index is the medium.
//! A list is a set: a face that is met once more than it should be, by rounding or because a mesh overlaps
//! itself, changes nothing. Where no bodies of glass meet, a list holds one.

use super::real::{Real, Vec3};
use super::shapes::surface::Surface;
use super::tables::*;

/// Bodies that one place may lie in; of more, those that are never the medium are forgotten first.
pub const BODIES: usize = 8;

/// Glass materials by index, ascending, [`NONE`] behind them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interior {
    /// The first is the medium.
    pub bodies: [u32; BODIES],
}

/// Of a place in one body, or with [`NONE`] in none.
#[inline(always)]
pub const fn interior_of(body: u32) -> Interior {
    let mut bodies = [NONE; BODIES];
    bodies[0] = body;
    Interior { bodies }
}

/// The medium: a glass material or [`NONE`].
#[inline(always)]
pub fn medium_of(interior: &Interior) -> u32 {
    interior.bodies[0]
}

/// Whether `body` is among them.
pub fn holds(interior: &Interior, body: u32) -> bool {
    let mut found = false;
    for k in 0..BODIES {
        found |= interior.bodies[k] == body;
    }
    found
}

/// The same and `body`.
#[inline(always)]
pub fn entered(scene: &Scene, interior: &Interior, body: u32) -> Interior {
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

/// The same without `body`.
#[inline(always)]
pub fn left(scene: &Scene, interior: &Interior, body: u32) -> Interior {
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
pub fn ior_of(scene: &Scene, medium: u32) -> Real {
    if medium == NONE { 1.0 } else { scene.materials[medium as usize].ior }
}

/// Where the ray with direction `-wo` was before it met `s`: glass met from inside says itself that the
/// ray was there.
#[inline(always)]
pub fn interior_before(scene: &Scene, s: &Surface, wo: Vec3, interior: &Interior) -> Interior {
    let inside = scene.materials[s.material as usize].kind == MATERIAL_GLASS && wo.dot(s.normal) < 0.0;
    if inside { entered(scene, interior, s.material) } else { *interior }
}

/// Where the ray is beyond a face of glass.
#[inline(always)]
pub fn interior_beyond(scene: &Scene, s: &Surface, wo: Vec3, before: &Interior) -> Interior {
    if wo.dot(s.normal) >= 0.0 { entered(scene, before, s.material) } else { left(scene, before, s.material) }
}

/// Index of refraction before a face of glass over that beyond.
#[inline(always)]
pub fn relative_ior(scene: &Scene, s: &Surface, wo: Vec3, before: &Interior, beyond: &Interior) -> Real {
    let mut here = medium_of(before);
    if scene.world.nested == 0 && wo.dot(s.normal) >= 0.0 {
        here = NONE;
    }
    ior_of(scene, here) / ior_of(scene, medium_of(beyond))
}

/// Whether, in a scene of nested bodies, a face bends and reflects nothing, because another body is the medium on both sides or the
/// media have the same index.
#[inline(always)]
pub fn is_hidden(scene: &Scene, s: &Surface, before: &Interior, beyond: &Interior) -> bool {
    let glass = scene.materials[s.material as usize].kind == MATERIAL_GLASS;
    glass && ior_of(scene, medium_of(before)) == ior_of(scene, medium_of(beyond))
}

/// Where light from infinity that travels along `direction` is before it meets anything: behind the planes
/// of glass that it comes from behind of.
pub fn interior_from(scene: &Scene, direction: Vec3) -> Interior {
    let mut interior = interior_of(NONE);
    for i in 0..scene.world.unbounded_count {
        let reference = scene.unbounded[i as usize];
        if reference >> REFERENCE_BITS == KIND_PLANE {
            let plane = &scene.planes[(reference & ((1 << REFERENCE_BITS) - 1)) as usize];
            let glass = scene.materials[plane.material as usize].kind == MATERIAL_GLASS;
            if glass && direction.dot(plane.normal) > 0.0 {
                interior = entered(scene, &interior, plane.material);
            }
        }
    }
    interior
}
