//! Conversion of cylinders and cones to surfaces of revolution with straight profiles.

use glam::{DMat3, DVec2, DVec3};

use super::document::Item;
use super::file::Vec3;
use super::numbers::Positive;
use crate::scene::diagnostics::Report;
use crate::scene::numbers::{LARGEST, SMALLEST};
use crate::scene::parts::Part;
use crate::scene::{ShapeKind, Transform};

/// Keys that give the axis of a cylinder or cone: its height above the origin along the local y
/// axis, or the ends.
pub(super) struct Axis {
    pub height: Option<Positive>,
    pub p0: Option<Vec3>,
    pub p1: Option<Vec3>,
}

impl Axis {
    /// Height and transform of the surface of revolution, whose axis begins at the origin; reports
    /// an axis that is missing, given twice or without a length.
    fn placed(
        &self,
        report: &mut Report,
        item: &Item,
        after: &Transform,
    ) -> Option<(f64, Transform)> {
        let (p0, p1) = match (self.height, self.p0, self.p1) {
            (Some(height), None, None) => return Some((height.0, *after)),
            (None, Some(p0), Some(p1)) => (DVec3::from(p0), DVec3::from(p1)),
            (Some(_), _, _) => {
                let key = if self.p0.is_some() { "p0" } else { "p1" };
                let message = format!("{} has both a height and an end of its axis", item.place());
                let expected = "expected either `height`, or `p0` and `p1`";
                report.error(item.span_of(key), message, expected, None);
                return None;
            }
            (None, ..) => {
                let message = format!("{} lacks its axis", item.place());
                let help = Some("for example height = 1.0, or p0 and p1".to_owned());
                let expected = "expected `height`, or `p0` and `p1`".to_owned();
                report.missing(item.span(), message, expected, help);
                return None;
            }
        };
        let height = p0.distance(p1);
        if !(SMALLEST..=LARGEST).contains(&height) {
            let message = format!("`{}` is at a distance of {height:e} from `p0`", item.key("p1"));
            let expected = "expected another end of the axis";
            report.error(item.span_of("p1"), message, expected, None);
            return None;
        }
        let axis = rotation_of_y((p1 - p0) / height);
        let transform = Transform {
            scale: after.scale,
            rotation: after.rotation * axis,
            translation: after.point(p0),
        };
        Some((height, transform))
    }
}

/// The shortest rotation of the y axis into a unit vector (Rodrigues); for one that points
/// downward, the shortest one from -y, after half a turn about the x axis.
fn rotation_of_y(to: DVec3) -> DMat3 {
    if to.y < 0.0 {
        return rotation_of_y(-to) * DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    }
    let share = 1.0 / (1.0 + to.y);
    let mixed = -to.x * to.z * share;
    let x_axis = DVec3::new(1.0 - to.x * to.x * share, -to.x, mixed);
    let z_axis = DVec3::new(mixed, -to.z, 1.0 - to.z * to.z * share);
    DMat3::from_cols(x_axis, to, z_axis)
}

/// A frustum of a cone whose radius goes from `radii[0]` to `radii[1]` along its axis; `caps` close
/// its ends. Outside is the side away from the axis.
pub(super) fn frustum(
    report: &mut Report,
    item: &Item,
    axis: &Axis,
    radii: [f64; 2],
    caps: bool,
    transform: &Transform,
) -> Option<ShapeKind> {
    let (height, transform) = axis.placed(report, item, transform)?;
    let [start, end] = [DVec2::new(radii[0], 0.0), DVec2::new(radii[1], height)];
    let on_axis = |point: DVec2| DVec2::new(0.0, point.y);
    let mut segments = vec![vec![start, end]];
    if caps {
        segments.insert(0, vec![on_axis(start), start]);
        if end.x > 0.0 {
            segments.push(vec![end, on_axis(end)]);
        }
    }
    Some(ShapeKind::Revolution { segments, transform, newton_tolerance: 0.0 })
}
