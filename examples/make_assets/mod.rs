//! The meshes and textures of the shipped scenes, made by code and the same on every machine.

pub mod canvas;
pub mod car;
pub mod car_paint;
pub mod car_shape;
pub mod crafts;
pub mod house;
pub mod house_paint;
pub mod lettering;
pub mod mesh;
pub mod numbers;
pub mod parts;
pub mod sky;

use canvas::Canvas;
use image::codecs::hdr::HdrEncoder;
use mesh::Mesh;

/// What a file of assets/ holds.
pub enum Content {
    /// Text, as it stands in the file.
    Text(String),
    /// A picture, to be saved as PNG.
    Picture(Canvas),
    /// Linear radiance, this many pixels wide, to be saved as Radiance HDR.
    Radiance(u32, Vec<[f32; 3]>),
}

impl Content {
    /// The bytes of the file.
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

/// A file of assets/ and what it was made from.
pub struct Asset {
    /// The file's name.
    pub name: &'static str,
    /// What the file holds.
    pub content: Content,
}

/// A mesh and the OBJ file that it becomes.
pub struct NamedMesh {
    /// The file's name.
    pub name: &'static str,
    /// The material library that the file names, if any.
    pub library: Option<&'static str>,
    /// What it shows: the file's first line.
    pub comment: &'static str,
    /// The triangles.
    pub mesh: Mesh,
}

/// Every mesh.
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
    ]
}

/// Every picture and material library.
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
        Asset { name: "sky.hdr", content: Content::Radiance(sky::WIDTH, sky::sky()) },
        Asset { name: "house.mtl", content: Content::Text(house::materials()) },
    ]
}

/// Every asset.
pub fn all() -> Vec<Asset> {
    let mut assets = pictures();
    assets.extend(meshes().into_iter().map(|m| Asset {
        name: m.name,
        content: Content::Text(m.mesh.to_obj(m.comment, m.library)),
    }));
    assets
}
