//! Checks of lights without a surface.

use crate::scene::Light;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;

/// Reports a spot light without a direction, and warns about a light without power.
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
        Light::Sun { irradiance, .. } => ("irradiance", irradiance),
    };
    if power.iter().all(|&channel| channel == 0.0) {
        let message = format!("{} emits no light", part.place());
        report.warn(part.span_of(power_key), message, "zero in every channel");
    }
}
