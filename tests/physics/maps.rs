//! Normal maps and bump maps: frames of all shapes, closed forms, and agreement of the methods.

use std::f64::consts::PI;

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::{Surface, surface_at};
use caustica::low_level::geometry::tangents::tangents_at;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::settings::{Direct, Method, RadiusRule};
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::table::{KIND_INSTANCE, NONE, kind_of};
use glam::DVec3;
use image::{Rgb, RgbImage};

use super::agreement::pairwise;
use super::lab::*;
use super::materials::{agrees, floor};

/// Writes an image of `size` with these texels, and returns its path.
pub fn map(name: &str, size: (u32, u32), texel: impl Fn(u32, u32) -> [u8; 3]) -> String {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = RgbImage::from_fn(size.0, size.1, |x, y| Rgb(texel(x, y)));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    file(&format!("physics-maps-{name}.png"), &bytes.into_inner())
}

pub fn texture(name: &str, file: &str, keys: &str) -> String {
    format!(
        "[textures.{name}]\ntype = \"image\"\nfile = \"{file}\"\ncolor_space = \"linear\"\n{keys}\n"
    )
}

/// Theory: a floor whose map gives one normal n everywhere has the radiance `rho I n . w / (pi
/// d^2)`, with the components of n along x and -z, in which u and v increase, and along y.
#[test]
fn normal_map_floor() {
    let texel = [166u8, 90, 230];
    let map = texture("n", &map("even", (2, 2), |_, _| texel), "");
    for strength in [1.0, -0.5] {
        let [x, y, z] = texel.map(|c| 2.0 * f64::from(c) / 255.0 - 1.0);
        let n = DVec3::new(x * strength, z, -y * strength).normalize();
        let material = format!(
            "type = \"diffuse\"\nreflectance = 0.8\nnormal_map = \"n\"\n\
             normal_strength = {strength:?}"
        );
        let at = DVec3::new(0.6, 0.9, -0.3);
        let radiance =
            |p: DVec3| 0.8 * (at - p).normalize().dot(n).max(0.0) / (PI * at.distance_squared(p));
        agrees(&format!("strength {strength}"), &(floor(&material, at.into()) + &map), radiance);
    }
}

/// Theory: a floor of the height h(x, z) has the normal `(-dh/dx, 1, -dh/dz)`. On an image of 8
/// bits that rises by one from texel to texel, a unit of u is 256 / 255 of the height. A height
/// scale with the sign changed makes dents.
#[test]
fn bump_map_floor() {
    for (name, height, rise) in [
        ("along u", 0.5, (|x, _| x) as fn(u32, u32) -> u32),
        ("along v", 0.8, |_, y| 255 - y),
        ("dented", -0.6, |x, y| (x + 255 - y) / 2),
    ] {
        let rises = |x, y| [rise(x, y) as u8; 3];
        let file = map(name.replace(' ', "-").as_str(), (256, 256), rises);
        let texture = texture("h", &file, "wrap = \"clamp\"");
        let slope = |du: u32, dv: u32| {
            let (a, b) = (rise(100, 100), rise(100 + 2 * du, 100 - 2 * dv));
            f64::from(b - a) / 2.0 * 256.0 / 255.0 * height
        };
        // u is half of x + 1, v half of 1 - z
        let n = DVec3::new(-slope(1, 0) / 2.0, 1.0, slope(0, 1) / 2.0).normalize();
        let material = format!(
            "type = \"diffuse\"\nreflectance = 0.8\nbump_map = \"h\"\nbump_height = {height:?}"
        );
        let at = DVec3::new(0.6, 0.9, -0.3);
        let radiance =
            |p: DVec3| 0.8 * (at - p).normalize().dot(n).max(0.0) / (PI * at.distance_squared(p));
        agrees(name, &(floor(&material, at.into()) + &texture), radiance);
    }
}

/// Every shape on its own place, with the name of its kind.
const SHAPES: [(&str, &str); 13] = [
    ("sphere", "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6"),
    ("planar sphere", "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6\nuv = \"planar\""),
    (
        "rectangle",
        "type = \"rectangle\"\norigin = [-0.6, 0.1, 0.4]\nu = [1.1, 0.2, 0]\nv = [0.3, -0.1, -1]",
    ),
    ("disc", "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0.3, 1, 0.2]\nradius = 0.6"),
    ("box", "type = \"box\"\nmin = [-0.5, -0.4, -0.3]\nmax = [0.4, 0.3, 0.5]"),
    (
        "revolution",
        "type = \"revolution\"\nsegments = [[[0, -0.5], [0.4, -0.5]], [[0.4, -0.5], [0.8, 0.1], \
         [0.3, 0.5]], [[0.3, 0.5], [0, 0.6]]]",
    ),
    ("cylinder", "type = \"cylinder\"\nradius = 0.3\np0 = [-0.5, -0.1, 0]\np1 = [0.4, 0.3, 0.2]"),
    ("mesh", "type = \"mesh\"\nfile = \"MESH\""),
    ("plane", "type = \"plane\"\npoint = [0, -0.2, 0]\nnormal = [0.1, 1, 0.2]"),
    (
        "ellipsoid",
        "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6\n\
         transform = [{ scale = [1, 0.5, -0.8] }, { rotate = { axis = [1, 1, 0], degrees = 40 } }]",
    ),
    ("mirrored mesh", "type = \"mesh\"\nfile = \"MESH\"\ntransform = { scale = [-1, 0.7, 0.8] }"),
    (
        "planar ellipsoid",
        "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6\nuv = \"planar\"\n\
         transform = { scale = [1, 0.5, 0.8] }",
    ),
    (
        "sheared box",
        "type = \"box\"\nmin = [-0.5, -0.4, -0.3]\nmax = [0.4, 0.3, 0.5]\n\
         transform = { matrix = [[1, 0.3, 0, 0], [0, 1, 0.2, 0], [0.1, 0, 1, 0]] }",
    ),
];

/// A wavy patch with a (u, v) at each vertex.
fn wavy() -> String {
    let mut text = String::new();
    for j in 0..=8 {
        for i in 0..=8 {
            let (x, z) = (f64::from(i) / 6.0 - 0.7, f64::from(j) / 6.0 - 0.7);
            text += &format!("v {x} {} {z}\n", 0.2 * (3.0 * x).sin() * (2.0 * z).cos());
            text += &format!("vt {} {}\n", 0.8 * x + 0.3 * z, 0.2 * x - 1.1 * z);
        }
    }
    for j in 0..8 {
        for i in 0..8 {
            let a = j * 9 + i + 1;
            let [a, b, c, d] = [a, a + 9, a + 10, a + 1].map(|k| format!("{k}/{k}"));
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

fn packed(shape: &str) -> PackedScene {
    let mesh = file("physics-maps-wavy.obj", wavy().as_bytes());
    let map = texture("n", &map("flat", (2, 2), |_, _| [128, 128, 255]), "");
    let camera =
        Camera { position: DVec3::new(0.0, 3.0, 0.1), target: DVec3::ZERO, fov: 40.0, size: 8 };
    let text = camera.toml()
        + &format!(
            "{map}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\nnormal_map = \"n\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, 3, 0]\nintensity = 1\n\
             [[shapes]]\n{}\nmaterial = \"m\"\n",
            shape.replace("MESH", &mesh)
        );
    prepare(&parse(&text), 8, 8).unwrap()
}

fn hit(packed: &PackedScene, from: DVec3, to: DVec3) -> Option<(Hit, Surface)> {
    let tables = &packed.tables;
    let origin = ((from - packed.center) / f64::from(tables.world.unit)).as_vec3();
    let direction = (to - from).normalize().as_vec3();
    let ray = Ray { origin, t_min: 0.0, direction, t_max: 100.0 };
    let hit = intersect_scene(tables, &ray);
    (hit.reference != NONE).then(|| (hit, surface_at(tables, &ray, &hit)))
}

/// Theory: between two near points of a surface, `p' - p = (u' - u) dp/du + (v' - v) dp/dv` up to
/// the square of their distance. Some shapes of the list are instances.
#[test]
fn tangents_are_derivatives() {
    let mut instances = 0;
    for (name, shape) in SHAPES {
        let scene = packed(shape);
        let (mut tested, mut off) = (0, 0);
        for k in 0..400 {
            let turn = f64::from(k) * 2.4;
            let from = DVec3::new(turn.cos(), 0.9 + 0.5 * (0.1 * turn).sin(), turn.sin()) * 3.0;
            let r = 0.35 * (f64::from(k) / 400.0).sqrt();
            let to = DVec3::new(r * turn.sin(), 0.1 * (3.0 * turn).sin(), r * (1.3 * turn).cos());
            let Some((first, s)) = hit(&scene, from, to) else { continue };
            let t = tangents_at(&scene.tables, first, s);
            instances += u32::from(kind_of(first.reference) == KIND_INSTANCE);
            for step in [DVec3::X, DVec3::Y, DVec3::Z] {
                let step = step * 2e-3;
                let near = [step, -step].map(|step| hit(&scene, from, to + step));
                let [Some((h1, s1)), Some((h2, s2))] = near else { continue };
                let (d, uv) = (s1.position - s2.position, s1.uv - s2.uv);
                // the same face or patch, away from seams, poles and outlines
                let same = h1.reference == h2.reference && h1.member == h2.member;
                let face = s1.normal.dot(s2.normal) > 0.99;
                if !same || !face || uv.abs().max_element() > 0.1 || d.length() > 0.01 {
                    continue;
                }
                let error = (d - t.u * uv.x - t.v * uv.y).length();
                tested += 1;
                off += u32::from(error > 0.02 * d.length() + 1e-5);
            }
        }
        println!("    {name}: {tested} tested, {off} off");
        assert!(tested > 300, "{name}: {tested}");
        assert!(off * 50 <= tested, "{name}: {off} of {tested}");
    }
    assert!(instances > 500, "{instances}");
}

/// A room with bumpy and mapped surfaces of every kind under a lamp.
fn room(materials: [&str; 4]) -> String {
    let waves = |x: u32, y: u32| {
        let h = (f64::from(x) * PI / 8.0).sin() * (f64::from(y) * PI / 8.0).cos();
        [(127.5 + 127.0 * h) as u8; 3]
    };
    let normals = |x: u32, y: u32| {
        let (a, b) = (f64::from(x) * PI / 8.0, f64::from(y) * PI / 8.0);
        let n = DVec3::new(0.7 * a.sin(), 0.7 * b.sin(), 1.0).normalize();
        (n * 127.5 + 127.5).to_array().map(|c| c as u8)
    };
    let textures = texture("h", &map("waves", (16, 16), waves), "scale = [4, 2]")
        + &texture("n", &map("normals", (16, 16), normals), "scale = [4, 2]");
    let camera = Camera {
        position: DVec3::new(0.0, 1.2, 3.4),
        target: DVec3::new(0.0, 0.6, 0.0),
        fov: 40.0,
        size: 24,
    };
    let named: String = ["floor", "left", "middle", "right"]
        .iter()
        .zip(materials)
        .map(|(name, material)| format!("[materials.{name}]\n{material}\n"))
        .collect();
    camera.toml()
        + &textures
        + &named
        + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\nv = [0, 0, -4]\n\
           material = \"floor\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, -1]\nu = [4, 0, 0]\nv = [0, 3, 0]\n\
           material = \"floor\"\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [-0.9, 0.5, 0]\nradius = 0.5\n\
           material = \"left\"\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"middle\"\n\
           transform = [{ scale = [0.3, 0.6, -0.3] }, { translate = [0, 0.6, 0.3] }]\n\
           [[shapes]]\ntype = \"revolution\"\nsegments = [[[0.4, 0], [0.5, 0.6], [0.2, 1.0]], \
           [[0.2, 1.0], [0, 1.0]]]\nmaterial = \"right\"\n\
           transform = { translate = [0.9, 0, 0] }\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-0.6, 2.4, -0.6]\nu = [1.2, 0, 0]\n\
           v = [0, 0, 1.2]\nmaterial = \"black\"\nemission = 5\n"
}

/// Theory: photons scatter by the adjoint of the bent BSDF (Veach 1997, section 5.3), so all
/// methods estimate one integral, whatever bends the normal.
#[test]
fn methods_agree_on_bent_normals() {
    let cases = [
        (Method::Path, Direct::Sampled, RadiusRule::Fixed),
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Ppm, Direct::Photons, RadiusRule::Fixed),
    ];
    let diffuse = "type = \"diffuse\"\nreflectance = 0.7\nnormal_map = \"n\"";
    let bumpy = "type = \"diffuse\"\nreflectance = 0.5\nbump_map = \"h\"\nbump_height = 0.05";
    let plastic = "type = \"plastic\"\nreflectance = 0.5\nroughness = 0.4\nbump_map = \"h\"\n\
                   bump_height = -0.03";
    let metal = "type = \"metal\"\nreflectance = 0.8\nroughness = 0.6\nnormal_map = \"n\"\n\
                 normal_strength = 0.5";
    let mirror = "type = \"mirror\"\nreflectance = 0.9\nbump_map = \"h\"\nbump_height = 0.02";
    let glass = "type = \"glass\"\nior = 1.4\nnormal_map = \"n\"\nnormal_strength = 0.3";
    let mix =
        "type = \"mix\"\nmaterials = [\"left\", \"middle\"]\namount = 0.5\nnormal_map = \"n\"";
    pairwise("matte", &room([diffuse, bumpy, plastic, metal]), &cases, 0.06);
    pairwise("mirror and glass", &room([bumpy, mirror, glass, bumpy]), &cases, 0.06);
    pairwise("mix of mapped parts", &room([bumpy, diffuse, plastic, mix]), &cases, 0.06);
}

/// Theory: the same for a floor that only light from a mapped metal wall reaches.
#[test]
fn methods_agree_on_light_from_bent_reflectors() {
    let wall = "type = \"metal\"\nreflectance = 0.9\nroughness = 0.7\nnormal_map = \"n\"";
    let text = room([wall; 4]);
    let (head, _) = text.split_at(text.find("[materials.black]").unwrap());
    let camera = Camera {
        position: DVec3::new(-0.2, 2.0, 1.0),
        target: DVec3::new(-0.2, 0.0, 0.0),
        fov: 30.0,
        size: 24,
    };
    let text = camera.toml()
        + &head[head.find("[textures.h]").unwrap()..]
        + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0\n\
           [materials.white]\ntype = \"diffuse\"\nreflectance = 0.8\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\nv = [0, 0, -4]\n\
           material = \"white\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-1, 0, 1]\nu = [0, 0, -2]\nv = [0, 1.5, 0]\n\
           material = \"left\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [0.6, 0.3, -0.4]\nu = [0, 0, 0.8]\n\
           v = [0, 0.6, 0]\nmaterial = \"black\"\nemission = 9\n";
    let cases = [
        (Method::Path, Direct::Sampled, RadiusRule::Fixed),
        (Method::Sppm, Direct::Photons, RadiusRule::Fixed),
    ];
    pairwise("light from a mapped wall", &text, &cases, 0.05);
}

/// Theory: a white mapped surface under an even sky is nowhere much darker than its light, not even
/// where it is seen at grazing angles: a bent normal that faces away does not make it black.
#[test]
fn no_black_rims() {
    for (name, material) in [
        ("diffuse", "type = \"diffuse\"\nreflectance = 1\nnormal_map = \"n\""),
        ("mirror", "type = \"mirror\"\nreflectance = 1\nnormal_map = \"n\""),
        ("metal", "type = \"metal\"\nreflectance = 1\nroughness = 0.3\nnormal_map = \"n\""),
    ] {
        let text = room([material; 4]);
        let from = text.find("[materials.black]").unwrap();
        let ball = "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0.6, 0]\nradius = 0.9\n\
                    material = \"left\"\n[environment]\nradiance = 1\n";
        let text = text[..from].to_owned() + ball;
        let settings = caustica::low_level::scene::settings::RenderSettings {
            method: Method::Path,
            passes: 256,
            ..settings(0.02)
        };
        let picture = render(&parse(&text), &settings);
        let values = grey(&picture);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        println!("    {name}: least {least}, mean {mean}");
        assert!(least > 0.5 && mean > 0.9, "{name}: least {least}, mean {mean}");
    }
}
