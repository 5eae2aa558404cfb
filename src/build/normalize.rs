//! Where the scene lies and how large it is: the move to its own centre and the scale near one that come before
//! anything turns into f32, undone on the way out.

use crate::scene::{Scene, ShapeKind};
use glam::DVec3;

/// Shapes more than this many times wider than what is smaller than they and the camera's surroundings do not
/// decide the scene's size.
const GIANT: f64 = 64.0;
/// What counts as far where a plane is infinite, over the scene's size.
const HORIZON: f64 = 1e4;

/// World point p lies at `(p - center) / unit` in scene space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalization {
    /// The world point that becomes the origin.
    pub center: DVec3,
    /// World units in one scene unit, a power of two: scaling a scene by two changes no bit.
    pub unit: f64,
    /// Radius, in scene units, of the sphere about the origin that holds all but giant shapes; at most one.
    pub near_radius: f64,
    /// Radius, in scene units, of the sphere that holds everything.
    pub far_radius: f64,
}

impl Normalization {
    /// Of a whole scene.
    pub fn of(scene: &Scene) -> Self {
        let mut boxes: Vec<(DVec3, DVec3)> = scene.shapes.iter().filter_map(|s| extent(&s.kind)).collect();
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
        let center = 0.5 * (low + high);
        let radius = 0.5 * low.distance(high);
        let unit = radius.log2().ceil().exp2();
        let planes = scene.shapes.iter().any(|s| matches!(s.kind, ShapeKind::Plane { .. }));
        let reach = |(a, b): &(DVec3, DVec3)| (*a - center).abs().max((*b - center).abs()).length();
        let far = boxes.iter().map(reach).fold(radius, f64::max);
        let far = if planes { far.max(HORIZON * radius) } else { far };
        Self { center, unit, near_radius: radius / unit, far_radius: far / unit }
    }

    /// A world point in scene space.
    pub fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }
}

/// Bounding box of a finite shape, world space.
pub fn extent(kind: &ShapeKind) -> Option<(DVec3, DVec3)> {
    let hull = |points: &[DVec3]| {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        (low, high)
    };
    Some(match kind {
        ShapeKind::Sphere { center, radius } | ShapeKind::Disc { center, radius, .. } => {
            (*center - DVec3::splat(*radius), *center + DVec3::splat(*radius))
        }
        ShapeKind::Rectangle { origin, u, v } => {
            hull(&[*origin, *origin + *u, *origin + *v, *origin + *u + *v])
        }
        ShapeKind::Cuboid { min, max } => (*min, *max),
        ShapeKind::Mesh(mesh) if mesh.positions.is_empty() => return None,
        ShapeKind::Mesh(mesh) => hull(&mesh.positions),
        ShapeKind::Revolution { segments, transform, .. } => {
            let points = || segments.iter().flatten();
            let r = points().map(|p| p.x.abs()).fold(0.0, f64::max);
            let bottom = points().map(|p| p.y).fold(f64::INFINITY, f64::min);
            let top = points().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
            let corners: Vec<DVec3> = (0..8)
                .map(|k| {
                    let side = |bit: u32| if k >> bit & 1 == 1 { r } else { -r };
                    let y = if k >> 1 & 1 == 1 { top } else { bottom };
                    transform.point(DVec3::new(side(0), y, side(2)))
                })
                .collect();
            hull(&corners)
        }
        ShapeKind::Plane { .. } => return None,
    })
}
