//! Checks of lights without a surface.

use crate::scene::Light;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;

/// Smallest diameter of a sun's disc, degrees.
const NARROWEST_SUN: f64 = 0.001;

/// Reports a spot light without a direction and a sun that is too narrow, and warns about a light
/// without power.
pub(crate) fn light(report: &mut Report, part: &dyn Part, light: &Light) {
    let (power_key, power) = match light {
        Light::Point { intensity, .. } => ("intensity", intensity),
        Light::Spot { position, target, intensity, .. } => {
            if position == target {
                let message = format!("the target of {} is its position", part.place());
                report.error(part.span_of("target"), message, "expected another point", None);
            }
            ("intensity", intensity)
        }
        Light::Sun { irradiance, angle_degrees, .. } => {
            if *angle_degrees > 0.0 && *angle_degrees < NARROWEST_SUN {
                let message = format!(
                    "`{}.angle` = {angle_degrees:e} is too narrow for single precision",
                    part.place()
                );
                let label = format!("expected 0, or at least {NARROWEST_SUN} degrees");
                report.error(part.span_of("angle"), message, label, None);
            }
            ("irradiance", irradiance)
        }
    };
    if power.iter().all(|&channel| channel == 0.0) {
        let message = format!("{} emits no light", part.place());
        report.warn(part.span_of(power_key), message, "zero in every channel");
    }
}
