//! Identity of a render: digests of the scene, including all files that it uses, and of the
//! kernels.

use std::collections::HashMap;
use std::fmt::{self, Write};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::Xxh3;

use crate::film::provenance::VERSION;
use crate::gpu::fragments::fragments;
use crate::scene::{Group, ImageData, Mesh, Scene, Shape, ShapeKind, Texels};

/// Identity of the program: its version, and a digest of its kernels, since development builds of
/// one version may render different bits. The digest covers the text of the shaders, which the Rust
/// kernels mirror, and ignores line endings.
pub fn program() -> String {
    let mut digest = Digest::default();
    for line in fragments().iter().flat_map(|fragment| fragment.text.lines()) {
        digest.bytes(line.as_bytes());
        digest.bytes(b"\n");
    }
    format!("{VERSION}, kernels {:016x}", digest.0.digest())
}

/// 128-bit digests of the parts of a scene, including all files that it uses. They do not depend on
/// names, the order of keys or the film, except for its pixel filter. Scenes with equal digests
/// give equal images for equal size, settings, device and program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Digest of the camera and the pixel filter.
    pub camera: String,
    /// Digest of the shapes, with their material indices and emission.
    pub shapes: String,
    /// Digest of the materials.
    pub materials: String,
    /// Digest of the textures and all images.
    pub textures: String,
    /// Digest of the lights and the environment.
    pub lights: String,
}

impl Identity {
    /// Computes the digests of a scene.
    pub fn of(scene: &Scene) -> Self {
        let Scene {
            name: _,
            camera,
            film,
            images,
            textures,
            materials,
            shapes,
            lights,
            environment,
        } = scene;
        let mut all_shapes = Digest::default();
        let mut groups = HashMap::new();
        shapes.iter().for_each(|shape| all_shapes.shape(shape, &mut groups));
        let mut all_textures = Digest::default();
        textures.iter().for_each(|texture| all_textures.text(&texture.kind));
        images.iter().for_each(|image| all_textures.image(image));
        let mut all_materials = Digest::default();
        materials.iter().for_each(|material| all_materials.text(&material.kind));
        Self {
            camera: Digest::of(&(camera, film.filter)).end(),
            shapes: all_shapes.end(),
            materials: all_materials.end(),
            textures: all_textures.end(),
            lights: Digest::of(&(lights, environment)).end(),
        }
    }

    /// Single digest of all parts, as stored in files.
    pub fn digest(&self) -> String {
        Digest::of(self).end()
    }

    /// Names of the parts that differ from those of another scene.
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let parts = [
            ("camera", &self.camera, &other.camera),
            ("shapes", &self.shapes, &other.shapes),
            ("materials", &self.materials, &other.materials),
            ("textures", &self.textures, &other.textures),
            ("lights", &self.lights, &other.lights),
        ];
        parts.into_iter().filter(|(_, a, b)| a != b).map(|(name, ..)| name).collect()
    }
}

/// Incremental hash of values.
#[derive(Default)]
struct Digest(Box<Xxh3>);

impl Digest {
    fn of(value: &impl fmt::Debug) -> Self {
        let mut digest = Self::default();
        digest.text(value);
        digest
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Hashes the `Debug` output of a value, which prints floats with enough digits to be exact.
    fn text(&mut self, value: &impl fmt::Debug) {
        // writing to a hash cannot fail
        let _ = write!(self, "{value:?};");
    }

    /// Hashes a shape; a group once, and then as its number in `groups`.
    fn shape(&mut self, shape: &Shape, groups: &mut HashMap<*const Group, usize>) {
        self.text(&(shape.material, shape.emission, shape.planar_uv));
        match &shape.kind {
            ShapeKind::Mesh(mesh) => self.mesh(mesh),
            ShapeKind::Instance { group, map } => {
                let next = groups.len();
                let number = *groups.entry(Arc::as_ptr(group)).or_insert(next);
                self.text(&(map, number));
                if number == next {
                    group.shapes().iter().for_each(|shape| self.shape(shape, groups));
                }
            }
            other @ (ShapeKind::Sphere { .. }
            | ShapeKind::Rectangle { .. }
            | ShapeKind::Disc { .. }
            | ShapeKind::Plane { .. }
            | ShapeKind::Cuboid { .. }
            | ShapeKind::Revolution { .. }) => self.text(other),
        }
    }

    /// Hashes the number of rows and their 64-bit values.
    fn numbers<const N: usize>(&mut self, all: impl ExactSizeIterator<Item = [f64; N]>) {
        self.bytes(&(all.len() as u64).to_le_bytes());
        all.for_each(|row| row.iter().for_each(|x| self.bytes(&x.to_le_bytes())));
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let Mesh { positions, normals, uvs, triangles } = mesh;
        self.numbers(positions.iter().map(|v| v.to_array()));
        self.numbers(normals.iter().map(|v| v.to_array()));
        self.numbers(uvs.iter().map(|v| v.to_array()));
        self.bytes(&(triangles.len() as u64).to_le_bytes());
        for t in triangles {
            let corners = [Some(t.position), t.normal, t.uv];
            let all = corners.into_iter().flat_map(|c| c.unwrap_or([u32::MAX; 3]));
            all.for_each(|i| self.bytes(&i.to_le_bytes()));
        }
    }

    fn image(&mut self, image: &ImageData) {
        self.text(&(image.width, image.height));
        match &image.texels {
            Texels::Rgba8 { srgb, data } => {
                self.text(srgb);
                self.bytes(data.as_flattened());
            }
            Texels::Float(data) => {
                data.as_flattened().iter().for_each(|x| self.bytes(&x.to_le_bytes()))
            }
        }
    }

    fn end(self) -> String {
        format!("{:032x}", self.0.digest128())
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

/// Theory: each kind of change affects the digest of its part and no other; names, the film and
/// file locations do not affect any.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, MaterialKind, Reflectance, Scene};
    use glam::DVec3;

    fn of(change: impl FnOnce(&mut Scene)) -> Identity {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/reference/mesh.toml");
        let mut scene = scene::load(file.as_ref()).unwrap().scene;
        change(&mut scene);
        Identity::of(&scene)
    }

    fn mesh(scene: &mut Scene) -> &mut scene::Mesh {
        let mesh = scene.shapes.iter_mut().find_map(|shape| match &mut shape.kind {
            ShapeKind::Mesh(mesh) => Some(mesh),
            _ => None,
        });
        mesh.unwrap()
    }

    #[test]
    fn each_change_shows_in_its_part() {
        let same = of(|_| ());
        let shows = |change: fn(&mut Scene), parts: &[&str]| {
            let changed = of(change);
            assert_eq!(same.differences(&changed), parts);
            assert_eq!(same.digest() == changed.digest(), parts.is_empty());
        };
        shows(|_| (), &[]);
        shows(|s| (s.film.width, s.film.exposure, s.name) = (33, 1.0, "other".to_owned()), &[]);
        shows(
            |s| s.images.iter_mut().for_each(|image| image.path = "elsewhere.png".to_owned()),
            &[],
        );
        shows(|s| s.camera.focus *= 1.0 + 1e-15, &["camera"]);
        shows(|s| s.camera.projection = scene::Projection::Panorama, &["camera"]);
        shows(|s| s.film.filter = scene::PixelFilter::Tent { radius: 1.0 }, &["camera"]);
        shows(|s| s.materials.iter_mut().for_each(|m| m.name += "x"), &[]);
        shows(
            |s| {
                let MaterialKind::Diffuse { reflectance, .. } = &mut s.materials[0].kind else {
                    panic!()
                };
                *reflectance = Reflectance::Color([0.123, 0.0, 0.0]);
            },
            &["materials"],
        );
        shows(|s| s.shapes[0].emission = [1.0; 3], &["shapes"]);
        shows(|s| drop(s.shapes.pop()), &["shapes"]);
        shows(|s| mesh(s).positions[0] += DVec3::X * 1e-15, &["shapes"]);
        shows(|s| mesh(s).triangles[0].position.swap(0, 1), &["shapes"]);
        shows(
            |s| match &mut s.images[0].texels {
                Texels::Rgba8 { data, .. } => data[0][1] ^= 1,
                Texels::Float(data) => data[0][1] += 1.0,
            },
            &["textures"],
        );
        shows(
            |s| s.environment = Some(scene::Environment::Constant { radiance: [0.5; 3] }),
            &["lights"],
        );
    }
}
