//! Rays against shapes of extreme size, slimness and angle.

use caustica::low_level::accel::kdtree::build;
use caustica::low_level::prepare::normalize::Normalization;
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::tables::{
    KIND_TRIANGLE, NONE, SceneTables, Triangle, index_of, reference,
};
use glam::{DVec3, Vec3};

use super::bench::{Bench, parse};
use super::table::{Figure, Row};
use crate::brute_force::{self, Rng};

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "floor spheres of radius 1e3 to 1e9",
            how: "Rays from a camera one unit above the floor to points up to 20 units away; t against the sphere's \
                  quadratic in f64 about the point below the camera. A rounding of the origin's height moves t by 1 / sin of \
                  the angle with the floor (0.05 at least), which is taken off.",
            unit: "relative error of t, times sin",
            bound: 5e-7,
            measure: floors,
        },
        Row {
            name: "a ball of radius 1e-5 on one of 1e5",
            how: "Rays of a camera 6e-5 away over the whole picture against both spheres in f64. Wrong is a ray that meets \
                  another one than in f64 (those that pass the ball's outline within 1e-3 of its radius are left out), or \
                  whose t is off by more than 1e-5.",
            unit: "wrong rays",
            bound: 0.0,
            measure: ball_on_giant,
        },
        Row {
            name: "balls of radius 1e-5 in a scene of radius one",
            how: "Balls at random places, each met by rays from the camera. Distance of the point found from the true surface in \
                  f64, over the ball's radius: what is left of a shape's form when its place is rounded by 6e-8. `check` warns of \
                  anything narrower.",
            unit: "of the radius",
            bound: 2e-2,
            measure: small_balls,
        },
        Row {
            name: "triangles of aspect 1e7",
            how: "A closed unit cube, each face a fan about a point 1e-7 from one of its edges. A ray from inside \
                  must meet it, at a point whose distance from the face's plane is within the hit's error bound.",
            unit: "leaks and hits out of bounds",
            bound: 0.0,
            measure: slivers,
        },
        Row {
            name: "rays at shared edges and vertices of closed meshes",
            how: "Rays from inside a bumpy sphere and a bumpy torus, each aimed at a vertex or at a point of an edge: one \
                  that meets nothing has leaked.",
            unit: "leaks",
            bound: 0.0,
            measure: leaks,
        },
        Row {
            name: "rays along axes, in splitting planes, at corners",
            how: "Against coplanar grids, slivers, triangles of every size and a tilted plane: the nearest t must have the \
                  bits of exhaustive search over all triangles.",
            unit: "rays that differ",
            bound: 0.0,
            measure: exhaustive,
        },
    ]
}

/// Nearest distance above zero at which a ray meets the sphere through `anchor` with outward normal
/// `n` and curvature `k`.
fn sphere_t(o: DVec3, v: DVec3, anchor: DVec3, n: DVec3, k: f64) -> Option<f64> {
    let d = o - anchor;
    let (a, b, c) = (
        0.5 * k * v.length_squared(),
        v.dot(n) + k * d.dot(v),
        d.dot(n) + 0.5 * k * d.length_squared(),
    );
    let root = b * b - 4.0 * a * c;
    let q = -0.5 * (b + root.max(0.0).sqrt().copysign(b));
    let both = [q / a, c / q];
    (root >= 0.0).then_some(())?;
    both.into_iter().filter(|t| *t > 0.0).min_by(f64::total_cmp)
}

pub fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray {
        origin: origin.as_vec3(),
        t_min: 0.0,
        direction: direction.normalize().as_vec3(),
        t_max: 1e30,
    }
}

fn floors(b: &Bench) -> Figure {
    let mut worst = 0.0f64;
    let radii = if b.long { &[1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9][..] } else { &[1e3, 1e5, 1e9] };
    let mut rng = Rng(3);
    for radius in radii {
        let text = format!(
            "version = 1\n[camera]\nposition = [0, 1, 0]\ntarget = [0, 0.5, -4]\nfov = 40\n\
             [film]\nwidth = 8\nheight = 8\n\
             [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
             [[shapes]]\ntype = \"sphere\"\ncenter = [0, {:?}, 0]\nradius = {radius:?}\n\
             material = \"m\"\n",
            -radius
        );
        let n = Normalization::of(&parse(&text));
        let packed = b.packed(&text);
        let rays: Vec<Ray> = (0..b.samples(20_000, 200_000))
            .map(|_| {
                let on = DVec3::new(f64::from(rng.signed()), 0.0, f64::from(rng.signed())) * 14.0;
                ray(n.point(DVec3::Y), on - DVec3::Y)
            })
            .collect();
        for (ray, found) in rays.iter().zip(b.trace(&packed.tables, &rays)) {
            let (o, v) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let k = n.unit / radius;
            let truth =
                sphere_t(o, v, n.point(DVec3::ZERO), DVec3::Y, k).expect("the floor lies below");
            // over the horizon of the smallest ball the ray may just touch it
            let at = o + v * truth - n.point(DVec3::ZERO);
            let sin = -v.dot((DVec3::Y + at * k).normalize());
            let error = if found.is_hit() { (f64::from(found.t) / truth - 1.0).abs() } else { 1.0 };
            worst = worst.max(error * sin);
        }
    }
    worst.into()
}

fn small_balls(b: &Bench) -> Figure {
    const R: f64 = 1e-5;
    let mut rng = Rng(9);
    let mut worst = 0.0f64;
    let mut met = 0;
    let balls: Vec<DVec3> = (0..20).map(|_| rng.point().as_dvec3() * 0.55).collect();
    let mut text = "version = 1\n[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, -1]\nfov = 90\n\
                    [film]\nwidth = 8\nheight = 8\n\
         [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n"
        .to_owned();
    for c in &balls {
        text += &format!(
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{:?}, {:?}, {:?}]\nradius = {R:?}\n\
             material = \"m\"\n",
            c.x, c.y, c.z
        );
    }
    let n = Normalization::of(&parse(&text));
    let packed = b.packed(&text);
    let rays: Vec<Ray> = (0..b.samples(20_000, 200_000))
        .map(|i| {
            let aim = balls[i as usize % balls.len()] + rng.point().as_dvec3() * (0.6 * R);
            ray(n.point(DVec3::Z), aim - DVec3::Z)
        })
        .collect();
    for (i, found) in b.trace(&packed.tables, &rays).iter().enumerate().filter(|(_, f)| f.is_hit())
    {
        met += 1;
        let world = found.position.as_dvec3() * n.unit + n.center;
        worst = worst.max((world.distance(balls[i % balls.len()]) / R - 1.0).abs());
    }
    Figure { value: worst, note: format!("{met} of {} rays meet their ball.", rays.len()) }
}

fn ball_on_giant(b: &Bench) -> Figure {
    const R: f64 = 1e-5;
    let text = "version = 1\n[camera]\nposition = [0, 2e-5, 6e-5]\ntarget = [0, 1e-5, 0]\n\
                fov = 40\n[film]\nwidth = 8\nheight = 8\n\
         [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0, 1e-5, 0]\nradius = 1e-5\nmaterial = \"m\"\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0, -1e5, 0]\nradius = 1e5\nmaterial = \"m\"\n";
    let n = Normalization::of(&parse(text));
    let packed = b.packed(text);
    let mut rng = Rng(5);
    let camera = DVec3::new(0.0, 2e-5, 6e-5);
    let rays: Vec<Ray> = (0..b.samples(50_000, 500_000))
        .map(|_| {
            let (x, y) = (f64::from(rng.signed()), f64::from(rng.signed()));
            ray(n.point(camera), DVec3::new(x * 2e-5, 1e-5 + y * 2e-5, 0.0) - camera)
        })
        .collect();
    let (r, k) = (R / n.unit, n.unit / 1e5);
    let (center, ground) = (n.point(DVec3::Y * R), n.point(DVec3::ZERO));
    let mut wrong = 0;
    for (ray, found) in rays.iter().zip(b.trace(&packed.tables, &rays)) {
        let (o, v) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let closest = (center - o) - v * (center - o).dot(v);
        if (closest.length() / r - 1.0).abs() < 1e-3 {
            continue;
        }
        let ball = sphere_t(o, v, center + DVec3::Y * r, DVec3::Y, 1.0 / r);
        let floor = sphere_t(o, v, ground, DVec3::Y, k);
        let met = [(ball, 0), (floor, 1)].into_iter().filter_map(|(t, i)| Some((t?, i)));
        let truth = met.min_by(|a, b| a.0.total_cmp(&b.0));
        let same = match truth {
            None => !found.is_hit(),
            Some((t, which)) => {
                let index = index_of(found.reference);
                // near the horizon t is unbounded
                found.is_hit()
                    && index == which
                    && (t > 100.0 || (f64::from(found.t) / t - 1.0).abs() < 1e-5)
            }
        };
        wrong += u32::from(!same);
    }
    f64::from(wrong).into()
}

/// A scene of triangles only, already in scene space.
fn of_triangles(mesh: &[[Vec3; 3]]) -> SceneTables {
    let mut scene = SceneTables::empty();
    let tree = build(&brute_force::prims(mesh));
    scene.world.bounds_min = tree.bounds.min;
    scene.world.bounds_max = tree.bounds.max;
    scene.nodes = tree.nodes;
    scene.refs = tree.refs.iter().map(|&i| reference(KIND_TRIANGLE, i as usize)).collect();
    let triangle = |p: &[Vec3; 3]| Triangle {
        p0: p[0],
        material: 0,
        p1: p[1],
        light: NONE,
        p2: p[2],
        attributes: NONE,
    };
    scene.triangles = mesh.iter().map(triangle).collect();
    scene
}

/// The unit cube, each face a fan about a point 1e-7 from an edge.
fn sliver_cube() -> Vec<[Vec3; 3]> {
    let mut out = Vec::new();
    for axis in 0..3 {
        let unit = |k: usize| {
            Vec3::from_array(std::array::from_fn(|i| if i == (axis + k) % 3 { 1.0 } else { 0.0 }))
        };
        for side in [0.0, 1.0] {
            let (a, e1, e2) = (unit(0) * side, unit(1), unit(2));
            let p = a + e1 * 0.5 + e2 * 1e-7;
            let corners = [a, a + e1, a + e1 + e2, a + e2];
            out.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4], p]));
        }
    }
    out
}

fn slivers(b: &Bench) -> Figure {
    let mesh = sliver_cube();
    let scene = of_triangles(&mesh);
    let mut rng = Rng(7);
    let rays: Vec<Ray> = (0..b.samples(100_000, 1_000_000))
        .map(|i| {
            let origin = DVec3::splat(0.5) + rng.point().as_dvec3() * 0.49;
            let t = mesh[rng.below(mesh.len())].map(|p| p.as_dvec3());
            let (mut u, mut v) = (f64::from(rng.signed()).abs(), f64::from(rng.signed()).abs());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            // a third aim at edges, a third at vertices
            (u, v) = [(u, v), (u, 0.0), (0.0, 0.0)][i as usize % 3];
            ray(origin, t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v - origin)
        })
        .collect();
    let found = b.trace(&scene, &rays);
    let bad = found.iter().filter(|f| {
        let p = f.position.as_dvec3();
        let off =
            p.to_array().iter().map(|x| x.abs().min((x - 1.0).abs())).fold(f64::MAX, f64::min);
        !f.is_hit() || off > f64::from(f.error)
    });
    (bad.count() as f64).into()
}

fn leaks(b: &Bench) -> Figure {
    let count = b.samples(50_000, 500_000);
    let mut rng = Rng(11);
    let mut sum = 0;
    for torus in [false, true] {
        let mesh = if torus {
            brute_force::displaced_torus(120, 60)
        } else {
            brute_force::displaced_sphere(120, 60)
        };
        let scene = of_triangles(&mesh);
        let rays: Vec<Ray> = (0..count)
            .map(|_| {
                let origin = if torus {
                    let d = Vec3::new(rng.signed(), 0.0, rng.signed() + 1e-3);
                    d / d.length() + rng.point() * 0.1
                } else {
                    rng.point() * 0.5
                };
                let t = mesh[rng.below(mesh.len())];
                let (p, q) = (t[rng.below(3)], t[rng.below(3)]);
                let along = if rng.below(3) == 0 { 0.0 } else { 0.5 + 0.5 * rng.signed() };
                let d = p + (q - p) * along - origin;
                Ray { origin, t_min: 0.0, direction: d / d.length(), t_max: 1e30 }
            })
            .collect();
        sum += b.trace(&scene, &rays).iter().filter(|f| !f.is_hit()).count();
    }
    (sum as f64).into()
}

fn exhaustive(b: &Bench) -> Figure {
    let mut rng = Rng(13);
    let mut differ = 0;
    for (name, prims) in brute_force::scenes() {
        if !["lattice of coplanar grids", "slivers", "every size", "all in a tilted plane"]
            .contains(&name)
        {
            continue;
        }
        let mesh: Vec<[Vec3; 3]> = prims
            .iter()
            .filter_map(|p| match p {
                caustica::low_level::accel::kdtree::Primitive::Triangle(t) => Some(*t),
                caustica::low_level::accel::kdtree::Primitive::Box(_) => None,
            })
            .collect();
        let scene = of_triangles(&mesh);
        let tree = build(&prims);
        let rays =
            brute_force::rays(&prims, &tree.view(), b.samples(8_000, 80_000) as usize, &mut rng);
        let found = b.trace(&scene, &rays);
        let same = |(ray, found): &(&Ray, &super::bench::Found)| {
            found.t.to_bits() == brute_force::exhaustive(&prims, ray).t.to_bits()
        };
        differ += rays.iter().zip(&found).filter(|pair| !same(pair)).count();
    }
    (differ as f64).into()
}
