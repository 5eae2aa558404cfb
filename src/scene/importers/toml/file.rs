//! The scene file format as types.
//!
//! The parser, the checks and the JSON Schema for editors all derive from these types: field names
//! are the keys, and doc comments are the descriptions. The validated
//! [`Scene`](crate::scene::Scene) documents the meaning of each key in full.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::numbers::{Emission, NonNegative, Paint, Positive, Share, Spectrum, Strength};
use super::schema::close_variants;
use crate::scene::settings::RenderSettings;
use crate::scene::{Aov, ColorSpace, Filter, ToneMap, Wrap};

/// Three coordinates: x, y, z.
pub type Vec3 = [f64; 3];

/// A caustica scene. Right-handed, y up; linear Rec. 709 colors; one scene unit is one metre; paths
/// are relative to the file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format: 1.
    pub version: u32,
    /// Viewpoint and lens.
    pub camera: CameraFile,
    /// Image size, tone mapping and extra channels.
    #[serde(default)]
    pub film: FilmFile,
    /// Render settings; command-line options override them.
    #[serde(default)]
    pub render: RenderSettings,
    /// Named textures: colors as a function of a surface's (u, v).
    #[serde(default)]
    pub textures: BTreeMap<String, TextureFile>,
    /// Named materials: how surfaces scatter light.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialFile>,
    /// Surfaces, including area lights.
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
    /// Up direction of the image.
    #[serde(default = "y_axis")]
    pub up: Vec3,
    /// Vertical field of view in degrees, between 0 and 180.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub fov: f64,
    /// Lens radius in scene units; 0 is a pinhole.
    #[serde(default)]
    pub aperture: NonNegative,
    /// Distance from the lens to the plane of focus along the view direction, in scene units;
    /// required if the aperture is not 0.
    pub focus: Option<Positive>,
}

/// Image size, tone mapping and extra channels.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FilmFile {
    /// Image width in pixels.
    #[schemars(range(min = 1, max = 65536))]
    pub width: u32,
    /// Image height in pixels.
    #[schemars(range(min = 1, max = 65536))]
    pub height: u32,
    /// Exposure in stops, for tone-mapped outputs only.
    pub exposure: f64,
    /// Curve of tone-mapped outputs.
    pub tonemap: ToneMap,
    /// Channels of EXR files in addition to radiance.
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

/// A color as a function of a surface's (u, v).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum TextureFile {
    /// An image; v = 0 is its bottom row.
    Image {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// Encoding of its values; the file type gives the default.
        color_space: Option<ColorSpace>,
        /// Interpolation between texels.
        #[serde(default)]
        filter: Filter,
        /// Addressing outside [0, 1].
        #[serde(default)]
        wrap: Wrap,
        /// Factor on (u, v).
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// A checkerboard of squares one uv unit wide after scaling.
    Checker {
        /// Colors of square (0, 0) and of its neighbours.
        colors: [Spectrum<Share>; 2],
        /// Factor on (u, v).
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// An image laid as floor boards; every second row is shifted by half a board.
    Planks {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// Width (u) and length (v) of a board in uv units.
        size: [Positive; 2],
        /// Encoding of its values; the file type gives the default.
        color_space: Option<ColorSpace>,
        /// Interpolation between texels.
        #[serde(default)]
        filter: Filter,
    },
}

/// A material: how a surface scatters light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum MaterialFile {
    /// Two-sided diffuse reflection.
    Diffuse {
        /// Albedo.
        reflectance: Paint,
        /// Roughness, from 0 (Lambertian) to 1 (Oren-Nayar).
        #[serde(default)]
        roughness: Share,
    },
    /// Diffuse reflection and transmission by a thin surface such as paper.
    Translucent {
        /// Fraction of light that is scattered, to both sides together.
        reflectance: Paint,
        /// Fraction of the scattered light that is transmitted.
        transmission: Share,
    },
    /// A perfect two-sided mirror.
    Mirror {
        /// Fraction of light reflected.
        reflectance: Paint,
    },
    /// A smooth dielectric. Outside is air or, where bodies overlap, the other glass.
    Glass {
        /// Index of refraction.
        ior: Option<Positive>,
        /// Name of a material that has the index, such as bk7, water or diamond.
        material: Option<String>,
        /// Absorption coefficient inside, per scene unit (Beer-Lambert); 0 by default.
        absorption: Option<Spectrum<NonNegative>>,
        /// Fraction of light that is left at the attenuation distance; replaces `absorption`.
        attenuation_color: Option<Spectrum<Share>>,
        /// Distance in scene units at which the attenuation color is reached; 1 by default.
        attenuation_distance: Option<Positive>,
        /// Rank where glass bodies overlap: the medium is the glass with the highest priority, or
        /// that of the smaller body if priorities are equal.
        #[serde(default)]
        priority: i32,
    },
    /// A two-sided GGX microfacet conductor.
    Metal {
        /// Fraction of light reflected at normal incidence.
        reflectance: Paint,
        /// Roughness, from 0 (mirror) to 1; GGX alpha is its square.
        roughness: Share,
    },
}

/// Source of a shape's texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Uv {
    /// World x and z.
    Planar,
}

/// A shape with its material and emission.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = close_variants)]
pub enum ShapeFile {
    /// A sphere; the normal points outward.
    Sphere {
        /// Centre in world space.
        center: Vec3,
        /// Radius in scene units.
        radius: Positive,
        /// Name of a material.
        material: String,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A rectangle or parallelogram, origin + s u + t v with s and t from 0 to 1; normal along
    /// u x v, uv = (s, t).
    Rectangle {
        /// A corner.
        origin: Vec3,
        /// Edge along s.
        u: Vec3,
        /// Edge along t.
        v: Vec3,
        /// Name of a material.
        material: String,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A flat disc.
    Disc {
        /// Centre in world space.
        center: Vec3,
        /// Normal, on the side that emits; any length but 0.
        normal: Vec3,
        /// Radius in scene units.
        radius: Positive,
        /// Name of a material.
        material: String,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// An infinite plane; uv = world units along two tangents. It cannot emit.
    Plane {
        /// A point on the plane.
        point: Vec3,
        /// Normal; any length but 0.
        normal: Vec3,
        /// Name of a material.
        material: String,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// An axis-aligned box. Each face covers the unit square in uv, upright and unmirrored from
    /// outside (on top v increases along -z, below along z).
    Box {
        /// Corner with the least coordinates.
        min: Vec3,
        /// Corner with the greatest coordinates.
        max: Vec3,
        /// Name of a material.
        material: String,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A triangle mesh.
    Mesh {
        /// A Wavefront OBJ file.
        file: String,
        /// If true, shading uses the file's normals, or computes them where it has none, and faces
        /// are turned to the side that the file's normals point to. If false, faces are flat, and
        /// their corners are counterclockwise seen from outside.
        #[serde(default = "yes")]
        smooth: bool,
        /// Name of a material; by default, the materials of the OBJ's own MTL.
        material: Option<String>,
        /// Transform from object to world space.
        #[serde(default)]
        transform: TransformFile,
        /// Emission and texture coordinates.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A Bezier profile revolved about the local y axis. Outside is the side of greater radii if
    /// the profile is drawn upward; a closed body that faces inward causes a warning.
    Revolution {
        /// Control points (radius, height) of one Bezier curve.
        #[schemars(length(min = 2, max = 16))]
        profile: Option<Vec<[f64; 2]>>,
        /// Control points of several Bezier curves, joined end to end.
        segments: Option<Segments>,
        /// Name of a material.
        material: String,
        /// Transform from object to world space.
        #[serde(default)]
        transform: TransformFile,
        /// Emission and texture coordinates.
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

/// Keys that every shape accepts.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct SurfaceFile {
    /// Emitted radiance in W sr^-1 m^-2, on the side that the normal points to, or the name of a
    /// texture.
    #[serde(default)]
    pub emission: Emission,
    /// Radiance of a texture value of one, if the emission is a texture; 1 by default.
    pub emission_strength: Option<Spectrum<Strength>>,
    /// If true, both sides emit.
    #[serde(default)]
    pub two_sided_emission: bool,
    /// If false, the camera sees through the emitting shape. Mirrors and glass show it, and it
    /// casts shadows.
    #[serde(default = "yes")]
    pub camera_visible: bool,
    /// Texture coordinates that replace the shape's own.
    pub uv: Option<Uv>,
}

/// Scale, then rotation, then translation.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TransformFile {
    /// Uniform scale; 1 by default.
    pub scale: Option<Positive>,
    /// Rotation about an axis through the origin.
    pub rotate: Option<RotateFile>,
    /// Translation in scene units.
    pub translate: Vec3,
}

/// A rotation by the right-hand rule.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotateFile {
    /// Rotation axis; any length but 0.
    pub axis: Vec3,
    /// Angle in degrees.
    pub degrees: f64,
}

/// A light without a surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum LightFile {
    /// A point light with the same intensity in all directions.
    Point {
        /// Position in world space.
        position: Vec3,
        /// Radiant intensity in W/sr.
        intensity: Spectrum<Strength>,
    },
    /// A spot light that shines into a cone.
    Spot {
        /// Apex of the cone.
        position: Vec3,
        /// A point on the cone's axis.
        target: Vec3,
        /// Radiant intensity on the axis in W/sr.
        intensity: Spectrum<Strength>,
        /// Angle in degrees from the axis to the edge of the cone, where the light is zero; at most
        /// 180.
        #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
        angle: f64,
        /// Fraction of the angle over which the light fades.
        #[serde(default)]
        blend: Share,
    },
    /// A point light with the intensities of an IES file (LM-63, type C); 683 lumens are one watt.
    Ies {
        /// An .ies file.
        file: String,
        /// Position in world space.
        position: Vec3,
        /// Direction of the luminaire's nadir; straight down by default.
        #[serde(default = "down")]
        direction: Vec3,
        /// Rotation of the luminaire about its axis in degrees, before it is pointed along the
        /// direction. A luminaire that points down has horizontal angle 0 towards +x, and 90
        /// towards -z.
        #[serde(default)]
        rotate: f64,
        /// Factor on the intensities, such as a color; 1 by default.
        scale: Option<Spectrum<Strength>>,
    },
    /// A point light that throws an image through a pinhole.
    Projector {
        /// Position in world space.
        position: Vec3,
        /// A point on the axis.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Irradiance in W/m^2 of white on a screen that faces the projector at distance one.
        irradiance: Spectrum<Strength>,
        /// Angle in degrees between the left and the right edge, between 0 and 180.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        fov: f64,
        /// Width of the image over its height; by default that of the texture's image, or 1.
        aspect: Option<Positive>,
        /// Name of the texture that is thrown; white by default.
        texture: Option<String>,
    },
    /// Parallel light that leaves a disc along its axis.
    Beam {
        /// Centre of the disc.
        position: Vec3,
        /// Direction in which the light travels; any length but 0.
        direction: Vec3,
        /// Radius of the disc in scene units.
        radius: Positive,
        /// Irradiance on a surface facing the beam, in W/m^2.
        irradiance: Spectrum<Strength>,
    },
    /// Light from infinitely far away: parallel, or from a disc that the camera sees.
    Sun {
        /// Direction in which the light travels; any length but 0.
        direction: Vec3,
        /// Irradiance on a surface facing the sun, in W/m^2.
        irradiance: Spectrum<Strength>,
        /// Diameter of the sun's disc in degrees, from 0.001 to 180, such as 0.53; 0 for parallel
        /// light, which no camera sees.
        #[serde(default)]
        #[schemars(range(min = 0, max = 180))]
        angle: f64,
    },
}

/// Rotation of a sky.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum SkyRotation {
    /// Degrees about +y by the right-hand rule.
    Degrees(f64),
    /// Rotation about any axis.
    About(RotateFile),
    /// Rows of a matrix that turns directions of the image into directions of the scene.
    Matrix([Vec3; 3]),
}

/// A constant radiance from all directions, or an image.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// Radiance in W sr^-1 m^-2; with a file, a factor on its values.
    pub radiance: Option<Spectrum<Strength>>,
    /// An equirectangular image: exr, hdr, png or jpg.
    pub file: Option<String>,
    /// Rotation of the image: degrees about +y by the right-hand rule, { axis, degrees }, or the
    /// rows of a rotation matrix.
    pub rotate: Option<SkyRotation>,
}

fn y_axis() -> Vec3 {
    [0.0, 1.0, 0.0]
}

fn down() -> Vec3 {
    [0.0, -1.0, 0.0]
}

fn ones() -> [f64; 2] {
    [1.0, 1.0]
}

fn yes() -> bool {
    true
}
