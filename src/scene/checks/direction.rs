//! Directions.

use glam::DVec3;

use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;

/// Normalizes the direction under a key of a part; reports an error if its length is 0 or not
/// finite.
pub(crate) fn unit(
    report: &mut Report,
    part: &dyn Part,
    key: &str,
    direction: impl Into<DVec3>,
) -> Option<DVec3> {
    let unit = direction.into().try_normalize();
    if unit.is_none() {
        let message = format!("`{}.{key}` has no direction", part.place());
        let label = "expected a vector of a length that is neither 0 nor infinite";
        report.error(part.span_of(key), message, label, None);
    }
    unit
}
