//! Four rectangles or spheres at a time: lane by lane the operations of `rectangle.rs` and `sphere.rs`, and so the same
//! bits. Only the CPU engine has this; on a GPU the lanes are rays.

use super::ray::{Hit, Ray};
use super::real::{Real, Vec3, Vec4};
use super::rectangle::EDGE;
use super::tables::{Rectangle, Sphere};

/// Shapes of one kind that are tested at once.
pub const LANES: usize = 4;

/// Four vectors, each coordinate by itself.
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

    /// The points at `t` along `direction` from here.
    #[inline(always)]
    fn along(&self, direction: &Self, t: Vec4) -> Self {
        Self { x: self.x + direction.x * t, y: self.y + direction.y * t, z: self.z + direction.z * t }
    }
}

/// A number of each shape; 0 in lanes without one.
fn lanes<T>(shapes: &[T], number: impl Fn(&T) -> Real) -> Vec4 {
    let mut numbers = [0.0; LANES];
    numbers.iter_mut().zip(shapes).for_each(|(place, shape)| *place = number(shape));
    numbers.into()
}

/// Rectangles whose numbers differ in the last two bits only.
#[derive(Clone, Copy, Debug)]
pub struct FourRectangles {
    origin: Vectors,
    normal: Vectors,
    dual_u: Vectors,
    dual_v: Vectors,
}

impl FourRectangles {
    /// At most four.
    pub fn new(shapes: &[Rectangle]) -> Self {
        Self {
            origin: Vectors::of(shapes, |r| r.origin),
            normal: Vectors::of(shapes, |r| r.normal),
            dual_u: Vectors::of(shapes, |r| r.dual_u),
            dual_v: Vectors::of(shapes, |r| r.dual_v),
        }
    }

    /// Replaces `hit` by the nearest hit with those that `mask` names, as if by
    /// [`intersect_rectangle`](super::rectangle::intersect_rectangle) with each in turn. `first` is the reference of lane 0.
    #[inline(always)]
    pub fn intersect(&self, first: u32, mask: u32, ray: &Ray, hit: &mut Hit) {
        let direction = Vectors::splat(ray.direction);
        let d = Vectors::splat(ray.origin).minus(&self.origin);
        let slope = direction.dot(&self.normal);
        // where the slope is 0, t is infinite or no number
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
                *hit = Hit { t: t.to_array()[k], reference: first | lane, u, v };
            }
        }
    }
}

/// Spheres whose numbers differ in the last two bits only.
#[derive(Clone, Copy, Debug)]
pub struct FourSpheres {
    anchor: Vectors,
    normal: Vectors,
    curvature: Vec4,
}

impl FourSpheres {
    /// At most four.
    pub fn new(shapes: &[Sphere]) -> Self {
        Self {
            anchor: Vectors::of(shapes, |s| s.anchor),
            normal: Vectors::of(shapes, |s| s.normal),
            curvature: lanes(shapes, |s| s.curvature),
        }
    }

    /// Replaces `hit` by the nearest hit with those that `mask` names, as if by
    /// [`intersect_sphere`](super::sphere::intersect_sphere) with each in turn. `first` is the reference of lane 0.
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
                *hit = Hit { t, reference: first | lane, u: 0.0, v: 0.0 };
            }
        }
    }
}
