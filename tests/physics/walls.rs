//! Thin bodies, and walls that separate a lit room from a dark one: photons that a gather disc must
//! not count.

use std::f64::consts::PI;
use std::fmt::Write;

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use glam::DVec3;

use super::lab::*;

/// Theory: a convex body of reflectance 0.8 under a sky of radiance one sees the whole half-space
/// from each of its faces, so every face has the radiance 0.8, however slim it is relative to the
/// disc. Where the disc is wide, it covers as many photons of adjacent faces as of the face itself.
///
/// Box and camera are as close together as the disc allows, since the sky sends its photons to the
/// ball that contains both.
#[test]
fn slim_boxes_under_an_even_sky() {
    for (width, depth, radius) in [(0.012, 0.012, 0.05), (0.004, 0.1, 0.02), (0.05, 0.002, 0.015)] {
        let height = 2.4 * radius;
        let camera = Camera {
            position: DVec3::new(0.137, 0.211, height - 0.353),
            target: DVec3::new(0.137, 0.211, -0.353),
            fov: (0.4 * width / height).to_degrees(),
            size: 4,
        };
        let (low, high) = (camera.target.x - 0.5 * width, camera.target.x + 0.5 * width);
        let text = format!(
            "{}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.8\n[[shapes]]\ntype = \"box\"\n\
             material = \"m\"\n\
             min = [{low:?}, {:?}, {:?}]\nmax = [{high:?}, {:?}, -0.353]\n[environment]\n\
             radiance = 1.0\n",
            camera.toml(),
            0.211 - 0.5 * height,
            -0.353 - depth,
            0.211 + 0.5 * height
        );
        let settings = RenderSettings { direct: Direct::Photons, ..settings(radius) };
        let found = runs_to(0.05, &text, &settings).region(|_, _| true);
        assert_agrees(&format!("box {width} x {depth}, radius {radius}"), found, 0.8, 0.05);
    }
}

/// A prism over a convex polygon in (x, y), from z = `back` to 0, as one mesh whose faces are split
/// into triangles.
fn prism(polygon: &[[f64; 2]], back: f64) -> String {
    let n = polygon.len();
    let mut text = String::new();
    for z in [0.0, back] {
        polygon.iter().for_each(|[x, y]| {
            let _ = writeln!(text, "v {x:?} {y:?} {z:?}");
        });
    }
    for i in 1..n - 1 {
        let _ = writeln!(text, "f 1 {} {}\nf {} {} {}", i + 1, i + 2, n + 1, n + i + 2, n + i + 1);
    }
    for i in 0..n {
        let (a, b) = (i + 1, (i + 1) % n + 1);
        let _ = writeln!(text, "f {a} {} {b}\nf {b} {} {}", n + a, n + a, n + b);
    }
    text
}

/// Theory: the same holds for any convex triangle mesh, since its flat faces have outlines too.
/// Without them the faces of these prisms are 7 to 30 % off.
#[test]
fn slim_meshes_under_an_even_sky() {
    let regular = |n: usize, size: f64| -> Vec<[f64; 2]> {
        let corner = |k: usize| (std::f64::consts::TAU * (k as f64 + 0.2) / n as f64).sin_cos();
        (0..n).map(corner).map(|(sin, cos)| [cos * size, sin * size]).collect()
    };
    let square = |w: f64, h: f64| vec![[-w, -h], [w, -h], [w, h], [-w, h]];
    let shapes = [
        ("bar", square(0.006, 0.06), -0.012, 0.05),
        ("plate", square(0.03, 0.018), -0.002, 0.015),
        ("triangle", regular(3, 0.012), -0.01, 0.02),
        ("pentagon", regular(5, 0.012), -0.01, 0.012),
    ];
    for (name, polygon, back, radius) in shapes {
        let file = format!("prism-{name}.obj");
        std::fs::write(folder().join(&file), prism(&polygon, back)).expect("written");
        let camera = Camera {
            position: DVec3::new(0.137, 0.211, 0.05),
            target: DVec3::new(0.137, 0.211, 0.0),
            fov: 6.0,
            size: 4,
        };
        let text = format!(
            "{}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.8\n[[shapes]]\ntype = \"mesh\"\n\
             file = \"{file}\"\nsmooth = false\nmaterial = \"m\"\n\
             transform = {{ translate = [0.137, 0.211, 0] }}\n[environment]\nradiance = 1.0\n",
            camera.toml(),
        );
        let settings = RenderSettings { direct: Direct::Photons, ..settings(radius) };
        let found = runs_to(0.05, &text, &settings).region(|_, _| true);
        assert_agrees(&format!("{name}, radius {radius}"), found, 0.8, 0.05);
    }
}

const HEAD: &str = r#"
[materials.white]
type = "diffuse"
reflectance = 0.7
[materials.black]
type = "diffuse"
reflectance = 0.0
"#;

/// A wall's foot in the plane x = 0 on a floor.
const WALLS: [(&str, &str); 4] = [
    ("rectangle", "type = \"rectangle\"\norigin = [0, 0, -1]\nu = [0, 0, 2]\nv = [0, 1, 0]"),
    ("thin box", "type = \"box\"\nmin = [-0.002, 0, -1]\nmax = [0.002, 1, 1]"),
    ("box through the floor", "type = \"box\"\nmin = [-0.002, -0.3, -1]\nmax = [0.002, 1, 1]"),
    ("mesh", "type = \"mesh\"\nfile = \"thin-wall.obj\""),
];

const FLOORS: [(&str, &str); 5] = [
    ("rectangle", "type = \"rectangle\"\norigin = [-1, 0, 1]\nu = [2, 0, 0]\nv = [0, 0, -2]"),
    ("box", "type = \"box\"\nmin = [-1, -0.2, -1]\nmax = [1, 0, 1]"),
    ("plane", "type = \"plane\"\npoint = [0.3, 0, 0]\nnormal = [0, 1, 0]"),
    ("mesh", "type = \"mesh\"\nfile = \"floor-1.obj\""),
    ("mesh of 72 triangles", "type = \"mesh\"\nfile = \"floor-6.obj\""),
];

/// The square [-1, 1]^2 in y = 0 as `n` by `n` squares of two triangles.
fn grid(n: usize) -> String {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let mut text = String::new();
    for i in 0..(n + 1) * (n + 1) {
        let _ = writeln!(text, "v {:?} 0 {:?}", at(i % (n + 1)), at(i / (n + 1)));
    }
    for i in 0..n * n {
        let a = i / n * (n + 1) + i % n + 1;
        let _ = writeln!(text, "f {a} {} {}\nf {a} {} {}", a + n + 1, a + n + 2, a + n + 2, a + 1);
    }
    text
}

/// The scene: two rooms, a lamp in the right one; the camera looks down at the floor on either side
/// of the wall.
fn rooms(wall: &str, floor: &str, camera: Camera, material: &str) -> String {
    let mesh = "v 0 0 -1\nv 0 0 1\nv 0 1 1\nv 0 1 -1\nf 1 2 3\nf 1 3 4\n";
    std::fs::write(folder().join("thin-wall.obj"), mesh).expect("written");
    for n in [1, 6] {
        std::fs::write(folder().join(format!("floor-{n}.obj")), grid(n)).expect("written");
    }
    let mut text = camera.toml() + HEAD;
    for (shape, material) in [(floor, "white"), (wall, material)] {
        let _ = write!(text, "[[shapes]]\n{shape}\nmaterial = \"{material}\"\n");
    }
    for (origin, u, v) in [
        ([-1, 1, -1], [2, 0, 0], [0, 0, 2]),
        ([-1, 0, -1], [0, 1, 0], [0, 0, 2]),
        ([1, 0, -1], [0, 0, 2], [0, 1, 0]),
        ([-1, 0, -1], [2, 0, 0], [0, 1, 0]),
        ([-1, 0, 1], [0, 1, 0], [2, 0, 0]),
    ] {
        let _ = write!(
            text,
            "[[shapes]]\ntype = \"rectangle\"\norigin = {origin:?}\nu = {u:?}\nv = {v:?}\n\
             material = \"{material}\"\n"
        );
    }
    text + "[[lights]]\ntype = \"point\"\nposition = [0.4, 0.8, 0.0]\nintensity = 1.0\n"
}

/// Looks at the floor of the room with x of that sign, within 0.05 of the wall.
fn camera(side: f64) -> Camera {
    let x = side * 0.0275;
    Camera {
        position: DVec3::new(x, 0.9, 0.02),
        target: DVec3::new(x, 0.0, 0.0),
        fov: 3.1,
        size: 8,
    }
}

/// Theory: no light enters the closed dark room, so every value there is exactly 0, with photons as
/// with a path tracer, although the disc reaches from the dark side of the wall far into the lit
/// room.
#[test]
fn nothing_passes_under_a_wall() {
    for (floor_name, floor) in FLOORS {
        for (wall_name, wall) in WALLS {
            let text = rooms(wall, floor, camera(-1.0), "white");
            let scene = parse(&text);
            for (method, direct) in [
                (Method::Sppm, Direct::Photons),
                (Method::Ppm, Direct::Sampled),
                (Method::Path, Direct::Sampled),
            ] {
                let settings = RenderSettings { method, direct, photons: 1 << 14, ..settings(0.1) };
                let picture = render(&scene, &settings);
                let brightest = picture.rgb.iter().flatten().copied().fold(0.0, f32::max);
                assert_eq!(brightest, 0.0, "{wall_name} on {floor_name}, {method:?} {direct:?}");
            }
        }
    }
}

/// Theory: with black walls the lit floor has the irradiance of the lamp alone, cos / d^2, up to
/// the foot of the wall. Neither the disc's area beyond the wall nor photons on the wall may count.
/// The disc of 0.03 is cut to no less than a half, whose centroid lies 0.42 radii from its centre;
/// the irradiance changes by less than 2 % over that distance.
#[test]
fn the_lit_side_is_even_up_to_the_wall() {
    for (floor_name, floor) in FLOORS {
        // each wall once and each floor once
        let pairs =
            |(wall_name, _): &&(&str, &str)| floor_name == "rectangle" || *wall_name == "mesh";
        for (wall_name, wall) in WALLS.iter().filter(pairs) {
            let camera = camera(1.0);
            // a spot sends no photons to the far parts of the room
            let spot = "type = \"spot\"\ntarget = [0, 0, 0]\nangle = 25.0\nblend = 0.0\n";
            let text = rooms(wall, floor, camera, "black").replace("type = \"point\"\n", spot);
            let settings =
                RenderSettings { direct: Direct::Photons, photons: 1 << 11, ..settings(0.03) };
            let at = DVec3::new(0.4, 0.8, 0.0);
            let truth = camera.floor_picture(0.0, |p| 0.7 / PI * at.y / (at - p).length().powi(3));
            let mean = truth.iter().sum::<f64>() / truth.len() as f64;
            let found = runs_to(0.04, &text, &settings).region(|_, _| true);
            let off = found.mean / mean - 1.0;
            println!("{wall_name} on {floor_name}: {off:+.4} +- {:.4}", found.error / mean);
            assert!(found.admits(mean, 0.02), "{wall_name} on {floor_name}: {off:+.4}");
            assert!(
                !found.admits(mean * 1.1, 0.02) && !found.admits(mean * 0.9, 0.02),
                "too noisy"
            );
        }
    }
}
