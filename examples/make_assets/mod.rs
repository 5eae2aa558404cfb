//! Procedural meshes and textures of the shipped scenes, bit-identical on all machines.

pub mod canvas;
pub mod car;
pub mod car_paint;
pub mod car_shape;
pub mod cloth;
pub mod crafts;
pub mod house;
pub mod house_paint;
pub mod lettering;
pub mod mesh;
pub mod numbers;
pub mod parts;
pub mod sky;
pub mod tableware;

use canvas::Canvas;
use image::codecs::hdr::HdrEncoder;
use mesh::Mesh;

/// Content of a file in assets/.
pub enum Content {
    /// Text of the file.
    Text(String),
    /// Image to be saved as PNG.
    Picture(Canvas),
    /// Width in pixels and linear radiance, to be saved as Radiance HDR.
    Radiance(u32, Vec<[f32; 3]>),
}

impl Content {
    /// Encodes the file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, image::ImageError> {
        match self {
            Content::Text(text) => Ok(text.clone().into_bytes()),
            Content::Picture(canvas) => canvas.to_png(),
            Content::Radiance(width, pixels) => {
                let mut bytes = Vec::new();
                let pixels: Vec<_> = pixels.iter().map(|&rgb| image::Rgb(rgb)).collect();
                let width = *width as usize;
                HdrEncoder::new(&mut bytes).encode(&pixels, width, pixels.len() / width)?;
                Ok(bytes)
            }
        }
    }
}

/// A file in assets/ and its content.
pub struct Asset {
    /// The file's name.
    pub name: &'static str,
    /// Content of the file.
    pub content: Content,
}

/// A mesh and its OBJ file.
pub struct NamedMesh {
    /// The file's name.
    pub name: &'static str,
    /// Material library of the file, if any.
    pub library: Option<&'static str>,
    /// Description, written as the first line of the file.
    pub comment: &'static str,
    /// The triangles.
    pub mesh: Mesh,
}

/// All meshes.
pub fn meshes() -> Vec<NamedMesh> {
    let unwrapping = car_shape::Unwrapping::new();
    vec![
        NamedMesh {
            name: "car.obj",
            library: None,
            comment: "a car, x forward, y up, metres; painted by car.png",
            mesh: car::painted(&unwrapping),
        },
        NamedMesh {
            name: "car-chrome.obj",
            library: None,
            comment: "the chrome parts of car.obj, in the same frame",
            mesh: car::chrome(),
        },
        NamedMesh {
            name: "house.obj",
            library: Some("house.mtl"),
            comment: "a brick cottage, its front towards +z, y up, metres",
            mesh: house::house(),
        },
        NamedMesh {
            name: "spoon.obj",
            library: None,
            comment: "a spoon, its handle along +x, y up, centimetres",
            mesh: tableware::spoon(),
        },
        NamedMesh {
            name: "ice.obj",
            library: None,
            comment: "an ice cube of about two centimetres",
            mesh: tableware::ice(),
        },
    ]
}

/// All images and material libraries.
pub fn pictures() -> Vec<Asset> {
    let picture = |name, canvas| Asset { name, content: Content::Picture(canvas) };
    vec![
        picture("car.png", car_paint::atlas(&car_shape::Unwrapping::new())),
        picture("planks.png", crafts::planks()),
        picture("porcelain.png", crafts::porcelain()),
        picture("brick.png", house_paint::brick()),
        picture("roof.png", house_paint::roof()),
        picture("stone.png", house_paint::stone()),
        picture("plaster.png", house_paint::plaster()),
        picture("door.png", house_paint::door()),
        picture("window.png", house_paint::window()),
        picture("shutter.png", house_paint::shutter()),
        picture("grass.png", house_paint::grass()),
        picture("cloth-normal.png", cloth::normals()),
        Asset { name: "sky.hdr", content: Content::Radiance(sky::WIDTH, sky::sky()) },
        Asset { name: "house.mtl", content: Content::Text(house::materials()) },
    ]
}

/// All assets.
pub fn all() -> Vec<Asset> {
    let mut assets = pictures();
    assets.extend(meshes().into_iter().map(|m| Asset {
        name: m.name,
        content: Content::Text(m.mesh.to_obj(m.comment, m.library)),
    }));
    assets
}
