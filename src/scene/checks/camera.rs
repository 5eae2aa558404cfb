//! Checks of the camera and the film.

use crate::scene::diagnostics::Report;
use crate::scene::limits::{Allowance, within};
use crate::scene::parts::Part;
use crate::scene::{Camera, Film, Projection};

/// Sine of the angle below which two directions count as parallel.
const LEAST_SINE: f64 = 1e-9;

/// Reports a camera without a view direction, or with an up direction that does not determine the
/// image's rotation.
pub(crate) fn camera(report: &mut Report, part: &dyn Part, camera: &Camera) {
    let (view, up) = (camera.target - camera.position, camera.up);
    if view.length() == 0.0 {
        let message = "the camera's target is its position";
        report.error(part.span_of("target"), message, "expected another point", None);
    } else if up.length() == 0.0 {
        let message = format!("`{}.up` has length 0", part.place());
        report.error(part.span_of("up"), message, "expected a direction", None);
    } else if view.normalize().cross(up.normalize()).length() < LEAST_SINE {
        let message = format!("`{}.up` is parallel to the view direction", part.place());
        let help = Some("turn it: [0, 0, -1] suits a camera that looks straight down".to_owned());
        report.error(part.span_of("up"), message, "expected another direction", help);
    }
    projection(report, part, camera);
}

/// Reports a lens or a shift that the projection does not have.
fn projection(report: &mut Report, part: &dyn Part, camera: &Camera) {
    let name = match camera.projection {
        Projection::Perspective { .. } | Projection::Orthographic { .. } => return,
        Projection::Panorama => "panorama",
        Projection::Fisheye { .. } => "fisheye",
    };
    for (key, wrong) in [("aperture", camera.aperture > 0.0), ("shift", camera.shift != [0.0; 2])] {
        if wrong {
            let message = format!("a {name} camera has no `{key}`");
            let help = "use a perspective or an orthographic camera, or leave it out";
            report.error(part.span_of(key), message, "expected 0", Some(help.to_owned()));
        }
    }
}

/// Reports an image with more pixels than the limits allow.
pub(crate) fn film(report: &mut Report, allowance: &Allowance, part: &dyn Part, film: &Film) {
    let pixels = u64::from(film.width) * u64::from(film.height);
    if let Err(refusal) = within("picture-pixels", "pixels", pixels, allowance.picture_pixels) {
        let message = format!("the image is too large: {refusal}");
        report.error(part.span_of("width"), message, "expected fewer pixels", refusal.help());
    }
}
