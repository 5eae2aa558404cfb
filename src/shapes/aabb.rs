//! Axis-aligned bounding boxes (host only).

use super::math::FAR;
use super::real::{Real, ToDouble, Vec3};
use glam::DVec3;

/// Closed box; empty if a component of `min` exceeds that of `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// Empty box: the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb { min: Vec3::splat(FAR), max: Vec3::splat(-FAR) };

    /// Smallest box that contains all `points`.
    #[inline]
    pub fn of_points(points: &[Vec3]) -> Aabb {
        points.iter().fold(Aabb::EMPTY, |b, &p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Smallest box that contains both.
    #[inline]
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Intersection of both; may be empty.
    #[inline]
    pub fn intersection(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Returns true if the box contains no point.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Half the surface area, in squared scene units; 0 if the box is empty.
    #[inline]
    pub fn half_area(self) -> f64 {
        let d = (self.max.to_double() - self.min.to_double()).max(DVec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Splits the box at the plane `axis = position`, which must lie inside, into the lower and the
    /// upper part.
    #[inline]
    pub fn split(self, axis: usize, position: Real) -> (Aabb, Aabb) {
        let (mut low, mut high) = (self, self);
        low.max[axis] = position;
        high.min[axis] = position;
        (low, high)
    }
}
