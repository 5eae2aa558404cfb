//! The camera.

use glam::DVec3;

/// A thin-lens camera; a pinhole when `aperture` is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the lens.
    pub position: DVec3,
    /// A point on the view axis, different from `position`.
    pub target: DVec3,
    /// Up direction of the image; not parallel to the view axis, not necessarily perpendicular or
    /// unit.
    pub up: DVec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov_degrees: f64,
    /// Lens radius in scene units, >= 0.
    pub aperture: f64,
    /// Distance of the plane of focus along the view axis in scene units, > 0; scene files default
    /// to `|target - position|`.
    pub focus: f64,
}

impl Camera {
    /// A pinhole camera at `position` that looks at `target`, with +y up and a vertical field of
    /// view in degrees.
    pub fn look_at(position: DVec3, target: DVec3, fov_degrees: f64) -> Self {
        let focus = position.distance(target);
        Self { position, target, up: DVec3::Y, fov_degrees, aperture: 0.0, focus }
    }
}
