//! The order of the triangles in memory: as the leaves of the kd-tree name them, so that those of a
//! leaf lie together.

use super::shape::Emitter;
use super::tables::*;

/// Puts the triangles in the order in which the leaves name them first, and renames them
/// everywhere. Where each went.
pub fn triangles_as_met(out: &mut Scene, emitters: &mut [Emitter]) -> Vec<u32> {
    let is_triangle = |reference: u32| kind_of(reference) == KIND_TRIANGLE;
    let mut places = vec![NONE; out.triangles.len()];
    let mut ordered = Vec::with_capacity(out.triangles.len());
    for reference in out.refs.iter_mut().filter(|r| is_triangle(**r)) {
        let place = &mut places[*reference as usize];
        if *place == NONE {
            *place = ordered.len() as u32;
            ordered.push(out.triangles[*reference as usize]);
        }
        *reference = *place;
    }
    for (place, triangle) in
        places.iter_mut().zip(&out.triangles).filter(|(place, _)| **place == NONE)
    {
        *place = ordered.len() as u32;
        ordered.push(*triangle);
    }
    for emitter in emitters.iter_mut().filter(|e| is_triangle(e.reference)) {
        emitter.reference = places[emitter.reference as usize];
    }
    out.triangles = ordered;
    places
}
