//! Normalization: moves a scene to its own center and to a scale near one before rounding to f32.
//! Outputs undo it.

pub use crate::scene::extent;
use crate::scene::{Scene, ShapeKind};
use glam::DVec3;

/// Size ratio of giant shapes to the camera's surroundings and all smaller shapes. Giant shapes do
/// not affect the scene's size.
const GIANT: f64 = 64.0;
/// Distance of the horizon of infinite planes, relative to the radius of the region seen by the
/// camera.
const HORIZON: f64 = 1e4;

/// Maps a world point p to `(p - center) / unit` in scene space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalization {
    /// World point at the origin of scene space.
    pub center: DVec3,
    /// World units per scene unit, a power of two: scaling a scene by two changes no bit.
    pub unit: f64,
    /// Radius, in world units, of the sphere about `center` for which this normalization was
    /// chosen.
    pub radius: f64,
}

impl Normalization {
    /// Normalization for the camera's surroundings and all shapes except giant ones. This first
    /// guess affects only the rounding of numbers. A scene may contain objects far from the region
    /// seen by the camera; [`Self::suits`] checks the guess.
    pub fn of(scene: &Scene) -> Self {
        let mut boxes: Vec<(DVec3, DVec3)> =
            scene.shapes.iter().filter_map(|s| extent(&s.kind)).collect();
        boxes.sort_by(|a, b| a.1.distance_squared(a.0).total_cmp(&b.1.distance_squared(b.0)));
        let camera = &scene.camera;
        let aim = camera.position + (camera.target - camera.position).normalize() * camera.focus;
        let mut low = camera.position.min(camera.target).min(aim);
        let mut high = camera.position.max(camera.target).max(aim);
        for (a, b) in &boxes {
            if a.distance(*b) <= GIANT * low.distance(high) {
                low = low.min(*a);
                high = high.max(*b);
            }
        }
        Self::about(0.5 * (low + high), 0.5 * low.distance(high))
    }

    /// Normalization for a sphere, in world space.
    pub fn about(center: DVec3, radius: f64) -> Self {
        Self { center, unit: radius.log2().ceil().exp2(), radius }
    }

    /// Returns whether f32 has enough precision, in scene space, for a sphere with this world
    /// center and radius.
    pub fn suits(&self, center: DVec3, radius: f64) -> bool {
        const SLACK: f64 = 16.0;
        let off = center.distance(self.center);
        off <= SLACK * radius && radius >= self.unit / (2.0 * SLACK) && radius <= self.unit * SLACK
    }

    /// Converts a world point to scene space.
    pub fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    /// Converts a point in scene space to world space.
    pub fn world(&self, p: DVec3) -> DVec3 {
        p * self.unit + self.center
    }
}

/// Distance from `center` to the farthest point of any shape; planes count as 10^4 times `radius`.
pub fn reach(scene: &Scene, center: DVec3, radius: f64) -> f64 {
    let planes = scene.shapes.iter().any(|s| matches!(s.kind, ShapeKind::Plane { .. }));
    let boxes = scene.shapes.iter().filter_map(|s| extent(&s.kind));
    let corner = |(a, b): (DVec3, DVec3)| (a - center).abs().max((b - center).abs()).length();
    boxes.map(corner).fold(if planes { HORIZON * radius } else { 0.0 }, f64::max)
}
