//! The triangle test on its own: accuracy, error bounds, and no hit of the triangle that a ray
//! leaves.

use crate::brute_force::*;
use caustica::low_level::math::unit;
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::shapes::triangle::*;
use caustica::low_level::shapes::triangles::intersect_triangles;
use glam::{DVec3, Vec3};

fn trace(t: &[Vec3; 3], ray: &Ray) -> Hit {
    let mut hit = Hit::none(ray);
    intersect_triangle(&triangle(*t), 0, &RayShear::new(ray), ray, &mut hit);
    hit
}

/// Makes triangles of every size and slimness near the origin.
fn random_triangle(rng: &mut Rng) -> [Vec3; 3] {
    let size = 10f32.powf(1.5 * rng.signed() - 1.5);
    let slim = if rng.below(2) == 0 { 1.0 } else { 10f32.powf(3.0 * rng.signed() - 3.0) };
    let (p, d) = (rng.point(), rng.point() * size);
    [p, p + d, p + d * rng.signed() + rng.point() * (size * slim)]
}

fn inside(t: &[Vec3; 3], rng: &mut Rng) -> Vec3 {
    let (mut u, mut v) = (rng.signed().abs(), rng.signed().abs());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v
}

fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let d = b - a;
    let s = if d.length_squared() > 0.0 {
        ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p - a - d * s).length()
}

fn distance_to_triangle(p: DVec3, t: &[Vec3; 3]) -> f64 {
    let [a, b, c] = t.map(|p| p.as_dvec3());
    let n = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if n.length() > 0.0 && sides.iter().all(|(a, b)| n.cross(*b - *a).dot(p - *a) >= 0.0) {
        return (p - a).dot(n.normalize()).abs();
    }
    sides.iter().map(|(a, b)| distance_to_segment(p, *a, *b)).fold(f64::MAX, f64::min)
}

/// Theory: the point at the computed t lies within about 30 roundings (of the largest coordinate
/// relative to the origin) of the triangle, however slim or edge-on it is. The traversal's slack of
/// 64 relies on that.
#[test]
fn hits_lie_on_the_triangle() {
    let mut rng = Rng(31);
    let rounding = 2f64.powi(-24);
    let (mut worst, mut worst_planted, mut hits) = (0f64, 0f64, 0);
    for i in 0..1_000_000 {
        let t = random_triangle(&mut rng);
        let origin = rng.point() * 2.0;
        // Half of the rays are edge-on: in the triangle's plane up to rounding.
        let aim = inside(&t, &mut rng);
        let d =
            if i % 2 == 0 { aim - origin } else { inside(&t, &mut rng) - aim + rng.point() * 1e-7 };
        if d.length_squared() < 1e-20 {
            continue;
        }
        let origin = if i % 2 == 0 { origin } else { aim - unit(d) * rng.signed().abs() };
        let ray = Ray { origin, t_min: -1e30, direction: unit(d), t_max: 1e30 };
        let hit = trace(&t, &ray);
        if hit.reference != NONE {
            hits += 1;
            let reach = t.iter().map(|p| (*p - origin).abs().max_element()).fold(0.0, f32::max);
            let off = |t_hit: f64| {
                let p = origin.as_dvec3() + ray.direction.as_dvec3() * t_hit;
                distance_to_triangle(p, &t) / (f64::from(reach) * rounding)
            };
            worst = worst.max(off(f64::from(hit.t)));
            worst_planted = worst_planted.max(off(f64::from(hit.t) * (1.0 + 1e-5)));
        }
    }
    println!("{hits} hits, worst {worst:.1} roundings off the triangle");
    assert!(hits > 100_000);
    assert!(worst < 30.0);
    assert!(worst_planted > 30.0, "planted: t off by 1e-5");
}

/// Theory: on triangles seen from the front, hit or miss and t are those of exact arithmetic. The
/// test omits rays within a few roundings of an edge.
#[test]
fn agrees_with_f64() {
    let mut rng = Rng(33);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..500_000 {
        let t = [rng.point(), rng.point(), rng.point()];
        let origin = rng.point() * 3.0;
        let ray = Ray { origin, t_min: 0.0, direction: unit(rng.point() - origin), t_max: 1e30 };
        let [a, b, c] = t.map(|p| p.as_dvec3() - origin.as_dvec3());
        let d = ray.direction.as_dvec3();
        let n = (b - a).cross(c - a);
        if n.dot(d).abs() < 1e-2 {
            continue;
        }
        let volumes = [c.cross(b).dot(d), a.cross(c).dot(d), b.cross(a).dot(d)];
        if volumes.iter().any(|v| v.abs() < 1e-5) {
            continue;
        }
        let distance = n.dot(a) / n.dot(d);
        let expected = distance > 0.0
            && (volumes.iter().all(|v| *v > 0.0) || volumes.iter().all(|v| *v < 0.0));
        let hit = trace(&t, &ray);
        assert_eq!(hit.reference != NONE, expected, "{t:?} {ray:?}");
        if expected {
            hits += 1;
            let sum: f64 = volumes.iter().sum();
            assert!(
                (f64::from(hit.t) - distance).abs() < 1e-4 * distance.max(1.0),
                "{hit:?} {distance}"
            );
            assert!((f64::from(hit.u) - volumes[1] / sum).abs() < 1e-3);
            assert!((f64::from(hit.v) - volumes[2] / sum).abs() < 1e-3);
        } else {
            misses += 1;
        }
    }
    assert!(hits > 10_000 && misses > 10_000);
}

/// Counts rays that start `offset` times the error bound above a hit and meet the triangle again.
fn met_again(offset: f32) -> usize {
    let mut rng = Rng(35);
    let mut count = 0;
    for _ in 0..500_000 {
        let t = random_triangle(&mut rng);
        let tri = triangle(t);
        let n = triangle_normal(&tri);
        let origin = rng.point() * 2.0;
        let ray =
            Ray { origin, t_min: 0.0, direction: unit(inside(&t, &mut rng) - origin), t_max: 1e30 };
        let hit = trace(&t, &ray);
        if hit.reference == NONE {
            continue;
        }
        let p = triangle_point(&tri, hit.u, hit.v);
        let exact = (t[1] - t[0]).as_dvec3().cross((t[2] - t[0]).as_dvec3());
        if exact.length() == 0.0 {
            continue;
        }
        let off = exact.normalize().dot(p.as_dvec3() - t[0].as_dvec3()).abs();
        assert!(off <= f64::from(triangle_error(&tri)) * 6.0 / 16.0, "{off:e}");
        // From grazing to upright.
        let up = 10f32.powf(4.0 * rng.signed() - 4.0);
        let mut d = rng.direction();
        d += n * (up - d.dot(n));
        if d.dot(n) <= 0.0 || d.as_dvec3().dot(exact) <= 0.0 {
            continue;
        }
        let leaving = Ray {
            origin: p + n * (offset * triangle_error(&tri)),
            t_min: 0.0,
            direction: unit(d),
            t_max: 1e30,
        };
        count += usize::from(trace(&t, &leaving).reference != NONE);
    }
    count
}

/// Theory: a hit's point is off the plane by less than the bound, so a ray that starts above it by
/// the bound and leads away does not meet the triangle.
#[test]
fn rays_do_not_meet_what_they_leave() {
    assert_eq!(met_again(1.0), 0);
    assert!(met_again(0.0) > 0, "planted: no offset");
}

/// Theory: the normal is perpendicular to both sides, of length one, and on the side from which p0,
/// p1, p2 turn counter-clockwise.
#[test]
fn normals() {
    let mut rng = Rng(37);
    for _ in 0..10_000 {
        let t = [rng.point(), rng.point(), rng.point()];
        let n = triangle_normal(&triangle(t)).as_dvec3();
        let (a, b) = ((t[1] - t[0]).as_dvec3(), (t[2] - t[0]).as_dvec3());
        let area = a.cross(b).length();
        assert!((n.length() - 1.0).abs() < 1e-6);
        assert!(n.dot(a.cross(b)) > 0.99 * area || area < 1e-4);
    }
    let unit_triangle = triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(triangle_normal(&unit_triangle), Vec3::Z);
    assert_eq!(triangle_point(&unit_triangle, 0.25, 0.5), Vec3::new(0.25, 0.5, 0.0));
}

/// Triangles that exercise every branch: near and far, thin, repeated, and without area.
fn crowd(rng: &mut Rng) -> Vec<Triangle> {
    let mut out: Vec<Triangle> = Vec::new();
    for _ in 0..200 {
        let t = match rng.below(6) {
            0 if !out.is_empty() => out[rng.below(out.len())],
            1 => triangle([rng.point(); 3]),
            2 => triangle([rng.point(), Vec3::ZERO, rng.point()]),
            _ => triangle(random_triangle(rng)),
        };
        out.push(t);
    }
    out
}

/// Counts rays for which four triangles at a time give other bits, including ties, than one after
/// the other.
fn differences(one: &[Triangle], many: &[Triangle], rng: &mut Rng) -> usize {
    (0..20_000)
        .filter(|_| {
            let references: Vec<u32> =
                (0..1 + rng.below(11)).map(|_| rng.below(one.len()) as u32).collect();
            let t = &one[references[rng.below(references.len())] as usize];
            let aim = if rng.below(3) == 0 { t.p1 } else { inside(&[t.p0, t.p1, t.p2], rng) };
            let mut d = aim - rng.point() * 2.0;
            if rng.below(8) == 0 {
                d[rng.below(3)] = 0.0;
            }
            let ray = Ray { origin: aim - d, t_min: 0.0, direction: unit(d), t_max: 3.0 };
            let shear = RayShear::new(&ray);
            let (mut first, mut second) = (Hit::none(&ray), Hit::none(&ray));
            for &r in &references {
                intersect_triangle(&one[r as usize], r, &shear, &ray, &mut first);
            }
            intersect_triangles(many, &references, &shear, &ray, &mut second);
            bytemuck::bytes_of(&first) != bytemuck::bytes_of(&second)
        })
        .count()
}

/// Theory: each lane executes the operations of the single-triangle test, and lanes are combined in
/// their order.
#[test]
fn four_at_a_time_give_the_same_bits() {
    let mut rng = Rng(39);
    let mut moved = 0;
    for _ in 0..20 {
        let mesh = crowd(&mut rng);
        assert_eq!(differences(&mesh, &mesh, &mut rng), 0);
        let mut other = mesh.clone();
        other.iter_mut().for_each(|t| t.p2.y = t.p2.y.next_up());
        moved += differences(&mesh, &other, &mut rng);
    }
    assert!(moved > 1000, "planted: one corner moved by a rounding");
}
