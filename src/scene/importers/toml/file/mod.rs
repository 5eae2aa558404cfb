//! The scene file format as types.
//!
//! The parser, the checks and the JSON Schema for editors all derive from these types: field names
//! are the keys, and doc comments are the descriptions. The validated
//! [`Scene`](crate::scene::Scene) documents the meaning of each key in full.

mod appearance;
mod camera;
mod light;
mod shape;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::settings::RenderSettings;

pub use appearance::{CommonFile, MaterialFile, TextureFile};
pub use camera::{
    CameraFile, FilmFile, FilterFile, FilterName, FilterSize, FilterTable, Fraction, Shift,
};
pub use light::{EnvironmentFile, LightFile, SkyRotation};
pub use shape::{
    GroupFile, InstanceFile, RotateFile, Segments, ShapeFile, SurfaceFile, TransformFile, Uv,
};

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
