//! Scene files and validated scenes.
//!
//! A [`Scene`] holds the contents of a scene file in f64 and in the units of the file, with every
//! name resolved to an index and every number checked. It does not depend on a device.
//!
//! Conventions: right-handed, y up; linear Rec. 709 RGB; one scene unit is one metre; angles in
//! degrees.

mod aov;
mod appearance;
mod camera;
mod diagnostics;
mod encoding;
pub mod file;
mod geometry;
mod images;
mod libraries;
mod limits;
mod lines;
mod load;
mod material;
mod mesh;
mod mtl;
pub mod numbers;
mod obj;
mod profile;
mod profile_file;
mod schema;
pub mod settings;
mod spans;
mod surfaces;
mod text;
mod tree;
mod triangles;
mod validate;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use aov::{Aov, Aovs};
pub use appearance::{
    Filter, ImageData, Material, MaterialKind, Reflectance, Rgb, Texels, Texture, TextureKind, Wrap,
};
pub use diagnostics::{Finding, SceneErrors};
pub use geometry::{Mesh, Shape, ShapeKind, Transform, Triangle};
pub use images::ColorSpace;
pub use limits::{Allowance, Missing};
pub use load::{Loaded, load, load_within, parse, parse_within};
pub use profile_file::{LoadedProfile, ProfileFile, load_profile, load_profile_within};
pub use schema::schema_json;
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
}

/// A thin-lens camera; a pinhole when `aperture` is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the lens.
    pub position: DVec3,
    /// A point on the view axis, different from `position`.
    pub target: DVec3,
    /// Up direction of the image; not parallel to the view axis, not necessarily perpendicular or
    /// unit.
    pub up: DVec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov_degrees: f64,
    /// Lens radius in scene units, >= 0.
    pub aperture: f64,
    /// Distance of the plane of focus along the view axis in scene units, > 0; scene files default
    /// to `|target - position|`.
    pub focus: f64,
}

impl Camera {
    /// A pinhole camera at `position` that looks at `target`, with +y up and a vertical field of
    /// view in degrees.
    pub fn look_at(position: DVec3, target: DVec3, fov_degrees: f64) -> Self {
        let focus = position.distance(target);
        Self { position, target, up: DVec3::Y, fov_degrees, aperture: 0.0, focus }
    }
}

impl Default for Film {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            exposure: 0.0,
            tonemap: ToneMap::default(),
            aovs: Aovs::default(),
            window: None,
        }
    }
}

/// Image size, tone mapping and extra channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Image width in pixels, >= 1.
    pub width: u32,
    /// Image height in pixels, >= 1.
    pub height: u32,
    /// Exposure of tone-mapped outputs in stops (powers of two).
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// Channels of EXR files in addition to radiance.
    pub aovs: Aovs,
    /// Crop window `[x0, y0, x1, y1]`: columns x0 to x1 and rows y0 to y1, with x1 and y1
    /// exclusive; inside the image and not empty. `None` renders the whole image.
    pub window: Option<[u32; 4]>,
}

/// Conversion of radiance to display values in 8-bit files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneMap {
    /// AgX: a filmic curve that preserves the hues of bright lights.
    #[default]
    Agx,
    /// Clipped to [0, 1], then sRGB-encoded.
    Srgb,
}

/// A light without a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point light with the same intensity in all directions.
    Point {
        /// Position in world space.
        position: DVec3,
        /// Radiant intensity in W/sr.
        intensity: Rgb,
    },
    /// A spot light that shines into a cone.
    Spot {
        /// Apex of the cone.
        position: DVec3,
        /// A point on the cone's axis, different from `position`.
        target: DVec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Rgb,
        /// Angle in degrees between the axis and the edge of the cone, in (0, 180].
        angle_degrees: f64,
        /// Fraction of `angle_degrees` over which the light fades, in [0, 1]: full up to
        /// `(1 - blend) angle`, then a smoothstep in the angle's cosine down to zero at `angle`.
        blend: f64,
    },
    /// Parallel light from infinitely far away.
    Sun {
        /// Unit vector in which the light travels.
        direction: DVec3,
        /// Irradiance on a surface facing the sun in W/m^2.
        irradiance: Rgb,
    },
}

/// Radiance from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Environment {
    /// The same radiance from all directions.
    Constant {
        /// Radiance in W sr^-1 m^-2.
        radiance: Rgb,
    },
    /// An equirectangular image; row 0 is the zenith (+y). A direction `d`, turned back about y,
    /// reads it at `u = 0.5 - atan2(d.z, d.x) / 2pi`, `v = 1 - acos(d.y) / pi`.
    Image {
        /// Index into [`Scene::images`].
        image: usize,
        /// Rotation of the image about +y in degrees, by the right-hand rule.
        rotate_degrees: f64,
        /// Radiance in W sr^-1 m^-2 of a texel value of one, per channel.
        scale: Rgb,
    },
}
