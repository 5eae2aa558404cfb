//! Which scene a render is of, and which program makes it: digests of everything that kernels read, and of the kernels.

use bytemuck::{NoUninit, cast_slice};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::Xxh3;

use crate::film::provenance::VERSION;
use crate::gpu::fragments::FRAGMENTS;
use crate::pack::Packed;

/// This program: its version, and a digest of its kernels' text, since programs on the way from one version to the next may make
/// other bits. The text is that of the shaders, which the Rust twins follow; line ends do not count.
pub fn program() -> String {
    let mut digest = Xxh3::new();
    for line in FRAGMENTS.iter().flat_map(|fragment| fragment.text.lines()) {
        digest.update(line.as_bytes());
        digest.update(b"\n");
    }
    format!("{VERSION}, kernels {:016x}", digest.digest())
}

/// Digests of the parts of a flattened scene, 128 bits each. Pictures of scenes with equal ones are equal, if settings, device
/// and program are. A part's numbers count from the scene's middle in the scene's unit, so a shape that moves may change them all.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Where the middle is, and how large the units are.
    pub extent: String,
    /// The camera, and the size of the picture.
    pub camera: String,
    /// Shapes and the kd-tree.
    pub shapes: String,
    /// Materials.
    pub materials: String,
    /// Textures and their pictures.
    pub textures: String,
    /// Lights, the choice among them and their maps.
    pub lights: String,
}

impl Identity {
    /// That of a scene.
    pub fn of(packed: &Packed) -> Self {
        let s = &packed.scene;
        let units = [packed.unit, packed.radiance_unit];
        Self {
            extent: Digest::default().with(&[s.world]).with(&units).end(),
            camera: Digest::default().with(&[s.camera]).end(),
            shapes: Digest::default()
                .with(&s.spheres)
                .with(&s.rectangles)
                .with(&s.discs)
                .with(&s.cuboids)
                .with(&s.planes)
                .with(&s.revolutions)
                .with(&s.patches)
                .with(&s.profile_points)
                .with(&s.unbounded)
                .with(&s.nodes)
                .with(&s.refs)
                .with(&s.triangles)
                .with(&s.attributes)
                .end(),
            materials: Digest::default().with(&s.materials).end(),
            textures: Digest::default().with(&s.textures).with(&s.texels).end(),
            lights: Digest::default().with(&s.lights).with(&s.distributions).end(),
        }
    }

    /// The parts that are not those of another scene.
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let parts = [
            ("extent", &self.extent, &other.extent),
            ("camera", &self.camera, &other.camera),
            ("shapes", &self.shapes, &other.shapes),
            ("materials", &self.materials, &other.materials),
            ("textures", &self.textures, &other.textures),
            ("lights", &self.lights, &other.lights),
        ];
        parts.into_iter().filter(|(_, a, b)| a != b).map(|(name, ..)| name).collect()
    }
}

/// Hashes tables one after another, each with its length.
#[derive(Default)]
struct Digest(Box<Xxh3>);

impl Digest {
    fn with<T: NoUninit>(mut self, table: &[T]) -> Self {
        self.0.update(&(table.len() as u64).to_le_bytes());
        self.0.update(cast_slice(table));
        self
    }

    fn end(self) -> String {
        format!("{:032x}", self.0.digest128())
    }
}

/// Theory: a scene has one identity, and each kind of change shows in the part that it belongs to.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::pack;
    use crate::scene::{self, MaterialKind, Reflectance, Scene};

    fn of(change: impl FnOnce(&mut Scene)) -> Identity {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.toml");
        let mut scene = scene::load(file.as_ref()).unwrap().scene;
        (scene.film.width, scene.film.height) = (32, 32);
        change(&mut scene);
        Identity::of(&pack(&scene, scene.film.width, scene.film.height).unwrap())
    }

    #[test]
    fn each_change_shows_in_its_part() {
        let same = of(|_| ());
        assert_eq!(same.differences(&of(|_| ())), Vec::<&str>::new());
        assert_eq!(same.differences(&of(|s| s.film.width = 33)), ["camera"]);
        assert_eq!(same.differences(&of(|s| s.camera.fov_degrees *= 1.0 + 1e-6)), ["camera"]);
        let redder = of(|s| {
            let first = s.materials.iter_mut().find_map(|material| match &mut material.kind {
                MaterialKind::Diffuse { reflectance: Reflectance::Color(color) } if color[0] > 0.1 => {
                    Some(color)
                }
                _ => None,
            });
            first.unwrap()[0] -= 1e-6;
        });
        assert_eq!(same.differences(&redder), ["materials"]);
        let other = of(|s| {
            s.shapes.pop();
        });
        assert!(same.differences(&other).contains(&"shapes"));
    }
}
