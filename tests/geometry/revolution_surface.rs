//! Newton's step, normals, boxes and error bounds of surfaces of revolution, each against its
//! definition.

use crate::revolution::oracle;
use crate::revolution::profiles::{Placed, place, profiles, skew};
use crate::revolution::rays::{Class, Random, curve, ray};
use caustica::low_level::accel::revolution::{
    Attributes, Placement, ProfileError, RevolutionTables,
};
use caustica::low_level::math::FAR;
use caustica::low_level::shapes::revolution::{intersect_patch, revolution_surface, ring_point};
use caustica::low_level::shapes::revolution_roots::newton_step;
use glam::{DMat3, DVec2, DVec3, Vec3, Vec4};

/// S(theta, tau) of a patch in f64 from the scene's own profile, in local units.
fn exact(placed: &Placed, patch: usize, theta: f64, tau: f64) -> DVec3 {
    let q = &placed.tables.patches[patch];
    let t = f64::from(q.t0) + (f64::from(q.t1) - f64::from(q.t0)) * tau;
    let (p, _) = curve(&placed.segments[q.segment as usize], t);
    DVec3::new(p.x * theta.cos(), p.y, p.x * theta.sin())
}

/// Whether the f32 range [t0, t1] of a patch determines `tau` within the segment to five digits.
fn wide(placed: &Placed, patch: usize) -> bool {
    let q = &placed.tables.patches[patch];
    q.t1 - q.t0 > 0.02
}

/// Columns dS/dtheta, dS/dtau by central differences.
fn differences(placed: &Placed, patch: usize, theta: f64, tau: f64) -> (DVec3, DVec3) {
    let e = 1e-5;
    let s = |a: f64, b: f64| exact(placed, patch, theta + a, tau + b);
    ((s(e, 0.0) - s(-e, 0.0)) / (2.0 * e), (s(0.0, e) - s(0.0, -e)) / (2.0 * e))
}

// Theory: Newton's step x solves J x = -f, where f = o + l d - S has the Jacobian J = (d, -S_theta,
// -S_tau).
#[test]
fn newton_step_solves_the_linear_system() {
    let mut random = Random(5);
    let mut checked = 0;
    for profile in profiles() {
        let placed = place(&profile, &Placement::default());
        for i in 0..2000 {
            let patch = i % placed.tables.patches.len();
            let (theta, tau) = (3.0 * random.signed(), 0.1 + 0.8 * random.next());
            let direction = random.direction();
            let f = random.ball() * 0.1;
            let (s_theta, s_tau) = differences(&placed, patch, theta, tau);
            let jacobian = DMat3::from_cols(direction, -s_theta, -s_tau);
            // Near the singular system any step is valid.
            if jacobian.determinant().abs() < 0.05 * s_theta.length() * s_tau.length()
                || s_theta.length() < 1e-3
                || !wide(&placed, patch)
            {
                continue;
            }
            let q = &placed.tables.patches[patch];
            let at = ring_point(&placed.tables.profile_points, q, theta as f32, tau as f32);
            let step = newton_step(direction.as_vec3(), f.as_vec3(), &at);
            let residual = |s: Vec4| {
                let x = DVec3::new(f64::from(s.x), f64::from(s.y), f64::from(s.z));
                (jacobian * x + f).length() / f.length()
            };
            assert!(residual(step) < 2e-3, "{}: {}", placed.name, residual(step));
            // Each wrong sign is detected: the residual is then twice that column's part.
            let flips = [
                Vec4::new(-1.0, 1.0, 1.0, 1.0),
                Vec4::new(1.0, -1.0, 1.0, 1.0),
                Vec4::new(1.0, 1.0, -1.0, 1.0),
            ];
            assert!(flips.iter().map(|&flip| residual(step * flip)).fold(0.0, f64::max) > 0.1);
            checked += 1;
        }
    }
    assert!(checked > 5000, "{checked}");
}

// Theory: the normal is that of the exact surface, -(S_theta x S_t) normalised where r > 0 (outward
// when the profile rises); v is (segment + t) / segments and u = 1/2 - theta / 2 pi.
#[test]
fn normals_and_uv_are_the_surfaces() {
    let mut random = Random(6);
    for profile in profiles() {
        let placed = place(&profile, &skew());
        let t = &placed.tables;
        let axes = [t.revolutions[0].x_axis, t.revolutions[0].y_axis, t.revolutions[0].z_axis];
        for i in 0..2000 {
            let patch = i % t.patches.len();
            let q = &t.patches[patch];
            let (theta, tau) = (3.0 * random.signed(), 0.05 + 0.9 * random.next());
            let (s_theta, s_tau) = differences(&placed, patch, theta, tau);
            if s_theta.length() < 1e-3
                || s_tau.length() < 1e-3 * f64::from(q.length)
                || !wide(&placed, patch)
            {
                continue;
            }
            let normal = s_tau.cross(s_theta).normalize();
            let s = revolution_surface(
                &t.profile_points,
                &t.revolutions[0],
                q,
                theta as f32,
                tau as f32,
            );
            let found = axes.map(|a| f64::from(a.dot(s.normal)));
            let off = normal.distance(DVec3::from_array(found));
            assert!(off < 1e-4, "{} patch {patch} tau {tau}: {off}", placed.name);
            assert!((-normal).distance(DVec3::from_array(found)) > 1.0, "a turned normal is seen");
            let parameter = f64::from(q.t0) + (f64::from(q.t1) - f64::from(q.t0)) * tau;
            let v = (f64::from(q.segment) + parameter) / placed.segments.len() as f64;
            let u = (0.5 - theta / std::f64::consts::TAU).rem_euclid(1.0);
            assert!((f64::from(s.uv.y) - v).abs() < 1e-6 && (f64::from(s.uv.x) - u).abs() < 1e-6);
        }
    }
    // On the axis, where dS/dtheta is zero, the drop's bottom faces down and the cone's tip along
    // its side.
    let placed = place(&profiles()[4], &Placement::default());
    let t = &placed.tables;
    let s = revolution_surface(&t.profile_points, &t.revolutions[0], &t.patches[0], 0.7, 0.0);
    assert!(s.normal.distance(Vec3::NEG_Y) < 1e-6);
}

// Theory: every surface point lies in a box of its patch, and the patches of a segment cover all of
// [0, 1].
#[test]
fn boxes_enclose_the_surface() {
    let mut random = Random(8);
    for profile in profiles() {
        let placed = place(&profile, &skew());
        let t = &placed.tables;
        let inside = |patch: usize, p: Vec3, margin: f32| {
            let mut boxes = placed.boxes.iter().filter(|b| b.patch as usize == patch);
            boxes.any(|b| p.cmpge(b.min - margin).all() && p.cmple(b.max + margin).all())
        };
        let mut shrunk = 0;
        for i in 0..20_000 {
            let patch = i % t.patches.len();
            let q = &t.patches[patch];
            let (theta, tau) = (3.2 * random.signed(), random.next());
            let s = revolution_surface(
                &t.profile_points,
                &t.revolutions[0],
                q,
                theta as f32,
                tau as f32,
            );
            assert!(inside(patch, s.position, 0.0), "{} {patch} {theta} {tau}", placed.name);
            shrunk += u32::from(!inside(patch, s.position, -1e-3));
        }
        assert!(shrunk > 0, "boxes a thousandth smaller would not enclose it");
        for (segment, points) in placed.segments.iter().enumerate() {
            let mut spans: Vec<(f32, f32)> = t
                .patches
                .iter()
                .filter(|q| q.segment as usize == segment)
                .map(|q| (q.t0, q.t1))
                .collect();
            spans.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert!(spans[0].0 == 0.0 && spans[spans.len() - 1].1 == 1.0);
            // At a cusp a piece shorter than any rounding may be missing.
            let place = |t: f32| curve(points, f64::from(t)).0;
            let covered =
                |w: &[(f32, f32)]| w[1].0 <= w[0].1 || place(w[0].1).distance(place(w[1].0)) < 1e-8;
            assert!(spans.windows(2).all(covered), "{}: {spans:?}", placed.name);
        }
    }
}

// Theory: an origin moved off the hit by the error bound, to either side, lies on that side of the
// true surface. So a ray into that side does not meet the surface where it starts. The f64 solver
// determines its next hit.
#[test]
fn offset_origins_do_not_meet_their_own_surface() {
    let mut random = Random(9);
    let (mut checked, mut wrong, mut unmoved) = (0, 0, 0);
    for placement in [Placement::default(), skew()] {
        for profile in profiles() {
            let placed = place(&profile, &placement);
            let t = &placed.tables;
            let nearest = |o: Vec3, d: Vec3| {
                let mut best = (FAR, None);
                for q in &t.patches {
                    let hit =
                        intersect_patch(&t.profile_points, &t.revolutions[0], q, o, d, 0.0, best.0);
                    if hit.t < best.0 {
                        best = (hit.t, Some((q, hit)));
                    }
                }
                best.1
            };
            for _ in 0..3000 {
                let (o, d) = ray(&placed, Class::Random, &mut random);
                let Some((q, hit)) = nearest(o, d) else { continue };
                let s =
                    revolution_surface(&t.profile_points, &t.revolutions[0], q, hit.theta, hit.tau);
                let out = random.direction().as_vec3();
                let side = if out.dot(s.normal) > 0.0 { s.normal } else { -s.normal };
                if out.dot(side) < 0.02 {
                    continue;
                }
                let origin = s.position + side * s.error;
                let found = nearest(origin, out).map_or(f64::from(FAR), |(_, h)| f64::from(h.t));
                let (lo, ld) = oracle::local_ray(&t.revolutions[0], origin, out);
                let truth = oracle::all_hits(&placed.segments, lo, ld)
                    .first()
                    .map_or(f64::from(FAR), |h| h.t);
                // If the true hit is another one, it must be found; a hit close by is a
                // self-intersection.
                wrong +=
                    u32::from((found - truth).abs() > 1e-4 * f64::from(t.revolutions[0].scale));
                checked += 1;
                let still =
                    nearest(s.position, out).map_or(f64::from(FAR), |(_, h)| f64::from(h.t));
                unmoved += u32::from(still < 1e-5);
            }
        }
    }
    println!(
        "{checked} rays from hits: {wrong} wrong; without the offset {unmoved} meet their own surface"
    );
    assert!(checked > 10_000 && wrong * 10_000 <= checked);
    assert!(unmoved > 100, "the offset is needed");
}

#[test]
fn profiles_without_a_surface_are_refused() {
    let p = DVec2::new;
    let push = |segments: &[Vec<DVec2>]| {
        RevolutionTables::default()
            .push(segments, &Placement::default(), Attributes::default())
            .map(|b| b.len())
    };
    assert_eq!(push(&[vec![p(0.0, 0.0), p(0.0, 1.0)]]), Err(ProfileError::Empty));
    assert_eq!(push(&[vec![p(0.5, 0.5), p(0.5, 0.5)]]), Err(ProfileError::Empty));
    assert_eq!(push(&[]), Err(ProfileError::Empty));
    assert_eq!(push(&[vec![p(0.5, 0.5)]]), Err(ProfileError::Degree { segment: 0, points: 1 }));
    assert_eq!(push(&[vec![p(0.5, f64::INFINITY), p(0.5, 0.5)]]), Err(ProfileError::NotFinite));
    // A segment of zero length between two others is skipped.
    let (a, b, c) = (p(0.5, 0.0), p(0.5, 1.0), p(0.0, 1.0));
    assert!(push(&[vec![a, b], vec![b, b, b], vec![b, c]]).is_ok());
}
