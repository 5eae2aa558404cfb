//! Rays that meet and leave convex shapes at grazing angles.

use caustica::low_level::math::offset_origin;
use caustica::low_level::prepare::normalize::Normalization;
use caustica::low_level::shapes::ray::Ray;
use glam::DVec3;

use super::bench::{Bench, parse};
use super::rays::ray;
use super::table::{Figure, Row};
use crate::brute_force::Rng;

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "grazing angles to 1e-6: the point",
            how: "Every kind of shape is met at angles of 1e-6 to 1 with its surface. Distance of the point found from the \
                  true surface, in f64, over the bound that the hit states.",
            unit: "error bounds",
            bound: 1.0,
            measure: |b| grazing(b).0,
        },
        Row {
            name: "grazing angles to 1e-6: leaving",
            how: "A ray that leaves each of these points at an angle of 1e-6 to 1, away from the convex shape, must not \
                  meet the shape again.",
            unit: "rays that meet what they leave",
            bound: 0.0,
            measure: |b| grazing(b).1,
        },
    ]
}

/// A convex shape and its exact surface.
struct Body {
    toml: &'static str,
    /// A point of the surface and its outward normal, from three numbers in [-1, 1].
    at: fn(DVec3) -> (DVec3, DVec3),
    /// Distance from the surface, near it.
    distance: fn(DVec3) -> f64,
}

const TILT: DVec3 = DVec3::new(0.36, 0.48, 0.8);

fn bodies() -> Vec<Body> {
    let tilted = |u: DVec3| {
        let (a, b) = TILT.any_orthonormal_pair();
        (DVec3::new(0.3, 0.2, -0.1) + (a * u.x + b * u.y) * 0.5, TILT)
    };
    let off_tilted = |p: DVec3| (p - DVec3::new(0.3, 0.2, -0.1)).dot(TILT).abs();
    vec![
        Body {
            toml: "type = \"plane\"\npoint = [0.3, 0.2, -0.1]\nnormal = [0.36, 0.48, 0.8]",
            at: tilted,
            distance: off_tilted,
        },
        Body {
            toml: "type = \"disc\"\ncenter = [0.3, 0.2, -0.1]\nnormal = [0.36, 0.48, 0.8]\n\
                   radius = 1.5",
            at: tilted,
            distance: off_tilted,
        },
        Body {
            toml: "type = \"rectangle\"\norigin = [-1, -0.25, -1]\nu = [0, 0, 2]\nv = [2, 1, 0]",
            at: |u| {
                let n = DVec3::new(-1.0, 2.0, 0.0).normalize();
                (DVec3::new(u.x * 0.5, 0.25 + u.x * 0.25, u.y * 0.5), n)
            },
            distance: |p| (p - DVec3::Y * 0.25).dot(DVec3::new(-1.0, 2.0, 0.0).normalize()).abs(),
        },
        Body {
            toml: "type = \"box\"\nmin = [-0.7, -0.6, -0.8]\nmax = [0.9, 0.5, 0.4]",
            at: |u| (DVec3::new(u.x * 0.5, 0.5, u.y * 0.3), DVec3::Y),
            distance: |p| (p.y - 0.5).abs().min((p.x - 0.9).abs()).min((p.z - 0.4).abs()),
        },
        Body {
            toml: "type = \"sphere\"\ncenter = [0.2, 0.1, -0.3]\nradius = 0.8",
            at: |u| {
                let n = (u + DVec3::new(0.0, 1e-3, 0.0)).normalize();
                (DVec3::new(0.2, 0.1, -0.3) + n * 0.8, n)
            },
            distance: |p| ((p - DVec3::new(0.2, 0.1, -0.3)).length() - 0.8).abs(),
        },
        Body {
            toml: "type = \"revolution\"\nprofile = [[0.5, 0.0], [0.0, 1.0]]",
            at: |u| {
                let (s, c) = (3.1 * u.x).sin_cos();
                let t = 0.5 + 0.4 * u.y;
                let r = 0.5 * (1.0 - t);
                (DVec3::new(r * c, t, r * s), DVec3::new(2.0 * c, 1.0, 2.0 * s).normalize())
            },
            distance: |p| ((p.x.hypot(p.z) - 0.5 * (1.0 - p.y)) * (0.8f64).sqrt()).abs(),
        },
    ]
}

/// Largest distance from the surface of points found at grazing incidence, in error bounds, and the
/// number of rays that meet the surface they leave.
fn grazing(b: &Bench) -> (Figure, Figure) {
    let mut rng = Rng(17);
    let (mut worst, mut again, mut met, mut all) = (0.0f64, 0, 0, 0);
    for body in bodies() {
        let text = format!(
            "version = 1\n[camera]\nposition = [2, 1.5, 3]\ntarget = [0, 0.2, 0]\nfov = 40\n\
             [film]\nwidth = 8\nheight = 8\n\
             [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[shapes]]\n{}\n\
             material = \"m\"\n",
            body.toml
        );
        let n = Normalization::of(&parse(&text));
        let packed = b.packed(&text);
        let angle = |rng: &mut Rng| 10f64.powf(3.0 * f64::from(rng.signed()) - 3.0);
        let rays: Vec<Ray> = (0..b.samples(20_000, 200_000))
            .map(|_| {
                let (p, normal) = (body.at)(rng.point().as_dvec3());
                let (s, c) = angle(&mut rng).sin_cos();
                let (e1, e2) = normal.any_orthonormal_pair();
                let (sin, cos) = (3.2 * f64::from(rng.signed())).sin_cos();
                let d = (e1 * cos + e2 * sin) * c - normal * s;
                ray(n.point(p - d * 0.3), d)
            })
            .collect();
        let found = b.trace(&packed.tables, &rays);
        all += rays.len();
        let mut leaving = Vec::new();
        for f in found.iter().filter(|f| f.is_hit()) {
            met += 1;
            let world = f.position.as_dvec3() * n.unit + n.center;
            worst = worst.max((body.distance)(world) / n.unit / f64::from(f.error));
            let normal = f.normal.as_dvec3();
            let (e1, e2) = normal.any_orthonormal_pair();
            let (sin, cos) = (3.2 * f64::from(rng.signed())).sin_cos();
            let (s, c) = angle(&mut rng).sin_cos();
            let d = ((e1 * cos + e2 * sin) * c + normal * s).normalize().as_vec3();
            if d.dot(f.normal) > 0.0 {
                let origin = offset_origin(f.position, f.error, f.normal, d);
                leaving.push(Ray { origin, t_min: 0.0, direction: d, t_max: 1e30 });
            }
        }
        again += b.trace(&packed.tables, &leaving).iter().filter(|f| f.is_hit()).count();
    }
    let note = format!("{met} of {all} rays, from 0.3 units away, meet the shape.");
    (Figure { value: worst, note }, (again as f64).into())
}
