//! Axis-aligned boxes (host side only).

use super::math::FAR;
use super::real::{Real, ToDouble, Vec3};
use glam::DVec3;

/// A closed box; empty when a component of `min` exceeds that of `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// Holds nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb { min: Vec3::splat(FAR), max: Vec3::splat(-FAR) };

    /// The smallest box that holds all `points`.
    #[inline]
    pub fn of_points(points: &[Vec3]) -> Aabb {
        points.iter().fold(Aabb::EMPTY, |b, &p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box that holds both.
    #[inline]
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What both hold; may be empty.
    #[inline]
    pub fn intersection(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether the box holds no point.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Half the surface area, in squared scene units; 0 when empty.
    #[inline]
    pub fn half_area(self) -> f64 {
        let d = (self.max.to_double() - self.min.to_double()).max(DVec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// The parts at and below, and at and above, the plane `axis = position`, which must lie
    /// inside.
    #[inline]
    pub fn split(self, axis: usize, position: Real) -> (Aabb, Aabb) {
        let (mut low, mut high) = (self, self);
        low.max[axis] = position;
        high.min[axis] = position;
        (low, high)
    }
}
