//! A packed scene that is kept while the camera moves.

use std::sync::Arc;

use crate::engine::EngineError;
use crate::pack::PackedScene;
use crate::pilots::{prepare, relearn};
use crate::scene::{Camera, Film, Scene};

/// A scene and its tables. The kd-tree does not depend on the camera, but the results of the pilot
/// paths do. They are kept while the camera moves, and learned again when it stops.
pub struct Prepared {
    scene: Arc<Scene>,
    packed: Arc<PackedScene>,
}

impl Prepared {
    /// Packs a scene.
    pub fn new(scene: Arc<Scene>) -> Result<Self, EngineError> {
        let packed = prepare(&scene, scene.film.width, scene.film.height)?;
        Ok(Self { packed: Arc::new(packed), scene })
    }

    /// Sets camera and film, and keeps everything else.
    pub fn stand(&mut self, camera: &Camera, film: &Film) {
        let scene = Arc::make_mut(&mut self.scene);
        (scene.camera, scene.film) = (*camera, *film);
        let packed = Arc::make_mut(&mut self.packed);
        packed.move_camera(scene, film.width, film.height);
    }

    /// A copy that can change independently; it shares data until then.
    pub fn copy(&self) -> Self {
        let Self { scene, packed } = self;
        Self { scene: scene.clone(), packed: packed.clone() }
    }

    /// The scene, with the current camera and film.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Tables of the scene.
    pub fn packed(&self) -> &Arc<PackedScene> {
        &self.packed
    }

    /// The tables of a freshly packed scene with this camera and film, bit for bit.
    pub fn settled(&self, camera: &Camera, film: &Film) -> Result<Self, EngineError> {
        let mut scene = self.scene.clone();
        let own = Arc::make_mut(&mut scene);
        (own.camera, own.film) = (*camera, *film);
        let mut prepared = Self { scene, ..self.copy() };
        prepared.stand(camera, film);
        if relearn(Arc::make_mut(&mut prepared.packed), &prepared.scene) {
            return Ok(prepared);
        }
        Self::new(prepared.scene)
    }
}

/// Theory: packing again only when necessary gives the same tables as always packing again, for
/// every camera.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::SceneLayout;
    use crate::scene;
    use glam::DVec3;

    fn tables(prepared: &Prepared) -> Vec<u8> {
        let mut bytes = SceneLayout::new(&prepared.packed.tables).bytes;
        bytes.extend_from_slice(bytemuck::cast_slice(&prepared.packed.tables.nodes));
        bytes
    }

    #[test]
    fn settled_tables_are_those_of_a_fresh_scene() {
        let scene = scene::load("scenes/cornell.toml".as_ref()).unwrap().scene;
        let mut prepared = Prepared::new(Arc::new(scene.clone())).unwrap();
        let small = Film { width: 32, height: 16, ..scene.film };
        let here = scene.camera;
        let toward = Camera { position: here.position.lerp(here.target, 0.1), ..here };
        let off = Camera { position: here.position * 9.0 + DVec3::X, ..here };
        for camera in [here, toward, off] {
            prepared.stand(&camera, &small);
            let settled = prepared.settled(&camera, &scene.film).unwrap();
            let mut anew = scene.clone();
            anew.camera = camera;
            let fresh = Prepared::new(Arc::new(anew)).unwrap();
            assert!(tables(&settled) == tables(&fresh));
            let standing = prepared.settled(&camera, &small).unwrap();
            assert!(tables(&standing) != tables(&fresh), "a film of another size");
        }
    }
}
