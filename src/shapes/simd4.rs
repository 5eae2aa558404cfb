//! Intersection of four rectangles or spheres at a time, lane by lane by the operations of
//! `rectangle.rs` and `sphere.rs`, so the results are bit-identical. CPU engine only: on a GPU the
//! lanes are rays.

use super::ray::{Hit, Ray};
use super::real::{Real, Vec3, Vec4};
use super::rectangle::EDGE;
use super::table::{Rectangle, Sphere};

/// Number of shapes of one kind that are tested at once.
pub const LANES: usize = 4;

/// Four vectors as a structure of arrays.
#[derive(Clone, Copy, Debug)]
struct Vectors {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Vectors {
    fn of<T>(shapes: &[T], vector: impl Fn(&T) -> Vec3) -> Self {
        let numbers = |axis: usize| lanes(shapes, |shape| vector(shape)[axis]);
        Self { x: numbers(0), y: numbers(1), z: numbers(2) }
    }

    #[inline(always)]
    fn splat(v: Vec3) -> Self {
        Self { x: Vec4::splat(v.x), y: Vec4::splat(v.y), z: Vec4::splat(v.z) }
    }

    #[inline(always)]
    fn dot(&self, other: &Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    /// Returns the points at distance `t` along `direction`.
    #[inline(always)]
    fn along(&self, direction: &Self, t: Vec4) -> Self {
        Self {
            x: self.x + direction.x * t,
            y: self.y + direction.y * t,
            z: self.z + direction.z * t,
        }
    }
}

/// Gathers one number per shape; 0 in lanes without a shape.
fn lanes<T>(shapes: &[T], number: impl Fn(&T) -> Real) -> Vec4 {
    let mut numbers = [0.0; LANES];
    numbers.iter_mut().zip(shapes).for_each(|(place, shape)| *place = number(shape));
    numbers.into()
}

/// Up to four rectangles whose indices differ only in the last two bits.
#[derive(Clone, Copy, Debug)]
pub struct FourRectangles {
    origin: Vectors,
    normal: Vectors,
    dual_u: Vectors,
    dual_v: Vectors,
}

impl FourRectangles {
    /// Packs one to four rectangles.
    pub fn new(shapes: &[Rectangle]) -> Self {
        Self {
            origin: Vectors::of(shapes, |r| r.origin),
            normal: Vectors::of(shapes, |r| r.normal),
            dual_u: Vectors::of(shapes, |r| r.dual_u),
            dual_v: Vectors::of(shapes, |r| r.dual_v),
        }
    }

    /// Replaces `hit` by the nearest hit with the lanes in `mask`, as if by
    /// [`intersect_rectangle`](super::rectangle::intersect_rectangle) with each in turn. `first` is
    /// the reference of lane 0.
    #[inline(always)]
    pub fn intersect(&self, first: u32, mask: u32, ray: &Ray, hit: &mut Hit) {
        let direction = Vectors::splat(ray.direction);
        let d = Vectors::splat(ray.origin).minus(&self.origin);
        let slope = direction.dot(&self.normal);
        // if the slope is 0, t is infinite or NaN
        let t = -d.dot(&self.normal) / slope;
        let p = d.along(&direction, t);
        let s = p.dot(&self.dual_u);
        let r = p.dot(&self.dual_v);
        let (low, high) = (Vec4::splat(-EDGE), Vec4::splat(1.0 + EDGE));
        let inside = s.cmpge(low) & s.cmple(high) & r.cmpge(low) & r.cmple(high);
        let nearer = t.cmpgt(Vec4::splat(ray.t_min)) & t.cmplt(Vec4::splat(hit.t));
        let mut met = (inside & nearer).bitmask() & mask;
        while met != 0 {
            let lane = met.trailing_zeros();
            met &= met - 1;
            let k = lane as usize;
            if t.to_array()[k] < hit.t {
                let (u, v) = (s.to_array()[k], r.to_array()[k]);
                *hit = Hit { t: t.to_array()[k], reference: first | lane, u, v, ..*hit };
            }
        }
    }
}

/// Up to four spheres whose indices differ only in the last two bits.
#[derive(Clone, Copy, Debug)]
pub struct FourSpheres {
    anchor: Vectors,
    normal: Vectors,
    curvature: Vec4,
}

impl FourSpheres {
    /// Packs one to four spheres.
    pub fn new(shapes: &[Sphere]) -> Self {
        Self {
            anchor: Vectors::of(shapes, |s| s.anchor),
            normal: Vectors::of(shapes, |s| s.normal),
            curvature: lanes(shapes, |s| s.curvature),
        }
    }

    /// Replaces `hit` by the nearest hit with the lanes in `mask`, as if by
    /// [`intersect_sphere`](super::sphere::intersect_sphere) with each in turn. `first` is the
    /// reference of lane 0.
    #[inline(always)]
    pub fn intersect(&self, first: u32, mask: u32, ray: &Ray, hit: &mut Hit) {
        let k = self.curvature;
        let half_k = k * 0.5;
        let direction = Vectors::splat(ray.direction);
        let d0 = Vectors::splat(ray.origin).minus(&self.anchor);
        let side = d0.dot(&self.normal) + half_k * d0.dot(&d0);
        let backward = ray.t_min < 0.0;
        let upward = direction.dot(&self.normal);
        let leaving = upward + k * d0.dot(&direction);
        let outside = side.cmpge(Vec4::ZERO);
        let away = if backward { 0 } else { (outside & leaving.cmpge(Vec4::ZERO)).bitmask() };
        let t0 = -d0.dot(&direction);
        let d = d0.along(&direction, t0);
        let b = upward + k * d.dot(&direction);
        let c = d.dot(&self.normal) + half_k * d.dot(&d);
        let discriminant = b * b - k * 2.0 * c;
        let mask = mask & !away & !discriminant.cmplt(Vec4::ZERO).bitmask();
        if mask == 0 {
            return;
        }
        let root = Vec4::from(discriminant.to_array().map(Real::sqrt));
        let q = Vec4::select(b.cmpge(Vec4::ZERO), -(b + root), root - b);
        let t1 = q / k;
        let t2 = Vec4::select(q.cmpeq(Vec4::ZERO), t1, c * 2.0 / q);
        let near = t0 + t1.min(t2);
        let far = t0 + t1.max(t2);
        let from_outside = if backward { near.cmpgt(Vec4::splat(ray.t_min)) } else { outside };
        let t = Vec4::select(from_outside, near, far);
        let nearer = t.cmpgt(Vec4::splat(ray.t_min)) & t.cmplt(Vec4::splat(hit.t));
        let mut met = nearer.bitmask() & mask;
        while met != 0 {
            let lane = met.trailing_zeros();
            met &= met - 1;
            let t = t.to_array()[lane as usize];
            if t < hit.t {
                *hit = Hit { t, reference: first | lane, u: 0.0, v: 0.0, ..*hit };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::math::unit;
    use super::super::rectangle::intersect_rectangle;
    use super::super::sphere::intersect_sphere;
    use super::*;
    use bytemuck::Zeroable;

    /// Numbers in [-1, 1), one in eight of them 0.
    struct Random(u32);

    impl Random {
        fn number(&mut self) -> Real {
            self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let number = (self.0 >> 8) as Real / 8_388_608.0 - 1.0;
            if self.0 >> 29 == 0 { 0.0 } else { number }
        }

        fn vector(&mut self) -> Vec3 {
            Vec3::new(self.number(), self.number(), self.number())
        }

        fn ray(&mut self) -> Ray {
            let backward = self.number() > 0.7;
            Ray {
                origin: self.vector() * 2.0,
                t_min: if backward { -8.0 } else { 0.0 },
                direction: unit(self.vector() + Vec3::new(0.0, 0.0, 1e-3)),
                t_max: 1e30,
            }
        }

        fn rectangle(&mut self) -> Rectangle {
            let (u, v) = (self.vector() + Vec3::X * 1.5, self.vector() + Vec3::Y * 1.5);
            let normal = unit(u.cross(v));
            let (across_v, across_u) = (v.cross(normal), normal.cross(u));
            Rectangle {
                origin: self.vector() - 0.5 * (u + v),
                normal,
                dual_u: across_v / across_v.dot(u),
                dual_v: across_u / across_u.dot(v),
                ..Rectangle::zeroed()
            }
        }

        fn sphere(&mut self) -> Sphere {
            let normal = unit(self.vector() + Vec3::new(0.0, 1e-3, 0.0));
            let curvature = 1.0 / (0.75 + 0.5 * self.number());
            Sphere { anchor: self.vector(), normal, curvature, ..Sphere::zeroed() }
        }
    }

    /// Counts, over 20 000 rays, those for which `four` and `one` differ in any bit, and those that
    /// hit.
    fn compare<T>(
        make: impl Fn(&mut Random) -> T,
        four: impl Fn(&[T], u32, &Ray, &mut Hit),
        one: impl Fn(&T, u32, &Ray, &mut Hit),
    ) -> (u32, u32) {
        let mut random = Random(1);
        let (mut differ, mut met) = (0, 0);
        for i in 0..20_000 {
            let shapes: Vec<T> = (0..1 + i % 4).map(|_| make(&mut random)).collect();
            let mask = (i as u32 / 4 % 16) & ((1 << shapes.len()) - 1);
            let ray = random.ray();
            let mut hits =
                [Hit { t: if i % 3 == 0 { 1.0 } else { ray.t_max }, ..Hit::none(&ray) }; 2];
            four(&shapes, mask, &ray, &mut hits[0]);
            for (lane, shape) in (0..).zip(&shapes).filter(|(lane, _)| mask >> lane & 1 == 1) {
                one(shape, 8 | lane, &ray, &mut hits[1]);
            }
            let bits = hits.map(|h| (h.t.to_bits(), h.reference, h.u.to_bits(), h.v.to_bits()));
            differ += u32::from(bits[0] != bits[1]);
            met += u32::from(hits[1].reference != super::super::table::NONE);
        }
        (differ, met)
    }

    // Theory: each lane performs the operations of the single-shape test, and the nearest hit, the
    // first among equals, is kept. So every bit agrees, also for missing lanes, rays along an axis,
    // rays that start behind their origin, and rays that end before the shape.
    #[test]
    fn four_rectangles_are_one_by_one() {
        let four = |r: &[Rectangle], mask, ray: &Ray, hit: &mut Hit| {
            FourRectangles::new(r).intersect(8, mask, ray, hit);
        };
        let (differ, met) = compare(Random::rectangle, four, intersect_rectangle);
        assert!(differ == 0 && met > 1000, "{differ} of {met}");
        // the comparison detects a lane that is tested although `mask` excludes it
        let planted = |r: &[Rectangle], _, ray: &Ray, hit: &mut Hit| four(r, 15, ray, hit);
        assert!(compare(Random::rectangle, planted, intersect_rectangle).0 > 100);
    }

    #[test]
    fn four_spheres_are_one_by_one() {
        let four = |s: &[Sphere], mask, ray: &Ray, hit: &mut Hit| {
            FourSpheres::new(s).intersect(8, mask, ray, hit);
        };
        let (differ, met) = compare(Random::sphere, four, intersect_sphere);
        assert!(differ == 0 && met > 1000, "{differ} of {met}");
        let planted = |s: &[Sphere], _, ray: &Ray, hit: &mut Hit| four(s, 15, ray, hit);
        assert!(compare(Random::sphere, planted, intersect_sphere).0 > 100);
    }
}
