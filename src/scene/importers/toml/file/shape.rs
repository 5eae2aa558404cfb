//! Shapes, their placement, groups and instances.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::numbers::{NonNegative, Positive, Spectrum, Strength};
use super::super::schema::close_variants;
use super::super::transform::PlacementFile;
use super::Vec3;

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

/// Shapes in the group's space.
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

fn yes() -> bool {
    true
}
