//! Which shape of the scene each entry of the tables comes from.

use super::tables::*;

/// Number of reference kinds.
const KINDS: usize = KIND_PLANE as usize + 1;

/// For each kind of reference, the shape's number in the scene by the reference's index.
#[derive(Clone, Debug, Default)]
pub struct Objects([Vec<u32>; KINDS]);

impl Objects {
    /// Tells that what was put into the tables since the last call, and the first `patches` patches, is of shape `shape`.
    pub fn mark(&mut self, scene: &Scene, patches: usize, shape: u32) {
        let lengths = [
            (KIND_TRIANGLE, scene.triangles.len()),
            (KIND_SPHERE, scene.spheres.len()),
            (KIND_RECTANGLE, scene.rectangles.len()),
            (KIND_DISC, scene.discs.len()),
            (KIND_CUBOID, scene.cuboids.len()),
            (KIND_REVOLUTION, patches),
            (KIND_PLANE, scene.planes.len()),
        ];
        for (kind, length) in lengths {
            self.0[kind as usize].resize(length, shape);
        }
    }

    /// Follows triangles to their new places.
    pub fn move_triangles(&mut self, places: &[u32]) {
        let old = std::mem::take(&mut self.0[KIND_TRIANGLE as usize]);
        let new = &mut self.0[KIND_TRIANGLE as usize];
        new.resize(old.len(), NONE);
        for (shape, place) in old.into_iter().zip(places) {
            new[*place as usize] = shape;
        }
    }

    /// The shape that a hit's reference belongs to; none for [`NONE`].
    pub fn of(&self, reference: u32) -> Option<u32> {
        let index = (reference & ((1 << REFERENCE_BITS) - 1)) as usize;
        self.0.get((reference >> REFERENCE_BITS) as usize)?.get(index).copied()
    }
}
