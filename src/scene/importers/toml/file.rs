//! The scene file format as types.
//!
//! The parser, the checks and the JSON Schema for editors all derive from these types: field names
//! are the keys, and doc comments are the descriptions. The validated
//! [`Scene`](crate::scene::Scene) documents the meaning of each key in full.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::numbers::{NonNegative, Paint, Positive, Share, Spectrum, Strength};
use super::schema::{close_variants, default_to_first};
use super::transform::PlacementFile;
use crate::scene::numbers::{LARGEST_SHIFT, NARROWEST_FILTER, WIDEST_FILTER};
use crate::scene::settings::RenderSettings;
use crate::scene::{Aov, Axis, Channel, ColorSpace, Filter, ToneMap, Wrap};

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
    /// Named groups of shapes, which instances place.
    #[serde(default)]
    pub groups: BTreeMap<String, GroupFile>,
    /// Placed groups.
    #[serde(default)]
    pub instances: Vec<InstanceFile>,
    /// Point, spot and sun lights.
    #[serde(default)]
    pub lights: Vec<LightFile>,
    /// Light from infinitely far away.
    pub environment: Option<EnvironmentFile>,
}

/// A camera; without a type, a perspective one.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(transform = default_to_first)]
pub enum CameraFile {
    /// A thin-lens camera with straight lines.
    Perspective {
        /// Centre of the lens.
        position: Vec3,
        /// A point on the view axis.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Field of view in degrees, between 0 and 180; vertical, unless `fov_axis` names another
        /// axis.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        fov: Option<f64>,
        /// Axis of `fov` or `sensor`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
        /// Focal length in millimetres; replaces `fov`.
        focal_length: Option<Positive>,
        /// Size of the sensor along `fov_axis` in millimetres; that of a full-frame sensor, 36 by
        /// 24, by default.
        sensor: Option<Positive>,
        /// Shift of the lens: the image's window moves to the right and upward by these fractions
        /// of its width and height.
        #[serde(default)]
        shift: Shift,
        /// Lens radius in scene units; 0 is a pinhole.
        #[serde(default)]
        aperture: NonNegative,
        /// Distance from the lens to the plane of focus along the view direction, in scene units;
        /// required if the aperture is not 0.
        focus: Option<Positive>,
    },
    /// A parallel projection.
    Orthographic {
        /// Centre of the plane that rays start from.
        position: Vec3,
        /// A point on the view axis.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Size of the image in scene units; its height, unless `fov_axis` names another axis.
        size: Positive,
        /// Axis of `size`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
        /// The image's window moves to the right and upward by these fractions of its width and
        /// height.
        #[serde(default)]
        shift: Shift,
        /// Radius of the lens about each ray in scene units; 0 is a pinhole.
        #[serde(default)]
        aperture: NonNegative,
        /// Distance to the plane of focus along the view direction, in scene units; required if the
        /// aperture is not 0.
        focus: Option<Positive>,
    },
    /// All directions in an equirectangular image; the target is at its centre.
    Panorama {
        /// Viewpoint.
        position: Vec3,
        /// A point in the direction of the image's centre.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
    },
    /// An equidistant fisheye: distance from the image's centre is proportional to the angle. The
    /// image is black outside the circle of the field of view.
    Fisheye {
        /// Viewpoint.
        position: Vec3,
        /// A point in the direction of the image's centre.
        target: Vec3,
        /// Up direction of the image.
        #[serde(default = "y_axis")]
        up: Vec3,
        /// Field of view in degrees, at most 360; vertical, unless `fov_axis` names another axis.
        #[schemars(extend("exclusiveMinimum" = 0), range(max = 360))]
        fov: f64,
        /// Axis of `fov`: the image's height by default.
        #[serde(default)]
        fov_axis: Axis,
    },
}

/// Fractions of the image's width and height, each from -16 to 16.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Shift(pub [Fraction; 2]);

/// A number from -16 to 16.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = -LARGEST_SHIFT, "maximum" = LARGEST_SHIFT))]
pub struct Fraction(pub f64);

/// A pixel filter by name, with its usual numbers, or as a table.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum FilterFile {
    /// Name of the filter.
    Named(FilterName),
    /// The filter and its numbers.
    Table(FilterTable),
}

/// Name of a pixel filter.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum FilterName {
    /// The pixel itself.
    Box,
    /// A tent that ends at one pixel.
    Tent,
    /// A Gaussian of standard deviation 0.5 that ends at two pixels.
    Gaussian,
    /// The cubic filter with B = C = 1/3.
    Mitchell,
}

/// A pixel filter with its numbers, in pixels.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(inline)]
pub enum FilterTable {
    /// Constant in a square.
    Box {
        /// Half the width in pixels; 0.5 by default.
        radius: Option<FilterSize>,
    },
    /// A tent along x times one along y.
    Tent {
        /// Half the width in pixels; 1 by default.
        radius: Option<FilterSize>,
    },
    /// A Gaussian, cut off at a circle.
    Gaussian {
        /// Standard deviation in pixels; 0.5 by default.
        sigma: Option<FilterSize>,
        /// Radius of the circle in pixels; four standard deviations by default, at most 16.
        radius: Option<FilterSize>,
    },
    /// Cubic with negative lobes (Mitchell & Netravali 1988); two pixels wide on each side.
    Mitchell {
        /// Weight of the cubic B-spline; 1/3 by default.
        b: Option<Share>,
        /// Sharpness; 1/3 by default.
        c: Option<Share>,
    },
}

/// A length in pixels, from 0.05 to 16.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = NARROWEST_FILTER, "maximum" = WIDEST_FILTER))]
pub struct FilterSize(pub f64);

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
    /// Pixel filter; `"box"`, the pixel itself, by default.
    pub filter: FilterFile,
}

impl Default for FilmFile {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            exposure: 0.0,
            tonemap: ToneMap::default(),
            aov: Vec::new(),
            filter: FilterFile::Named(FilterName::Box),
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
        /// The only channel that is read, as gray values; such as alpha, for an opacity.
        channel: Option<Channel>,
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
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = close_variants)]
pub enum MaterialFile {
    /// Two-sided diffuse reflection.
    Diffuse {
        /// Albedo.
        reflectance: Paint,
        /// Roughness, from 0 (Lambertian) to 1 (Oren-Nayar).
        #[serde(default)]
        roughness: Share,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// Diffuse reflection and transmission by a thin surface such as paper.
    Translucent {
        /// Fraction of light that is scattered, to both sides together.
        reflectance: Paint,
        /// Fraction of the scattered light that is transmitted.
        transmission: Share,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A perfect two-sided mirror.
    Mirror {
        /// Fraction of light reflected.
        reflectance: Paint,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A smooth dielectric. Outside is air or, where bodies overlap, the other glass.
    Glass {
        /// Index of refraction.
        ior: Option<Positive>,
        /// Name of a material that has the index, such as bk7, water or diamond.
        material: Option<String>,
        /// Roughness of the surface, from 0 (smooth) to 1; GGX alpha is its square.
        #[serde(default)]
        roughness: Share,
        /// Absorption coefficient inside, per scene unit (Beer-Lambert); 0 by default.
        absorption: Option<Spectrum<NonNegative>>,
        /// Fraction of light that is left at the attenuation distance; replaces `absorption`.
        attenuation_color: Option<Spectrum<Share>>,
        /// Distance in scene units at which the attenuation color is reached; 1 by default.
        attenuation_distance: Option<Positive>,
        /// Rank where glass bodies overlap: the medium is the glass with the highest priority, or
        /// that of the smaller body if priorities are equal.
        priority: Option<i32>,
        /// If true, the surface is a thin sheet without an inside, such as a window pane, and does
        /// not bend light.
        #[serde(default)]
        thin: bool,
        /// Fraction of the transmitted light that a thin sheet lets through; 1 by default.
        transmittance: Option<Paint>,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A two-sided GGX microfacet conductor. Its color is given by `reflectance`, by `eta` and `k`,
    /// or by the name of a metal.
    Metal {
        /// Fraction of light reflected at normal incidence; towards grazing angles it rises to 1
        /// (Schlick).
        reflectance: Option<Paint>,
        /// Index of refraction per channel, for the exact Fresnel equations.
        eta: Option<Spectrum<Positive>>,
        /// Extinction coefficient per channel.
        k: Option<Spectrum<NonNegative>>,
        /// Name of a metal, such as gold, copper or aluminium.
        material: Option<String>,
        /// Roughness, from 0 (mirror) to 1; GGX alpha is its square.
        #[serde(default)]
        roughness: Share,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A diffuse base below a clear dielectric coat, as on plastic, glazed ceramics or varnish.
    Plastic {
        /// Albedo of the base.
        reflectance: Paint,
        /// Index of refraction of the coat, above 1; 1.5 by default.
        #[serde(default = "coat_ior")]
        #[schemars(extend("exclusiveMinimum" = 1))]
        ior: f64,
        /// Roughness of the coat, from 0 (smooth) to 1; GGX alpha is its square.
        #[serde(default)]
        roughness: Share,
        /// If true, light takes on the color of the base each time that the coat reflects it back
        /// inside, which saturates the color.
        #[serde(default)]
        nonlinear: bool,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A mix of two materials, which must not be glass with an inside.
    Mix {
        /// Names of the two materials.
        materials: [String; 2],
        /// Fraction of the second material; of a texture the mean of the channels counts.
        amount: Paint,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// A material for each side of a surface.
    TwoSided {
        /// Name of the material on the side that the normal points to.
        front: String,
        /// Name of the material on the other side.
        back: String,
        /// Opacity.
        #[serde(flatten)]
        coverage: CoverageFile,
    },
    /// No material: light passes straight through.
    Null {},
}

/// Keys that every material accepts, except `null`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct CoverageFile {
    /// Fraction of light that meets the surface; the rest passes straight through. Of a texture the
    /// mean of the channels counts. 1 by default.
    pub opacity: Option<Paint>,
    /// Makes the surface a mask: opaque where the opacity is at least this, else absent.
    pub opacity_cutoff: Option<Share>,
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
        /// Emission, texture coordinates and transform.
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
        /// Emission, texture coordinates and transform.
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
        /// Emission, texture coordinates and transform.
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
        /// Emission, texture coordinates and transform.
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
        /// Emission, texture coordinates and transform.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A triangle mesh.
    Mesh {
        /// A Wavefront OBJ or PLY file.
        file: String,
        /// If true, shading uses the file's normals, or computes them where it has none, and faces
        /// are turned to the side that the file's normals point to. If false, faces are flat, and
        /// their corners are counterclockwise seen from outside.
        #[serde(default = "yes")]
        smooth: bool,
        /// Angle in degrees: normals are computed, in place of those of the file, and averaged only
        /// across edges where two faces meet whose normals differ by less.
        #[schemars(range(min = 0, max = 180))]
        crease_angle: Option<f64>,
        /// Name of a material; by default, the materials of the OBJ's own MTL. PLY files need it.
        material: Option<String>,
        /// Emission, texture coordinates and transform.
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
        /// Emission, texture coordinates and transform.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A cylinder; the normal points away from its axis, and from the ends. It is a surface of
    /// revolution: v goes through the lower cap, the side and the upper cap, an equal part for
    /// each.
    Cylinder {
        /// Radius in scene units.
        radius: Positive,
        /// Height above the origin along the local y axis; or give `p0` and `p1`.
        height: Option<Positive>,
        /// Centre of the lower end.
        p0: Option<Vec3>,
        /// Centre of the upper end.
        p1: Option<Vec3>,
        /// If true, discs close the ends.
        #[serde(default = "yes")]
        caps: bool,
        /// Name of a material.
        material: String,
        /// Emission, texture coordinates and transform.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
    /// A cone or, with an upper radius, a frustum of one; the normal points away from its axis, and
    /// from the ends. It is a surface of revolution: v goes through the lower cap, the side and the
    /// upper cap, an equal part for each.
    Cone {
        /// Radius of the lower end in scene units.
        radius: Positive,
        /// Radius of the upper end; 0, by default, is a tip.
        #[serde(default)]
        top_radius: NonNegative,
        /// Height above the origin along the local y axis; or give `p0` and `p1`.
        height: Option<Positive>,
        /// Centre of the lower end.
        p0: Option<Vec3>,
        /// Centre of the upper end.
        p1: Option<Vec3>,
        /// If true, discs close the ends.
        #[serde(default = "yes")]
        caps: bool,
        /// Name of a material.
        material: String,
        /// Emission, texture coordinates and transform.
        #[serde(flatten)]
        surface: SurfaceFile,
    },
}

impl ShapeFile {
    /// The keys that every shape accepts.
    pub fn surface(&self) -> &SurfaceFile {
        match self {
            Self::Sphere { surface, .. }
            | Self::Rectangle { surface, .. }
            | Self::Disc { surface, .. }
            | Self::Plane { surface, .. }
            | Self::Box { surface, .. }
            | Self::Mesh { surface, .. }
            | Self::Revolution { surface, .. }
            | Self::Cylinder { surface, .. }
            | Self::Cone { surface, .. } => surface,
        }
    }
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
    /// Emitted radiance in W sr^-1 m^-2, on the side that the normal points to.
    #[serde(default)]
    pub emission: Spectrum<Strength>,
    /// Texture coordinates that replace the shape's own.
    pub uv: Option<Uv>,
    /// Affine map from object to world space.
    pub transform: Option<PlacementFile>,
}

/// Scale, then rotation, then translation, of a profile file.
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

/// Shapes in a space of their own.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GroupFile {
    /// Surfaces; their transforms lead to the group's space.
    pub shapes: Vec<ShapeFile>,
    /// Instances of other groups in this one.
    pub instances: Vec<InstanceFile>,
}

/// A group in another place.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InstanceFile {
    /// Name of a group.
    pub group: String,
    /// Affine map from the group's space to world space, or to that of the group that contains the
    /// instance.
    pub transform: Option<PlacementFile>,
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

fn coat_ior() -> f64 {
    1.5
}

fn ones() -> [f64; 2] {
    [1.0, 1.0]
}

fn yes() -> bool {
    true
}
