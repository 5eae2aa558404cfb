//! Profile files: the Bezier profile of one surface of revolution, on its own.

use std::path::Path;
use std::sync::LazyLock;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;

use super::file::{Segments, TransformFile};
use super::geometry::Transform;
use super::limits::Allowance;
use super::profile::segments;
use super::report::{Finding, SceneErrors};
use super::surfaces::placed;
use super::validate::whole;
use super::{schema, text};

/// A Bezier profile turned about the y axis; keys as on a revolution in a scene file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProfileFile {
    /// Control points (radius, height) of one Bezier curve.
    #[schemars(length(min = 2, max = 16))]
    pub profile: Option<Vec<[f64; 2]>>,
    /// Several Bezier curves, joined end to end.
    pub segments: Option<Segments>,
    /// World from object.
    #[serde(default)]
    pub transform: TransformFile,
}

/// What a profile file holds.
#[derive(Clone, Debug)]
pub struct LoadedProfile {
    /// Control points (radius, height) of each Bezier segment, as in
    /// [`super::ShapeKind::Revolution`].
    pub segments: Vec<Vec<DVec2>>,
    /// World from object.
    pub transform: Transform,
    /// What is odd but no error.
    pub warnings: Vec<Finding>,
}

/// Reads a profile file: `profile` or `segments`, and `transform` or not.
///
/// # Errors
/// Everything that is wrong with it, at once.
pub fn load_profile(path: &Path) -> Result<LoadedProfile, SceneErrors> {
    load_profile_within(path, &Allowance::default())
}

/// As [`load_profile`], where not everything is allowed.
///
/// # Errors
/// As [`load_profile`], and where something is not allowed.
pub fn load_profile_within(
    path: &Path,
    allowance: &Allowance,
) -> Result<LoadedProfile, SceneErrors> {
    static SCHEMA: LazyLock<Json> = LazyLock::new(schema::of::<ProfileFile>);
    let bytes = text::read(path, allowance)?;
    let ((segments, transform), warnings) =
        text::parse(path, &bytes, allowance, |root, report| {
            let item = whole(&SCHEMA, root, report);
            let file: ProfileFile = item.read(report)?;
            let segments = segments(report, &item, file.profile, file.segments);
            let transform = placed(report, &item, &file.transform);
            segments.zip(transform)
        })?;
    Ok(LoadedProfile { segments, transform, warnings })
}
