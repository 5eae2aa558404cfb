//! Profile files: the Bezier profile of a single surface of revolution.

use std::path::Path;
use std::sync::LazyLock;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;

use super::file::{Segments, TransformFile};
use super::parse::parse;
use super::profile::segments;
use super::schema;
use super::transform::similar;
use super::tree::Node;
use super::validate::whole;
use crate::scene::diagnostics::{Finding, Report, SceneErrors};
use crate::scene::load::{self, InputFile};
use crate::scene::{Allowance, Transform};

/// A Bezier profile revolved about the y axis; the keys are those of a revolution in a scene file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProfileFile {
    /// Control points (radius, height) of one Bezier curve.
    #[schemars(length(min = 2, max = 16))]
    pub profile: Option<Vec<[f64; 2]>>,
    /// Control points of several Bezier curves, joined end to end.
    pub segments: Option<Segments>,
    /// Transform from object to world space.
    #[serde(default)]
    pub transform: TransformFile,
}

/// Contents of a profile file.
#[derive(Clone, Debug)]
pub struct LoadedProfile {
    /// Control points (radius, height) of each Bezier segment, as in
    /// [`ShapeKind::Revolution`](crate::scene::ShapeKind::Revolution).
    pub segments: Vec<Vec<DVec2>>,
    /// Transform from object to world space.
    pub transform: Transform,
    /// Warnings about the profile.
    pub warnings: Vec<Finding>,
}

/// Reads a profile file: `profile` or `segments`, and an optional `transform`.
///
/// # Errors
/// All errors in the file together.
pub fn load_profile(path: &Path) -> Result<LoadedProfile, SceneErrors> {
    load_profile_within(path, &Allowance::default())
}

/// Like [`load_profile`], within an allowance.
///
/// # Errors
/// As [`load_profile`], and everything that the allowance forbids.
pub fn load_profile_within(
    path: &Path,
    allowance: &Allowance,
) -> Result<LoadedProfile, SceneErrors> {
    static SCHEMA: LazyLock<Json> = LazyLock::new(schema::of::<ProfileFile>);
    let bytes = load::read(path, allowance)?;
    let (text, mut report) = InputFile { path, bytes: &bytes, allowance }.decode()?;
    let root = parse(&text, &mut report);
    let profile = root.as_ref().and_then(|root| profile(Node::new(root), &SCHEMA, &mut report));
    let ((segments, transform), warnings) = report.conclude(profile)?;
    Ok(LoadedProfile { segments, transform, warnings })
}

fn profile(root: Node, schema: &Json, report: &mut Report) -> Option<(Vec<Vec<DVec2>>, Transform)> {
    let item = whole(schema, root, report);
    let file: ProfileFile = item.read(report)?;
    let segments = segments(report, &item, file.profile, file.segments);
    let transform = similar(report, &item, &file.transform);
    segments.zip(transform)
}
