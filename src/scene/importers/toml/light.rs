//! Conversion of lights and the environment.

use glam::{DMat3, DVec3};

use super::document::Item;
use super::file::{EnvironmentFile, LightFile, RotateFile, SkyRotation};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;
use crate::scene::{Environment, Light};

pub(super) fn light(builder: &mut SceneBuilder, item: &Item, file: LightFile) -> Option<()> {
    let light = match file {
        LightFile::Point { position, intensity } => {
            Light::Point { position: position.into(), intensity: intensity.rgb() }
        }
        LightFile::Spot { position, target, intensity, angle, blend } => Light::Spot {
            position: position.into(),
            target: target.into(),
            intensity: intensity.rgb(),
            angle_degrees: angle,
            blend: blend.0,
        },
        LightFile::Sun { direction, irradiance, angle } => {
            let direction = unit(&mut builder.report, item, "direction", direction)?;
            Light::Sun { direction, irradiance: irradiance.rgb(), angle_degrees: angle }
        }
    };
    builder.add_light(item, light);
    Some(())
}

pub(super) fn environment(
    builder: &mut SceneBuilder,
    item: &Item,
    file: &EnvironmentFile,
) -> Option<()> {
    let radiance = file.radiance.map(|radiance| radiance.rgb());
    let (rotate_degrees, tilt) = match &file.rotate {
        None => (0.0, None),
        Some(rotation) => sky_rotation(&mut builder.report, item, rotation)?,
    };
    let environment = if let Some(path) = &file.file {
        Environment::Image {
            image: builder.image(item, path, None)?,
            rotate_degrees,
            tilt,
            scale: radiance.unwrap_or([1.0; 3]),
        }
    } else {
        if file.rotate.is_some() {
            let message = "`rotate` has no meaning without a `file`";
            let label = "expected a `file` as well";
            builder.report.error(item.span_of("rotate"), message, label, None);
        }
        if radiance.is_none() {
            let message = "the environment has neither `radiance` nor `file`";
            builder.report.error(item.span(), message, "expected one of them in here", None);
        }
        Environment::Constant { radiance: radiance? }
    };
    builder.set_environment(item, environment);
    Some(())
}

/// Greatest difference of a rotation matrix times its transpose from the identity.
const ROTATION_ERROR: f64 = 1e-4;

/// Converts a sky's rotation to degrees about y and the rotation that follows; reports an axis
/// without a direction and a matrix that is not a rotation.
fn sky_rotation(
    report: &mut Report,
    item: &Item,
    rotation: &SkyRotation,
) -> Option<(f64, Option<DMat3>)> {
    match *rotation {
        SkyRotation::Degrees(degrees) => Some((degrees, None)),
        SkyRotation::About(RotateFile { axis, degrees }) => {
            let Some(axis) = DVec3::from(axis).try_normalize() else {
                let message = format!("`{}` has no direction", item.key("rotate.axis"));
                let span = item.node.get("rotate").map_or(item.span(), |node| node.span_of("axis"));
                report.error(span, message, "expected a vector of a length other than 0", None);
                return None;
            };
            if axis.x == 0.0 && axis.z == 0.0 {
                return Some((degrees * axis.y, None));
            }
            Some((0.0, Some(DMat3::from_axis_angle(axis, degrees.to_radians()))))
        }
        SkyRotation::Matrix(rows) => {
            let matrix = DMat3::from_cols_array_2d(&rows).transpose();
            let error = (matrix * matrix.transpose() - DMat3::IDENTITY).to_cols_array();
            let largest = error.into_iter().fold(0.0, |most: f64, e| most.max(e.abs()));
            if !(largest <= ROTATION_ERROR && matrix.determinant() > 0.0) {
                let message = format!("`{}` is not a rotation", item.key("rotate"));
                let label = "expected three perpendicular rows of length 1, with x cross y = z";
                report.error(item.span_of("rotate"), message, label, None);
                return None;
            }
            let x = matrix.x_axis.normalize();
            let z = x.cross(matrix.y_axis).normalize();
            Some((0.0, Some(DMat3::from_cols(x, z.cross(x), z))))
        }
    }
}
