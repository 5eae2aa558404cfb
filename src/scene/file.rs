//! The scene format: what a person may write in a scene file, as types.
//!
//! Parser, checks and the JSON Schema for editors all come from these types: their names are the
//! keys, their doc comments the descriptions. What a key means in full is said at the validated
//! [`Scene`](super::Scene).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::appearance::{Filter, Wrap};
use super::numbers::{NonNegative, Paint, Positive, Share, Spectrum, Strength};
use super::schema::close_variants;
use super::{Aov, ToneMap};
use crate::scene::settings::RenderSettings;

/// Three coordinates.
pub type Vec3 = [f64; 3];

/// A caustica scene. Right-handed, y up; linear Rec. 709 colors; one scene unit is a metre; paths
/// are relative to the file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format: 1.
    pub version: u32,
    /// Where the picture is taken from.
    pub camera: CameraFile,
    /// Size and development of the picture.
    #[serde(default)]
    pub film: FilmFile,
    /// How it is rendered; the command line overrides.
    #[serde(default)]
    pub render: RenderSettings,
    /// Named colors over a surface's (u, v).
    #[serde(default)]
    pub textures: BTreeMap<String, TextureFile>,
    /// Named ways of scattering light.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialFile>,
    /// Surfaces.
    #[serde(default)]
    pub shapes: Vec<ShapeFile>,
    /// Lights without a surface.
    #[serde(default)]
    pub lights: Vec<LightFile>,
    /// Light from infinitely far away.
    pub environment: Option<EnvironmentFile>,
}

/// A thin-lens camera.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Centre of the lens.
    pub position: Vec3,
    /// A point on the view axis.
    pub target: Vec3,
    /// Points to the top of the picture.
    #[serde(default = "y_axis")]
    pub up: Vec3,
    /// Vertical field of view in degrees, between 0 and 180.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub fov: f64,
    /// Radius of the lens in scene units; 0 is a pinhole.
    #[serde(default)]
    pub aperture: NonNegative,
    /// Distance of the plane in focus from the lens along the view direction, in scene units;
    /// needed when the aperture is not 0.
    pub focus: Option<Positive>,
}

/// Size and development of the picture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FilmFile {
    /// Pixels per row.
    #[schemars(range(min = 1, max = 65536))]
    pub width: u32,
    /// Rows.
    #[schemars(range(min = 1, max = 65536))]
    pub height: u32,
    /// Exposure in stops; tone-mapped outputs only.
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// What EXR files hold in addition to radiance.
    pub aov: Vec<Aov>,
}

impl Default for FilmFile {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            exposure: 0.0,
            tonemap: ToneMap::default(),
            aov: Vec::new(),
        }
    }
}

/// What the numbers in an image file mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColorSpace {
    /// The sRGB curve; the default for png and jpg.
    Srgb,
    /// Proportional to light; the default for hdr and exr.
    Linear,
}

/// A color over a surface's (u, v).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum TextureFile {
    /// A picture; v = 0 is its bottom row.
    Image {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// What its numbers mean.
        color_space: Option<ColorSpace>,
        /// How it is read between texels.
        #[serde(default)]
        filter: Filter,
        /// How it is read outside [0, 1].
        #[serde(default)]
        wrap: Wrap,
        /// (u, v) is multiplied by it.
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// Squares of two colors, one uv unit wide after scaling.
    Checker {
        /// Colors of square (0, 0) and of its neighbours.
        colors: [Spectrum<Share>; 2],
        /// (u, v) is multiplied by it.
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// A picture laid as floor boards; every second row is shifted by half a board.
    Planks {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// Width (u) and length (v) of a board in uv units.
        size: [Positive; 2],
        /// What its numbers mean.
        color_space: Option<ColorSpace>,
        /// How it is read between texels.
        #[serde(default)]
        filter: Filter,
    },
}

/// A way of scattering light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum MaterialFile {
    /// Diffuse reflection, two-sided.
    Diffuse {
        /// Albedo.
        reflectance: Paint,
        /// From 0 (Lambertian) to 1 (Oren-Nayar).
        #[serde(default)]
        roughness: Share,
    },
    /// Diffuse reflection and transmission by a thin surface such as paper.
    Translucent {
        /// Share of light that is scattered to both sides.
        reflectance: Paint,
        /// Share of the scattered light that is transmitted.
        transmission: Share,
    },
    /// A perfect mirror, two-sided.
    Mirror {
        /// Share of light reflected.
        reflectance: Paint,
    },
    /// A smooth dielectric. Outside is air, or the other glass where bodies overlap.
    Glass {
        /// Index of refraction.
        ior: Positive,
        /// Absorption per scene unit inside (Beer-Lambert).
        #[serde(default)]
        absorption: Spectrum<NonNegative>,
        /// Where glass bodies overlap, the medium is the one with the highest priority, or the
        /// smaller one if priorities are equal.
        #[serde(default)]
        priority: i32,
    },
    /// A GGX microfacet conductor, two-sided.
    Metal {
        /// Share of light reflected at normal incidence.
        reflectance: Paint,
        /// From 0 (mirror) to 1; GGX alpha is its square.
        roughness: Share,
    },
}

/// What a shape's (u, v) are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Uv {
    /// World x and z.
    Planar,
}

/// A surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = close_variants)]
pub enum ShapeFile {
    /// All points at one distance from the centre.
    Sphere {
        /// Centre.
        center: Vec3,
        /// Radius in scene units.
        radius: Positive,
        /// Name of a material.
        material: String,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// origin + s u + t v with s and t from 0 to 1; normal along u x v, uv = (s, t).
    Rectangle {
        /// A corner.
        origin: Vec3,
        /// Edge along s.
        u: Vec3,
        /// Edge along t.
        v: Vec3,
        /// Name of a material.
        material: String,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A flat disc.
    Disc {
        /// Centre.
        center: Vec3,
        /// Points to the lit side; any length but 0.
        normal: Vec3,
        /// Radius in scene units.
        radius: Positive,
        /// Name of a material.
        material: String,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// An infinite plane; uv = world units along two tangents. It cannot shine.
    Plane {
        /// A point on it.
        point: Vec3,
        /// Any length but 0.
        normal: Vec3,
        /// Name of a material.
        material: String,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// An axis-aligned box; each face is the unit square in uv, upright and unmirrored from outside
    /// (on top v increases along -z, below along z).
    Box {
        /// Least corner.
        min: Vec3,
        /// Greatest corner.
        max: Vec3,
        /// Name of a material.
        material: String,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A triangle mesh.
    Mesh {
        /// A Wavefront OBJ file.
        file: String,
        /// Use the file's normals, or make them where it has none, and turn faces to the side that
        /// they point to; false: flat, and the order of a face's corners (counterclockwise from
        /// outside) says which side is outside.
        #[serde(default = "yes")]
        smooth: bool,
        /// Name of a material; without it, the OBJ's own MTL is used.
        material: Option<String>,
        /// World from object.
        #[serde(default)]
        transform: TransformFile,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A Bezier profile turned about the local y axis. Outside is where the profile, drawn upward,
    /// has its greater radii; a closed body that faces inward is warned of.
    Revolution {
        /// Control points (radius, height) of one Bezier curve.
        #[schemars(length(min = 2, max = 16))]
        profile: Option<Vec<[f64; 2]>>,
        /// Several Bezier curves, joined end to end.
        segments: Option<Segments>,
        /// Name of a material.
        material: String,
        /// World from object.
        #[serde(default)]
        transform: TransformFile,
        /// Light and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
}

/// Control points (radius, height) of several Bezier curves, 2 to 16 each.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Segments(
    #[schemars(length(min = 1), inner(length(min = 2, max = 16)))] pub Vec<Vec<[f64; 2]>>,
);

/// What every shape may have.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct SurfaceFile {
    /// Radiance in W sr^-1 m^-2 that leaves the side that the normal points to.
    #[serde(default)]
    pub emission: Spectrum<Strength>,
    /// Texture coordinates in place of the shape's own.
    pub uv: Option<Uv>,
}

/// Scale, then rotation, then translation.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TransformFile {
    /// Uniform scale; 1 without it.
    pub scale: Option<Positive>,
    /// Rotation.
    pub rotate: Option<RotateFile>,
    /// In scene units.
    pub translate: Vec3,
}

/// A rotation by the right-hand rule.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotateFile {
    /// Any length but 0.
    pub axis: Vec3,
    /// Angle.
    pub degrees: f64,
}

/// A light without a surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum LightFile {
    /// Shines alike in all directions.
    Point {
        /// Where it is.
        position: Vec3,
        /// Radiant intensity in W/sr.
        intensity: Spectrum<Strength>,
    },
    /// Shines into a cone.
    Spot {
        /// Apex of the cone.
        position: Vec3,
        /// A point on its axis.
        target: Vec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Spectrum<Strength>,
        /// Degrees from the axis to where it is dark; at most 180.
        #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
        angle: f64,
        /// Share of the angle over which it fades.
        #[serde(default)]
        blend: Share,
    },
    /// Parallel light.
    Sun {
        /// In which the light travels; any length but 0.
        direction: Vec3,
        /// On a surface facing the sun, in W/m^2.
        irradiance: Spectrum<Strength>,
    },
}

/// Either one radiance from everywhere, or a picture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// In W sr^-1 m^-2; with a file, what its values are multiplied by.
    pub radiance: Option<Spectrum<Strength>>,
    /// An equirectangular picture: exr, hdr, png or jpg.
    pub file: Option<String>,
    /// Turn of the picture about y in degrees, by the right-hand rule.
    pub rotate: Option<f64>,
}

fn y_axis() -> Vec3 {
    [0.0, 1.0, 0.0]
}

fn ones() -> [f64; 2] {
    [1.0, 1.0]
}

fn yes() -> bool {
    true
}
