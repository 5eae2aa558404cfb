//! Scenes: a description that does not depend on a file format, and importers that make it.
//!
//! A [`Scene`] holds materials, textures, shapes, lights, camera and film in f64 and in the units
//! of the file, with every name resolved to an index and every number checked. It does not depend
//! on a device. A program can build one without a file.
//!
//! [`load`] chooses an importer by the file's name and content. The importer adds each part of the
//! file to a `SceneBuilder` together with its position in the source; the builder applies the
//! checks that every format needs, reads images and meshes, and makes the [`Scene`], the
//! [`RenderSettings`](settings::RenderSettings) and the [`Spans`] of the parts, or all errors.
//!
//! Conventions: right-handed, y up; linear Rec. 709 RGB; one scene unit is one metre; angles in
//! degrees.

mod aov;
mod appearance;
mod builder;
mod camera;
mod checks;
mod diagnostics;
mod encoding;
mod extent;
mod film;
mod geometry;
mod images;
pub mod importers;
mod light;
mod limits;
mod load;
mod meshes;
pub mod named;
pub mod numbers;
mod parts;
mod placement;
pub mod settings;
mod spans;

pub use aov::{Aov, Aovs};
pub use appearance::{
    BumpMap, Filter, ImageData, Material, MaterialKind, NormalMap, Opacity, Principled,
    Reflectance, Rgb, Texels, Texture, TextureKind, Wrap,
};
pub use camera::{Axis, Camera, Projection};
pub use diagnostics::{Finding, SceneErrors};
pub use extent::extent;
pub use film::{Film, PixelFilter, ToneMap};
pub use geometry::{Group, Mesh, Shape, ShapeKind, Transform, Triangle};
pub use images::{Channel, ColorSpace};
pub use importers::toml::{
    LoadedProfile, ProfileFile, load_profile, load_profile_within, schema_json,
};
pub use light::{Environment, Light};
pub use limits::{Allowance, Missing};
pub use load::{Loaded, load, load_within, parse, parse_within};
pub use spans::Spans;

/// A validated scene: finite numbers, unit normals, no dangling index.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// File name without extension.
    pub name: String,
    /// Viewpoint and lens.
    pub camera: Camera,
    /// Image size, tone mapping and extra channels.
    pub film: Film,
    /// Image files, each (file, color space) once.
    pub images: Vec<ImageData>,
    /// Textures; [`Reflectance::Texture`] indexes them.
    pub textures: Vec<Texture>,
    /// Materials; [`Shape::material`] indexes them.
    pub materials: Vec<Material>,
    /// Surfaces, including area lights.
    pub shapes: Vec<Shape>,
    /// Point, spot and sun lights.
    pub lights: Vec<Light>,
    /// Light from infinitely far away.
    pub environment: Option<Environment>,
}

impl Scene {
    /// An empty scene with a film of 512 x 512 pixels.
    pub fn new(camera: Camera) -> Self {
        Self {
            name: String::new(),
            camera,
            film: Film::default(),
            images: Vec::new(),
            textures: Vec::new(),
            materials: Vec::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            environment: None,
        }
    }

    /// Returns whether the scene contains any light source.
    pub fn is_lit(&self) -> bool {
        !self.lights.is_empty()
            || self.environment.is_some()
            || self.shapes.iter().any(Shape::is_emitter)
    }
}
