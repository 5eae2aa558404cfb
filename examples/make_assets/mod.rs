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

use canvas::Canvas;
use mesh::Mesh;

/// What a file of assets/ holds.
pub enum Content {
    /// Text, as it stands in the file.
    Text(String),
    /// A picture, to be saved as PNG.
    Picture(Canvas),
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
