//! Surfaces of revolution of every kind against the f64 oracle.

use crate::revolution::judge::{Tally, judge};
use crate::revolution::profiles::{Placed, Profile, place, profiles, skew};
use crate::revolution::rays::{CLASSES, Class, Random, ray};
use bytemuck::Zeroable;
use caustica::low_level::accel::kdtree::{Primitive, build};
use caustica::low_level::accel::revolution::Placement;
use caustica::low_level::math::FAR;
use caustica::low_level::shapes::aabb::Aabb;
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::shapes::revolution::{BRACKETED, Patch, intersect_patch, patch_miss};
use caustica::low_level::tables::{KIND_REVOLUTION, SceneTables, reference};
use glam::{DVec2, Vec2, Vec3};
use rayon::prelude::*;

use super::bench::{Bench, parse_errors};
use super::table::{Figure, Row};

const WRONG: &str = "wrong hits per million rays";

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "revolutions of every form",
            how: "Cylinder, cone, paraboloid, vase, drop, undercut, wave of degree 15, bottle of five segments, cusp and near \
                  cusp, plain and turned: random rays, rays from inside, tangent ones within 2 % of the surface, ones along, \
                  through and square to the axis, and ones from 1000 sizes away, against the roots of the ray's polynomial in \
                  f64. Wrong is a hit that is missing, that is not there, or that is off by more than 1e-5 of distance or size and \
                  than four roundings of the ray explain.",
            unit: WRONG,
            bound: 10.0,
            measure: |b| wrong(b, &profiles(), &CLASSES),
        },
        Row {
            name: "revolutions with extreme points",
            how: "The same for tips on the axis, profiles that touch it in between, vertical and horizontal tangents, a \
                  segment of length zero, control points that coincide, and a tangent double root all along a circle.",
            unit: WRONG,
            bound: 10.0,
            measure: |b| wrong(b, &extreme_points(), &CLASSES),
        },
        Row {
            name: "revolutions of radius 1e-6 and 1e6",
            how: "The same for the surfaces of the first row at these sizes in a scene of size one.",
            unit: WRONG,
            bound: 10.0,
            measure: |b| {
                let at = |scale| {
                    tally(b, &profiles(), &CLASSES, &[Placement { scale, ..Placement::default() }])
                };
                reported(&at(1e-6).add(at(1e6)))
            },
        },
        Row {
            name: "needles and plates: radius over height 1e-3 to 1e6",
            how: "The same for a vase and a drop squeezed by 1e-3 or widened by 1e3 and 1e6.",
            unit: WRONG,
            bound: 10.0,
            measure: |b| {
                let figure = wrong(b, &squeezed(&[1e-3, 1e3, 1e6]), &CLASSES);
                let thin = wrong(b, &squeezed(&[1e-6]), &CLASSES);
                let note = format!(
                    "{} Squeezed by 1e-6 a surface is about one rounding of its place thin: {:.0} per million ({}); \
                     `check` warns.",
                    figure.note, thin.value, thin.note
                );
                Figure { note, ..figure }
            },
        },
        Row {
            name: "revolutions from 1e6 sizes away",
            how: "The same for rays from so far.",
            unit: WRONG,
            bound: 10.0,
            measure: |b| wrong(b, &profiles(), &[Class::VeryFar]),
        },
        Row {
            name: "revolutions: worst distance",
            how: "Greatest error of the distance among the hits of the first row that no rounding of the ray explains away.",
            unit: "of distance or size",
            bound: 1e-5,
            measure: |b| {
                let tally = tally(b, &profiles(), &CLASSES, &placements(b));
                Figure {
                    value: tally.worst_well,
                    note: format!(
                        "{} of {} hits are worse for rounding of the ray, by {:.1e} at most.",
                        tally.ill_conditioned, tally.hits, tally.worst
                    ),
                }
            },
        },
        Row {
            name: "revolutions: Newton's steps",
            how: "Steps that hits of the first row took, by the Rust twin (the WGSL one has the same bits). Where Newton fails a \
                  bracketed search takes over; that is to be rare.",
            unit: "hits by bracketing, %",
            bound: 5.0,
            measure: steps,
        },
        Row {
            name: "profiles that cross the axis",
            how: "A profile with a negative radius is no surface: the scene is refused, with the place in the file.",
            unit: "such scenes accepted",
            bound: 0.0,
            measure: |_| {
                let crossing = [
                    "[[0.5, 0], [-0.1, 1]]",
                    "[[0.2, 0], [-1, 0.5], [0.2, 1]]",
                    "[[0, 0], [-1e-6, 1], [0.5, 2]]",
                ];
                let accepted = crossing.iter().filter(|profile| {
                    let text = format!(
                        "version = 1\n[camera]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\n\
                         fov = 40\n\
                         [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                         [[shapes]]\ntype = \"revolution\"\nprofile = {profile}\nmaterial = \"m\"\n"
                    );
                    parse_errors(&text).iter().all(|error| !error.contains("crosses the axis"))
                });
                (accepted.count() as f64).into()
            },
        },
    ]
}

fn profile(name: &'static str, segments: &[&[[f64; 2]]]) -> Profile {
    let round = |p: &[f64; 2]| DVec2::new(f64::from(p[0] as f32), f64::from(p[1] as f32));
    Profile { name, segments: segments.iter().map(|s| s.iter().map(round).collect()).collect() }
}

fn extreme_points() -> Vec<Profile> {
    vec![
        profile("tips at both ends", &[&[[0.0, 0.0], [0.5, 0.5], [0.0, 1.0]]]),
        profile("needle tip", &[&[[0.5, 0.0], [0.0, 0.2], [0.0, 1.0]]]),
        profile("touches the axis in between", &[&[[0.4, 0.0], [-0.4, 0.5], [0.4, 1.0]]]),
        profile(
            "vertical and horizontal tangents",
            &[&[[0.2, 0.0], [0.8, 0.0], [0.8, 0.9], [0.3, 0.9]]],
        ),
        profile(
            "horizontal disc and vertical wall",
            &[&[[0.0, 0.0], [0.5, 0.0]], &[[0.5, 0.0], [0.5, 0.8]]],
        ),
        profile(
            "a segment of length zero",
            &[
                &[[0.5, 0.0], [0.6, 0.5]],
                &[[0.6, 0.5], [0.6, 0.5], [0.6, 0.5]],
                &[[0.6, 0.5], [0.2, 1.0]],
            ],
        ),
        profile(
            "coinciding control points",
            &[&[[0.3, 0.0], [0.3, 0.0], [0.7, 0.5], [0.7, 0.5], [0.2, 1.0], [0.2, 1.0]]],
        ),
        profile(
            "inflection with a level tangent",
            &[&[[0.2, 0.0], [0.5, 0.0], [0.5, 0.0], [0.8, 0.0], [0.8, 0.5]]],
        ),
    ]
}

/// A vase and a drop with radii times each factor.
fn squeezed(factors: &[f64]) -> Vec<Profile> {
    let mut out = Vec::new();
    for factor in factors {
        for p in profiles().into_iter().filter(|p| ["vase", "drop"].contains(&p.name)) {
            let scale = |q: &DVec2| DVec2::new(f64::from((q.x * factor) as f32), q.y);
            let segments = p.segments.iter().map(|s| s.iter().map(scale).collect()).collect();
            out.push(Profile { name: p.name, segments });
        }
    }
    out
}

/// A scene of the surface alone. All tables are padded to one length, so that the driver compiles
/// one kernel for all.
fn scene_of(placed: &Placed) -> SceneTables {
    let mut scene = SceneTables::empty();
    scene.revolutions = placed.tables.revolutions.clone();
    scene.patches = placed.tables.patches.clone();
    scene.profile_points = placed.tables.profile_points.clone();
    scene.patches.resize(scene.patches.len().max(1024), Patch::zeroed());
    scene.profile_points.resize(scene.profile_points.len().max(8192), Vec2::ZERO);
    let boxes: Vec<_> =
        placed.boxes.iter().map(|b| Primitive::Box(Aabb { min: b.min, max: b.max })).collect();
    let tree = build(&boxes);
    scene.world.bounds_min = tree.bounds.min;
    scene.world.bounds_max = tree.bounds.max;
    scene.nodes = tree.nodes;
    let patch = |i: &u32| reference(KIND_REVOLUTION, placed.boxes[*i as usize].patch as usize);
    scene.refs = tree.refs.iter().map(patch).collect();
    scene
}

fn rays_at(b: &Bench, placed: &Placed, classes: &[Class]) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(41);
    let count = b.samples(500, 2_000);
    classes
        .iter()
        .flat_map(|&photon_class| (0..count).map(move |_| photon_class))
        .map(|c| ray(placed, c, &mut random))
        .collect()
}

fn placements(b: &Bench) -> Vec<Placement> {
    if b.long { vec![Placement::default(), skew()] } else { vec![skew()] }
}

fn tally(b: &Bench, profiles: &[Profile], classes: &[Class], placements: &[Placement]) -> Tally {
    let mut sum = Tally::default();
    for placement in placements {
        for profile in profiles {
            let placed = place(profile, placement);
            assert!(placed.tables.patches.iter().all(|p| p.length > 0.0), "{}", profile.name);
            let rays = rays_at(b, &placed, classes);
            let asked: Vec<Ray> = rays
                .iter()
                .map(|&(origin, direction)| Ray { origin, t_min: 0.0, direction, t_max: FAR })
                .collect();
            let found = b.trace(&scene_of(&placed), &asked);
            let all = rays.par_iter().zip(&found).map(|(&(o, d), f)| {
                let own = judge(&placed, o, d, f.is_hit().then_some(f64::from(f.t)));
                if own.wrong() > 0 && std::env::var("SHOW").is_ok() {
                    eprintln!("{} {o:?} {d:?} {f:?} {}", profile.name, own.report());
                }
                own
            });
            sum = sum.add(all.reduce(Tally::default, Tally::add));
        }
    }
    sum
}

fn reported(tally: &Tally) -> Figure {
    let note = format!(
        "{} rays, {} hits: {} missed, {} false, {} off; {} excused.",
        tally.rays, tally.hits, tally.lost, tally.false_hits, tally.off, tally.ill_conditioned
    );
    Figure { value: 1e6 * tally.wrong() as f64 / tally.rays as f64, note }
}

fn wrong(b: &Bench, profiles: &[Profile], classes: &[Class]) -> Figure {
    reported(&tally(b, profiles, classes, &placements(b)))
}

fn steps(b: &Bench) -> Figure {
    let (mut histogram, mut bracketed, mut hits) = ([0u64; 16], 0u64, 0u64);
    for profile in profiles() {
        let placed = place(&profile, &skew());
        let t = &placed.tables;
        for (o, d) in rays_at(b, &placed, &CLASSES) {
            let mut best = patch_miss();
            for patch in &t.patches {
                let hit =
                    intersect_patch(&t.profile_points, &t.revolutions[0], patch, o, d, 0.0, best.t);
                if hit.t < best.t {
                    best = hit;
                }
            }
            if best.t < FAR {
                hits += 1;
                bracketed += u64::from(best.steps & BRACKETED != 0);
                histogram[(best.steps & 15) as usize] += 1;
            }
        }
    }
    let shares: Vec<String> = (0..)
        .zip(histogram)
        .filter(|(_, n)| *n > 0)
        .map(|(i, n)| format!("{i}: {:.3} %", 100.0 * n as f64 / hits as f64))
        .collect();
    Figure {
        value: 100.0 * bracketed as f64 / hits as f64,
        note: format!("Steps of {hits} hits: {}.", shares.join(", ")),
    }
}
