//! Order of the triangles in memory: by first use in the leaves of the kd-tree, so that those of a
//! leaf are adjacent.

use super::shape::Emitter;
use super::tables::*;

/// Reorders the triangles by their first use in the leaves, and updates all references. Returns the
/// new index of each triangle.
pub fn triangles_as_met(out: &mut SceneTables, emitters: &mut [Emitter]) -> Vec<u32> {
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
