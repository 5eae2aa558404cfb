//! Maps table entries to the scene's shapes and materials.

use super::tables::*;

/// Number of reference kinds.
const KINDS: usize = KIND_INSTANCE as usize + 1;

/// Scene indices of table entries.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    /// Shape index by kind and index of a reference.
    shapes: [Vec<u32>; KINDS],
    /// Scene material index of each table material; empty if they are equal.
    pub materials: Vec<u32>,
}

impl Objects {
    /// Assigns the table entries added since the last call, including patches up to `patches`, to
    /// shape `shape`.
    pub fn mark(&mut self, scene: &SceneTables, patches: usize, shape: u32) {
        let lengths = [
            (KIND_TRIANGLE, scene.triangles.len()),
            (KIND_SPHERE, scene.spheres.len()),
            (KIND_RECTANGLE, scene.rectangles.len()),
            (KIND_DISC, scene.discs.len()),
            (KIND_CUBOID, scene.cuboids.len()),
            (KIND_REVOLUTION, patches),
            (KIND_PLANE, scene.planes.len()),
            (KIND_INSTANCE, scene.instances.len()),
        ];
        for (kind, length) in lengths {
            self.shapes[kind as usize].resize(length, shape);
        }
    }

    /// Moves triangles to their new indices, `places`.
    pub fn move_triangles(&mut self, places: &[u32]) {
        let old = std::mem::take(&mut self.shapes[KIND_TRIANGLE as usize]);
        let new = &mut self.shapes[KIND_TRIANGLE as usize];
        new.resize(old.len(), NONE);
        for (shape, place) in old.into_iter().zip(places) {
            new[*place as usize] = shape;
        }
    }

    /// Shape of a hit's reference; `None` for [`NONE`].
    pub fn of(&self, reference: u32) -> Option<u32> {
        let index = index_of(reference) as usize;
        self.shapes.get(kind_of(reference) as usize)?.get(index).copied()
    }

    /// Scene material index of a table material; [`NONE`] for [`NONE`].
    pub fn material(&self, index: u32) -> u32 {
        self.materials.get(index as usize).copied().unwrap_or(index)
    }
}
