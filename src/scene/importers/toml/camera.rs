//! Conversion of the camera.

use glam::DVec3;

use super::document::{Document, Item};
use super::file::{CameraFile, Shift, Vec3};
use super::numbers::{NonNegative, Positive};
use crate::scene::builder::SceneBuilder;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;
use crate::scene::{Axis, Camera, Projection};

/// Keys that several projections share.
struct Common {
    position: Vec3,
    target: Vec3,
    up: Vec3,
    shift: Shift,
    aperture: NonNegative,
    focus: Option<Positive>,
}

pub(super) fn camera(builder: &mut SceneBuilder, document: &Document) -> Option<()> {
    let item = document.item("camera")?;
    let pinhole = (Shift::default(), NonNegative::default(), None);
    let (projection, common) = match item.read(&mut builder.report)? {
        CameraFile::Perspective {
            position,
            target,
            up,
            fov,
            fov_axis: axis,
            focal_length,
            sensor,
            shift,
            aperture,
            focus,
        } => {
            let fov_degrees =
                field_of_view(&mut builder.report, item, fov, axis, focal_length, sensor)?;
            let common = Common { position, target, up, shift, aperture, focus };
            (Projection::Perspective { fov_degrees, axis }, common)
        }
        CameraFile::Orthographic {
            position,
            target,
            up,
            size,
            fov_axis: axis,
            shift,
            aperture,
            focus,
        } => {
            let common = Common { position, target, up, shift, aperture, focus };
            (Projection::Orthographic { size: size.0, axis }, common)
        }
        CameraFile::Panorama { position, target, up } => {
            let (shift, aperture, focus) = pinhole;
            (Projection::Panorama, Common { position, target, up, shift, aperture, focus })
        }
        CameraFile::Fisheye { position, target, up, fov, fov_axis: axis } => {
            let (shift, aperture, focus) = pinhole;
            let common = Common { position, target, up, shift, aperture, focus };
            (Projection::Fisheye { fov_degrees: fov, axis }, common)
        }
    };
    let (position, target) = (DVec3::from(common.position), DVec3::from(common.target));
    let distance = (target - position).length();
    let camera = Camera {
        position,
        target,
        up: DVec3::from(common.up),
        projection,
        shift: common.shift.0.map(|fraction| fraction.0),
        aperture: common.aperture.0,
        focus: common.focus.map_or(distance, f64::from),
    };
    builder.set_camera(item, camera);
    if camera.aperture > 0.0 && common.focus.is_none() {
        let message = "`focus` is missing: a lens with an aperture needs it";
        let help = format!("to focus on the target, write focus = {distance:.6}");
        let label = "expected a `focus` as well";
        builder.report.error(item.span_of("aperture"), message, label, Some(help));
    }
    Some(())
}

/// Field of view in degrees, from `fov` or from the focal length and the sensor.
fn field_of_view(
    report: &mut Report,
    item: &Item,
    fov: Option<f64>,
    axis: Axis,
    focal_length: Option<Positive>,
    sensor: Option<Positive>,
) -> Option<f64> {
    let either = "write either fov, or focal_length with or without sensor";
    match (fov, focal_length) {
        (None, None) => {
            let message = format!("`fov` is missing in {}", item.place());
            let label = "expected `fov`, a number greater than 0 and less than 180, or \
                         `focal_length`"
                .to_owned();
            let help = "Field of view in degrees; focal length in millimetres".to_owned();
            report.missing(item.span(), message, label, Some(help));
            None
        }
        (Some(_), Some(_)) => {
            let message = "`fov` and `focal_length` exclude each other";
            report.error(
                item.span_of("focal_length"),
                message,
                "expected one",
                Some(either.into()),
            );
            None
        }
        (Some(fov), None) => {
            if sensor.is_some() {
                let message = "`sensor` without `focal_length` has no effect";
                let label = "expected a `focal_length`";
                report.error(item.span_of("sensor"), message, label, Some(either.into()));
            }
            Some(fov)
        }
        (None, Some(length)) => {
            let size = sensor.map_or(axis.full_frame(), f64::from);
            let degrees = (2.0 * (0.5 * size).atan2(length.0)).to_degrees();
            if degrees > 0.0 && degrees < 180.0 {
                return Some(degrees);
            }
            let message =
                format!("`focal_length` = {:e} gives a view of {degrees} degrees", length.0);
            let label = "expected a field of view between 0 and 180 degrees";
            report.error(item.span_of("focal_length"), message, label, None);
            None
        }
    }
}
