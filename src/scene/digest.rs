//! A number that tells one scene from another.

use std::fmt::{self, Write};

use super::{Scene, ShapeKind, Texels};

impl Scene {
    /// A number of all that decides the picture but the film: of what the file says and of what it refers to, whatever
    /// names and order of keys it uses. Scenes that differ have the same one by a chance of 2^-64.
    pub fn digest(&self) -> u64 {
        let Self { name: _, camera, film: _, images, textures, materials, shapes, lights, environment } =
            self;
        let mut hash = Fnv::default();
        hash.text(&(camera, lights, environment));
        for texture in textures {
            hash.text(&texture.kind);
        }
        for material in materials {
            hash.text(&material.kind);
        }
        for image in images {
            hash.text(&(image.width, image.height));
            match &image.texels {
                Texels::Rgba8 { srgb, data } => {
                    hash.text(srgb);
                    hash.bytes(data.as_flattened());
                }
                Texels::Float(data) => data.as_flattened().iter().for_each(|x| hash.bytes(&x.to_le_bytes())),
            }
        }
        for shape in shapes {
            hash.text(&(shape.material, shape.emission, shape.planar_uv));
            match &shape.kind {
                ShapeKind::Mesh(mesh) => {
                    for v in mesh.positions.iter().chain(&mesh.normals) {
                        v.to_array().iter().for_each(|x| hash.bytes(&x.to_le_bytes()));
                    }
                    for v in &mesh.uvs {
                        v.to_array().iter().for_each(|x| hash.bytes(&x.to_le_bytes()));
                    }
                    for t in &mesh.triangles {
                        let corners = [Some(t.position), t.normal, t.uv];
                        let all = corners.into_iter().flat_map(|c| c.unwrap_or([u32::MAX; 3]));
                        all.for_each(|i| hash.bytes(&i.to_le_bytes()));
                    }
                }
                other => hash.text(other),
            }
        }
        hash.0
    }
}

/// The 64-bit hash FNV-1a (Fowler, Noll & Vo).
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// What a value prints as: floats in as many digits as tell them apart.
    fn text(&mut self, value: &impl fmt::Debug) {
        // Writing into a number does not fail.
        let _ = write!(self, "{value:?};");
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published test vectors of FNV-1a.
    #[test]
    fn known_hashes() {
        let of = |text: &str| {
            let mut hash = Fnv::default();
            hash.bytes(text.as_bytes());
            hash.0
        };
        assert_eq!(of(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(of("foobar"), 0x8594_4171_f739_67e8);
    }
}
