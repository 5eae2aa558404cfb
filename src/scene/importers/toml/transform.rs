//! Transforms of shapes and instances.

use glam::{DAffine3, DMat3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

use super::document::Item;
use super::file::{RotateFile, TransformFile, Vec3};
use super::numbers::Positive;
use super::tree::Node;
use crate::scene::Transform;
use crate::scene::diagnostics::Report;
use crate::scene::numbers::{LARGEST, SMALLEST};
use crate::scene::parts::Part;

/// Smallest volume of the image of a cube, relative to the product of its edges.
const LEAST_VOLUME: f64 = 1e-9;

/// An affine map from object to world space: one step, or several in the order in which they apply.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PlacementFile {
    /// One step.
    Step(StepFile),
    /// Steps; the first one applies first.
    Steps(Vec<StepFile>),
}

/// Matrix, then scale, then rotation, then translation.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StepFile {
    /// Rows of a 3x4 or 4x4 matrix that multiplies column vectors (x, y, z, 1).
    #[schemars(length(min = 3, max = 4))]
    pub matrix: Option<Vec<[f64; 4]>>,
    /// Uniform scale, or a factor for each axis; negative factors mirror.
    pub scale: Option<ScaleFile>,
    /// Rotation about an axis through the origin.
    pub rotate: Option<RotateFile>,
    /// Translation in scene units.
    pub translate: Vec3,
}

/// Uniform scale, or a factor for each axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum ScaleFile {
    /// The same factor for all axes.
    Uniform(Positive),
    /// Factors for x, y and z; negative ones mirror.
    Axes(Vec3),
}

/// A validated transform.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Map from object to world space; finite and invertible.
    pub map: DAffine3,
    /// The same map, if it is written as a uniform scale, a rotation and a translation.
    pub similar: Option<Transform>,
    /// False for the identity of an item without a transform.
    pub is_given: bool,
}

impl Placement {
    /// The map, if the item has one.
    pub fn given(&self) -> Option<&DAffine3> {
        self.is_given.then_some(&self.map)
    }

    /// The map that is left for a shape that contains the similar one.
    pub fn rest(&self) -> Option<&DAffine3> {
        self.similar.is_none().then_some(&self.map)
    }
}

/// Converts the key `transform` of an item; `None` after an error, which is reported.
pub(super) fn placement(
    report: &mut Report,
    item: &Item,
    file: Option<&PlacementFile>,
) -> Option<Placement> {
    let node = item.node.get("transform");
    let path = item.key("transform");
    let placement = match file {
        None => Placement {
            map: DAffine3::IDENTITY,
            similar: Some(Transform::IDENTITY),
            is_given: false,
        },
        Some(PlacementFile::Step(file)) => step(report, (node, &path), file)?,
        Some(PlacementFile::Steps(files)) => {
            let mut map = DAffine3::IDENTITY;
            for (k, file) in files.iter().enumerate() {
                let node = node.and_then(|node| node.elements().nth(k));
                map = step(report, (node, &format!("{path}[{k}]")), file)?.map * map;
            }
            Placement { map, similar: None, is_given: true }
        }
    };
    if let Err((fault, expected)) = invertible(&placement.map) {
        let span = item.span_of("transform");
        report.error(span, format!("`{path}` {fault}"), expected, None);
        return None;
    }
    Some(placement)
}

/// Converts one step at a node with this path.
fn step(
    report: &mut Report,
    (node, path): (Option<Node>, &str),
    file: &StepFile,
) -> Option<Placement> {
    let rotation = rotation(report, (node, path), file.rotate.as_ref())?;
    let translation = DVec3::from(file.translate);
    let first = match &file.matrix {
        None => DAffine3::IDENTITY,
        Some(rows) => matrix(report, (node, path), rows)?,
    };
    let scale = match file.scale {
        None => DVec3::ONE,
        // one out of range was reported
        Some(ScaleFile::Uniform(scale)) if scale.0 < SMALLEST => DVec3::ONE,
        Some(ScaleFile::Uniform(scale)) => DVec3::splat(scale.0),
        Some(ScaleFile::Axes(factors)) => DVec3::from(factors),
    };
    let map = DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(scale) * first.matrix3,
        translation: rotation * (scale * first.translation) + translation,
    };
    let similar = match (&file.matrix, file.scale) {
        (None, None | Some(ScaleFile::Uniform(_))) => {
            Some(Transform { scale: scale.x, rotation, translation })
        }
        _ => None,
    };
    Some(Placement { map, similar, is_given: true })
}

/// Rotation matrix; reports an axis without a direction.
fn rotation(
    report: &mut Report,
    (node, path): (Option<Node>, &str),
    file: Option<&RotateFile>,
) -> Option<DMat3> {
    let Some(rotate) = file else { return Some(DMat3::IDENTITY) };
    let Some(axis) = DVec3::from(rotate.axis).try_normalize() else {
        let message = format!("`{path}.rotate.axis` has no direction");
        let rotate = node.and_then(|node| node.get("rotate"));
        let span = rotate.or(node).map_or(0..0, |node| node.span_of("axis"));
        report.error(span, message, "expected a vector of a length other than 0", None);
        return None;
    };
    Some(DMat3::from_axis_angle(axis, rotate.degrees.to_radians()))
}

/// Affine map of the rows of a matrix; reports a projective one.
fn matrix(
    report: &mut Report,
    (node, path): (Option<Node>, &str),
    rows: &[[f64; 4]],
) -> Option<DAffine3> {
    if let Some(last) = rows.get(3)
        && *last != [0.0, 0.0, 0.0, 1.0]
    {
        let span = node.map_or(0..0, |node| node.span_of("matrix"));
        let message = format!("`{path}.matrix` is not affine: its last row is {last:?}");
        let help = "a matrix is written row by row; transpose one that is written by columns";
        report.error(span, message, "expected the last row [0, 0, 0, 1]", Some(help.to_owned()));
        return None;
    }
    let column = |j: usize| DVec3::from_array([0, 1, 2].map(|i| rows.get(i).map_or(0.0, |r| r[j])));
    Some(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}

/// Converts the transform of a profile file; reports a rotation axis without a direction.
pub(super) fn similar(report: &mut Report, item: &Item, file: &TransformFile) -> Option<Transform> {
    let place = (item.node.get("transform"), &*item.key("transform"));
    Some(Transform {
        scale: file.scale.map_or(1.0, f64::from),
        rotation: rotation(report, place, file.rotate.as_ref())?,
        translation: file.translate.into(),
    })
}

/// Checks that a map is finite, within the range of numbers and invertible; otherwise returns what
/// is wrong, and what was expected.
fn invertible(map: &DAffine3) -> Result<(), (String, String)> {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let largest = columns.iter().chain([&map.translation]).map(|c| c.abs().max_element());
    let largest = largest.fold(0.0, f64::max);
    if !map.is_finite() || largest > LARGEST {
        let fault = format!("has an entry of {largest:.1e}, too large for single precision");
        return Err((fault, format!("expected at most {LARGEST:e} in magnitude")));
    }
    let edges = columns.map(DVec3::length);
    let least = edges.into_iter().fold(f64::INFINITY, f64::min);
    let unit = DMat3::from_cols(
        columns[0].normalize_or_zero(),
        columns[1].normalize_or_zero(),
        columns[2].normalize_or_zero(),
    );
    if least < SMALLEST || unit.determinant().abs() < LEAST_VOLUME {
        let fault = "is singular: it flattens shapes to a plane, a line or a point".to_owned();
        return Err((fault, "expected a map that keeps three dimensions, without a 0".to_owned()));
    }
    Ok(())
}
