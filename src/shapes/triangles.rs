//! Intersection of four triangles at a time, lane by lane by the operations of `triangle.rs`, so
//! the results are bit-identical. CPU engine only: on a GPU the lanes are rays.

use super::ray::{Hit, Ray};
use super::real::{Vec3, Vec4};
use super::triangle::{RayShear, Triangle, intersect_triangle, permuted};

const LANES: usize = 4;

/// Replaces `hit` by the nearest hit with the triangles whose indices are `references`, as if by
/// [`intersect_triangle`] with each in turn.
#[inline]
pub fn intersect_triangles(
    triangles: &[Triangle],
    references: &[u32],
    shear: &RayShear,
    ray: &Ray,
    hit: &mut Hit,
) {
    match shear.axis {
        0 => along::<0>(triangles, references, shear, ray, hit),
        1 => along::<1>(triangles, references, shear, ray, hit),
        _ => along::<2>(triangles, references, shear, ray, hit),
    }
}

/// Four vectors in the ray's space as a structure of arrays.
struct Lanes {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

/// Shears one vertex of each triangle into the ray's space; `AXIS` is the axis of the shear.
#[inline(always)]
fn sheared<const AXIS: u32>(corner: [&Vec3; LANES], origin: &Lanes, slope: &Lanes) -> Lanes {
    let [a, b, c, d] = corner;
    let (a, b, c, d) =
        (permuted(*a, AXIS), permuted(*b, AXIS), permuted(*c, AXIS), permuted(*d, AXIS));
    let x = Vec4::new(a.x, b.x, c.x, d.x) - origin.x;
    let y = Vec4::new(a.y, b.y, c.y, d.y) - origin.y;
    let z = Vec4::new(a.z, b.z, c.z, d.z) - origin.z;
    Lanes { x: x - slope.x * z, y: y - slope.y * z, z: slope.z * z }
}

#[inline(always)]
fn splat(v: Vec3) -> Lanes {
    Lanes { x: Vec4::splat(v.x), y: Vec4::splat(v.y), z: Vec4::splat(v.z) }
}

/// [`intersect_triangles`] for one axis, so that the permutation is resolved at compile time.
fn along<const AXIS: u32>(
    triangles: &[Triangle],
    references: &[u32],
    shear: &RayShear,
    ray: &Ray,
    hit: &mut Hit,
) {
    let origin = splat(permuted(ray.origin, AXIS));
    let slope = splat(shear.shear);
    for references in references.chunks(LANES) {
        // the last reference fills the unused lanes
        let last = references.len() - 1;
        let t0 = &triangles[references[0] as usize];
        let t1 = &triangles[references[1.min(last)] as usize];
        let t2 = &triangles[references[2.min(last)] as usize];
        let t3 = &triangles[references[last] as usize];
        let a = sheared::<AXIS>([&t0.p0, &t1.p0, &t2.p0, &t3.p0], &origin, &slope);
        let b = sheared::<AXIS>([&t0.p1, &t1.p1, &t2.p1, &t3.p1], &origin, &slope);
        let c = sheared::<AXIS>([&t0.p2, &t1.p2, &t2.p2, &t3.p2], &origin, &slope);
        // edge functions
        let (cb0, cb1) = (c.x * b.y, c.y * b.x);
        let (ac0, ac1) = (a.x * c.y, a.y * c.x);
        let (ba0, ba1) = (b.x * a.y, b.y * a.x);
        let (u, v, w) = (cb0 - cb1, ac0 - ac1, ba0 - ba1);
        let outside = u.min(v).min(w).cmplt(Vec4::ZERO) & u.max(v).max(w).cmpgt(Vec4::ZERO);
        let within = !outside.bitmask() & ((1 << references.len()) - 1);
        if within == 0 {
            continue;
        }
        let det = u + v + w;
        let products =
            cb0.abs().max(cb1.abs()).max(ac0.abs()).max(ac1.abs()).max(ba0.abs()).max(ba1.abs());
        let thin = det.abs().cmplt(products * 0.5).bitmask();
        // if det is 0, t is NaN and fails both comparisons
        let t = (u * a.z + v * b.z + w * c.z) / det;
        let nearer = t.cmpgt(Vec4::splat(ray.t_min)) & t.cmplt(Vec4::splat(hit.t));
        // keep the nearest hit; thin triangles go through the exact single test
        let mut lanes = (nearer.bitmask() | thin) & within;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let reference = references[lane];
            if thin >> lane & 1 != 0 {
                intersect_triangle(&triangles[reference as usize], reference, shear, ray, hit);
            } else if t.to_array()[lane] < hit.t {
                let det = det.to_array()[lane];
                *hit = Hit {
                    t: t.to_array()[lane],
                    reference,
                    u: (v.to_array()[lane] / det).abs(),
                    v: (w.to_array()[lane] / det).abs(),
                    ..*hit
                };
            }
        }
    }
}
