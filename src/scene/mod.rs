//! Scene files in, validated scenes out.
//!
//! A [`Scene`] is what a person wrote, in f64 and in the units of the file, with every name
//! resolved to an index and every number checked. Nothing in it depends on a device.
//!
//! Conventions: right-handed, y up; linear Rec. 709 RGB; one scene unit is one metre; angles in
//! degrees.

mod aov;
mod appearance;
mod camera;
mod diagnostics;
mod encoding;
mod exr_image;
mod exr_subsampled;
pub mod file;
mod geometry;
mod image_bytes;
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
mod report;
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
pub use geometry::{Mesh, Shape, ShapeKind, Transform, Triangle};
pub use limits::{Allowance, Missing};
pub use load::{Loaded, load, load_within, parse, parse_within};
pub use profile_file::{LoadedProfile, ProfileFile, load_profile, load_profile_within};
pub use report::{Finding, SceneErrors};
pub use schema::schema_json;
pub use spans::Spans;

/// A validated scene: finite numbers, unit normals, no dangling index.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The file's stem.
    pub name: String,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// What it is taken on.
    pub film: Film,
    /// Pixels of image files, each (file, color space) once.
    pub images: Vec<ImageData>,
    /// Textures; [`Reflectance::Texture`] indexes them.
    pub textures: Vec<Texture>,
    /// Materials; [`Shape::material`] indexes them.
    pub materials: Vec<Material>,
    /// Surfaces, area lights among them.
    pub shapes: Vec<Shape>,
    /// Lights without a surface.
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
    /// A point on the view axis; differs from `position`.
    pub target: DVec3,
    /// Points to the top of the picture; not parallel to the view axis, not necessarily
    /// perpendicular or unit.
    pub up: DVec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov_degrees: f64,
    /// Radius of the lens in scene units, >= 0.
    pub aperture: f64,
    /// Distance of the plane in focus along the view axis, > 0; `|target - position|` when the file
    /// gives none.
    pub focus: f64,
}

impl Camera {
    /// A pinhole camera at `position` that looks at `target`, +y on top, with a vertical field of
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

/// Size and development of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Pixels per row, >= 1.
    pub width: u32,
    /// Rows, >= 1.
    pub height: u32,
    /// Exposure of tone-mapped outputs in stops (powers of two).
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// What EXR files hold in addition to radiance.
    pub aovs: Aovs,
    /// The window that is rendered, columns x0 to x1 and rows y0 to y1 as `[x0, y0, x1, y1]`, x1
    /// and y1 left out; inside of the picture and not empty. None is all of it.
    pub window: Option<[u32; 4]>,
}

/// How radiance becomes display values in 8-bit files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneMap {
    /// AgX: a filmic curve that keeps hues of bright lights.
    #[default]
    Agx,
    /// Clipped to [0, 1], then the sRGB curve.
    Srgb,
}

/// A light without a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines alike in all directions.
    Point {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity in W/sr.
        intensity: Rgb,
    },
    /// Shines into a cone.
    Spot {
        /// Apex of the cone.
        position: DVec3,
        /// A point on the cone's axis; differs from `position`.
        target: DVec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Rgb,
        /// Angle in degrees between the axis and the directions from which on it is dark, in (0,
        /// 180].
        angle_degrees: f64,
        /// Share of `angle_degrees` over which the light fades, in [0, 1]: full up to `(1 - blend)
        /// angle`, then a smoothstep in the angle's cosine down to zero at `angle`.
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

/// Radiance that arrives from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Environment {
    /// The same from everywhere.
    Constant {
        /// In W sr^-1 m^-2.
        radiance: Rgb,
    },
    /// An equirectangular picture: row 0 is the zenith (+y). A direction `d` reads it at `u = 0.5 -
    /// atan2(d.z, d.x) / 2pi`, `v = 1 - acos(d.y) / pi`, after `d` is turned back about y.
    Image {
        /// Index into [`Scene::images`].
        image: usize,
        /// Turn of the picture about +y in degrees, by the right-hand rule.
        rotate_degrees: f64,
        /// Radiance in W sr^-1 m^-2 of a texel of value one, per channel.
        scale: Rgb,
    },
}
