//! Image layers (AOVs).
//!
//! Theory: in scenes of planes the first hit, and the first hit behind a mirror or a pane, are
//! known in closed form. A mirror multiplies the albedo by its reflectance. A pane of index n seen
//! head-on transmits (1 - R) / (1 + R), with the Fresnel reflectance R of a face. If all surfaces
//! are black, the image is emission only. A window of an image has the same bits whether it is
//! rendered alone or with the rest.

mod parts;

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::double;
use caustica::low_level::engine::MeasuredEngine;
use caustica::low_level::film::exr_file::{Channel, Numbers};
use caustica::low_level::film::{Picture, Plane};
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::layers::NO_DEPTH;
use caustica::low_level::plan::{Buffer, Plan, Stage};
use caustica::low_level::scene::{Aovs, Loaded, parse};

/// A camera at (1, 2, 4) that looks along -z, with an image of 24 by 16 pixels.
const HEAD: &str = r#"
version = 1
[camera]
position = [1.0, 2.0, 4.0]
target = [1.0, 2.0, 0.0]
fov = 30.0
[materials.red]
type = "diffuse"
reflectance = [0.8, 0.3, 0.1]
[[lights]]
type = "point"
position = [1.0, 3.0, 3.0]
intensity = [9.0, 9.0, 9.0]
"#;

/// A wall at z = -1 that fills the view.
const WALL: &str = r#"
[[shapes]]
type = "rectangle"
origin = [-9.0, -9.0, -1.0]
u = [20.0, 0.0, 0.0]
v = [0.0, 20.0, 0.0]
material = "red"
"#;

fn loaded(settings: &str, rest: &str) -> Loaded {
    let film = "[film]\nwidth = 24\nheight = 16\n\
                aov = [\"albedo\", \"normal\", \"depth\", \"position\", \"object\", \
                \"material\", \"emission\", \"direct\", \"caustic\", \"indirect\", \"radius\", \"photons\", \
                \"variance\"]\n";
    let photons = if settings.contains("photons =") { "" } else { "photons = 500\n" };
    let text = format!("{HEAD}{film}[render]\n{photons}{settings}\n{rest}");
    parse("aovs.toml".as_ref(), text.as_bytes())
        .unwrap_or_else(|e| panic!("{:?}\n{text}", miette::Report::new(e)))
}

fn planned(loaded: &Loaded) -> (PackedScene, Plan) {
    let film = &loaded.scene.film;
    let packed = prepare(&loaded.scene, film.width, film.height).unwrap();
    let plan = Plan::probed(&packed, &loaded.settings).on(film);
    (packed, plan)
}

struct Seen {
    picture: Picture,
    layers: Vec<Channel>,
    gathered: u64,
}

impl Seen {
    fn by(mut engine: impl MeasuredEngine, passes: u32) -> Self {
        for _ in 0..passes {
            engine.pass().unwrap();
        }
        Self {
            picture: engine.picture().unwrap(),
            layers: engine.layers().unwrap(),
            gathered: engine.gathered().unwrap(),
        }
    }

    fn of(settings: &str, rest: &str, passes: u32) -> Self {
        let (packed, plan) = planned(&loaded(settings, rest));
        Self::by(CpuEngine::new(packed, plan), passes)
    }

    fn plane(&self, name: &str) -> &Plane {
        let found = self.layers.iter().find(|layer| layer.name == name);
        &found.unwrap_or_else(|| panic!("no layer {name}")).plane
    }

    /// Values of several layers in one pixel.
    fn at<const N: usize>(&self, names: [&str; N], x: usize, y: usize) -> [f64; N] {
        names.map(|name| self.plane(name).values[y * self.picture.width as usize + x])
    }
}

const ALBEDO: [&str; 3] = ["albedo.R", "albedo.G", "albedo.B"];
const NORMAL: [&str; 3] = ["normal.X", "normal.Y", "normal.Z"];
const POSITION: [&str; 3] = ["position.X", "position.Y", "position.Z"];

fn near<const N: usize>(found: [f64; N], expected: [f64; N], tolerance: f64) -> bool {
    found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= tolerance)
}

#[test]
fn a_wall_is_where_it_is() {
    let seen = Seen::of("", WALL, 3);
    let names: Vec<&str> = seen.layers.iter().map(|layer| layer.name).collect();
    let expected = [&ALBEDO[..], &NORMAL, &["depth.Z"], &POSITION, &["object.ID", "material.ID"]];
    let parts = parts::PARTS.concat();
    assert_eq!(names, [&expected.concat()[..], &parts, &["radius.Y", "photons.Y"]].concat());
    let pixel = 2.0 * 5.0 * (15.0f64).to_radians().tan() / 16.0;
    for y in 0..16 {
        for x in 0..24 {
            assert!(near(seen.at(ALBEDO, x, y), [0.8, 0.3, 0.1], 1e-6));
            assert!(near(seen.at(NORMAL, x, y), [0.0, 0.0, 1.0], 1e-6));
            assert!(near(seen.at(["depth.Z"], x, y), [5.0], 1e-5));
            assert_eq!(seen.at(["object.ID", "material.ID"], x, y), [1.0, 1.0]);
            // the mean position of the samples lies in the pixel
            let middle = [1.0 + (x as f64 - 11.5) * pixel, 2.0 - (y as f64 - 7.5) * pixel];
            let [px, py, pz] = seen.at(POSITION, x, y);
            assert!(
                near([px, py], middle, 0.51 * pixel) && (pz + 1.0).abs() < 1e-5,
                "{px} {py} {pz}"
            );
        }
    }
    // the comparison rejects another wall and another pixel
    assert!(!near(seen.at(POSITION, 3, 5), seen.at(POSITION, 5, 5), 0.51 * pixel));
    let moved = Seen::of("", &WALL.replace("-9.0, -1.0]", "-9.0, -1.001]"), 3);
    assert!(!near(moved.at(["depth.Z"], 3, 5), [5.0], 1e-5));
}

/// A mirror at 45 degrees shows the ceiling. Albedo and normal are those of the ceiling, everything
/// else those of the mirror.
#[test]
fn a_mirror_shows_what_it_reflects() {
    let rest = r#"
    [materials.silver]
    type = "mirror"
    reflectance = [0.9, 0.8, 0.7]
    [[shapes]]
    type = "rectangle"
    origin = [-9.0, -8.0, 10.0]
    u = [20.0, 0.0, 0.0]
    v = [0.0, 20.0, -20.0]
    material = "silver"
    [[shapes]]
    type = "plane"
    point = [0.0, -9.0, 0.0]
    normal = [0.0, 1.0, 0.0]
    material = "red"
    [[shapes]]
    type = "plane"
    point = [0.0, 30.0, 0.0]
    normal = [0.0, 1.0, 0.0]
    material = "red"
    "#;
    let seen = Seen::of("", rest, 4);
    let expected = [0.8 * 0.9, 0.3 * 0.8, 0.1 * 0.7];
    let middle = (12, 8);
    assert!(
        near(seen.at(ALBEDO, middle.0, middle.1), expected, 1e-6),
        "{:?}",
        seen.at(ALBEDO, 12, 8)
    );
    assert!(
        near(seen.at(NORMAL, middle.0, middle.1), [0.0, -1.0, 0.0], 1e-6),
        "{:?}",
        seen.at(NORMAL, 12, 8)
    );
    // the mirror's plane is y + z = 2
    let [_, y, z] = seen.at(POSITION, middle.0, middle.1);
    assert!((y + z - 2.0).abs() < 1e-5, "{y} {z}");
    assert!(near(seen.at(["depth.Z"], middle.0, middle.1), [4.0 - z], 1e-5));
    assert_eq!(seen.at(["object.ID", "material.ID"], middle.0, middle.1), [1.0, 2.0]);
}

/// Apart from light straight through a pane, the dark space behind the camera adds nothing.
#[test]
fn a_pane_dims_what_is_behind_it() {
    let pane = r#"
    [materials.pane]
    type = "glass"
    ior = 1.5
    [[shapes]]
    type = "box"
    min = [-9.0, -9.0, 0.0]
    max = [11.0, 11.0, 0.1]
    material = "pane"
    "#;
    let passes = 400;
    let seen = Seen::of("direct = \"sampled\"\nmax_bounces = 64", &format!("{WALL}{pane}"), passes);
    let faces: f64 = 0.04;
    let through = (1.0 - faces) / (1.0 + faces);
    let mean = |name: &str| seen.plane(name).values.iter().sum::<f64>() / (24.0 * 16.0);
    // three standard errors of a share, and the higher reflectance of views up to 21 degrees off
    // the axis
    let tolerance =
        3.0 * (through * (1.0 - through) / (24.0 * 16.0 * f64::from(passes))).sqrt() + 1e-3;
    for (name, reflectance) in ALBEDO.iter().zip([0.8, 0.3, 0.1]) {
        let share = mean(name) / reflectance;
        assert!(
            (share - through).abs() < tolerance,
            "{name}: {share}, {through} within {tolerance}"
        );
    }
    assert!((mean("normal.Z") - through).abs() < tolerance, "{}", mean("normal.Z"));
    // the tolerance excludes one face and no face
    assert!((0.96 - through).abs() > tolerance && 1.0 - through > tolerance);
    assert!(near(seen.at(["depth.Z"], 12, 8), [3.9], 1e-5), "the first hit is the pane's");
    assert_eq!(seen.at(["object.ID", "material.ID"], 12, 8), [2.0, 1.0]);
}

/// In black surroundings the image is the light that lamps send to the eye.
#[test]
fn emission_is_all_of_a_dark_picture() {
    let rest = r#"
    [materials.black]
    type = "diffuse"
    reflectance = 0.0
    [materials.silver]
    type = "mirror"
    reflectance = 0.5
    [environment]
    radiance = [0.1, 0.2, 0.3]
    [[shapes]]
    type = "sphere"
    center = [1.3, 2.2, -1.0]
    radius = 0.6
    material = "black"
    emission = [3.0, 2.0, 1.0]
    [[shapes]]
    type = "sphere"
    center = [0.2, 1.7, 0.0]
    radius = 0.5
    material = "silver"
    "#;
    for settings in ["", "method = \"ppm\"\neye_samples = 6", "method = \"path\""] {
        let seen = Seen::of(settings, rest, 5);
        let names = ["emission.R", "emission.G", "emission.B"];
        let mut lit = 0;
        for (i, rgb) in seen.picture.rgb.iter().enumerate() {
            let emission = seen.at(names, i % 24, i / 24);
            let expected = rgb.map(f64::from);
            // path tracing draws the roulette in another order
            assert!(
                near(emission, expected, 1e-5),
                "{settings}, pixel {i}: {emission:?} and {expected:?}"
            );
            lit += (rgb[0] > 1.0) as usize;
        }
        assert!(lit > 20, "{settings}: the lamp is in view: {lit}");
        let misses = seen.plane("depth.Z").values.iter().filter(|z| **z == NO_DEPTH).count();
        let none = seen.plane("object.ID").values.iter().filter(|id| **id == 0.0).count();
        assert!(misses > 50 && none >= misses, "{misses} {none}");
    }
}

/// Indices follow the order of the file, whatever the order of the tables; a mesh is one surface.
#[test]
fn numbers_are_those_of_the_file() {
    let sphere = |x: f64| {
        format!(
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{x}, 2.0, 0.0]\nradius = 0.3\n\
             material = \"red\"\n"
        )
    };
    let cube = "[[shapes]]\ntype = \"mesh\"\nfile = \"tests/data/cube.obj\"\nmaterial = \"blue\"\n\
                transform = { scale = 0.25, translate = [1.0, 2.0, 0.0] }\n";
    let blue = "[materials.blue]\ntype = \"diffuse\"\nreflectance = 0.5\n";
    let rest = format!("{blue}{}{cube}{WALL}{}", sphere(0.2), sphere(1.8));
    let seen = Seen::of("", &rest, 1);
    let ids = |x: usize| seen.at(["object.ID", "material.ID"], x, 8);
    // materials are numbered in the order of their names
    assert_eq!(
        [ids(6), ids(12), ids(18), ids(0)],
        [[1.0, 2.0], [2.0, 1.0], [4.0, 2.0], [3.0, 2.0]]
    );
    let whole: Vec<&str> = seen
        .layers
        .iter()
        .filter(|l| l.numbers == Numbers::Whole)
        .map(|layer| layer.name)
        .collect();
    assert_eq!(whole, ["object.ID", "material.ID"]);
}

#[test]
fn radius_and_photons_are_those_of_the_last_pass() {
    let fixed = Seen::of(
        "radius = { units = 0.25 }\nradius_rule = \"fixed\"\ndirect = \"photons\"",
        WALL,
        3,
    );
    assert!(fixed.plane("radius.Y").values.iter().all(|r| (r - 0.25).abs() < 1e-6));
    let counted: f64 = fixed.plane("photons.Y").values.iter().sum();
    assert!(
        counted > 100.0 && counted == fixed.gathered as f64,
        "{counted} and {}",
        fixed.gathered
    );
    let global = Seen::of("radius = { units = 0.25 }\nalpha = 0.5\ndirect = \"photons\"", WALL, 3);
    // the first two passes leave (1 + 1/2) / 2 and (2 + 1/2) / 3 of the squared radius
    let expected = 0.25 * (0.75f64 * 2.5 / 3.0).sqrt();
    assert!(global.plane("radius.Y").values.iter().all(|r| (r - expected).abs() < 1e-6));
    let local = Seen::of(
        "radius = { units = 0.25 }\nradius_rule = \"local\"\ndirect = \"photons\"",
        WALL,
        3,
    );
    let radii = &local.plane("radius.Y").values;
    assert!(radii.iter().all(|r| *r > 0.1 && *r <= 0.25 + 1e-6) && radii.iter().any(|r| *r < 0.24));
}

/// Layers that are not requested are neither planned nor stored, and requested layers change no bit
/// of the image.
#[test]
fn it_costs_nothing_unless_asked_for() {
    let mut plain = loaded("", WALL);
    let with = Seen::of("", WALL, 2);
    plain.scene.film.aovs = Aovs::default();
    let (packed, plan) = planned(&plain);
    assert!(plan.steps(0).iter().all(|step| step.stage != Stage::AovTrace));
    assert!(plan.buffers().iter().all(|(buffer, _)| *buffer != Buffer::Aovs));
    let without = Seen::by(CpuEngine::new(packed, plan), 2);
    assert!(without.layers.is_empty());
    assert_eq!(without.picture, with.picture);
    // layers without a separate kernel run none
    plain.scene.film.aovs = Aovs::parse("photons,variance").unwrap();
    let (_, plan) = planned(&plain);
    assert!(plan.steps(0).iter().all(|step| step.stage != Stage::AovTrace));
}

/// The f64 engine gives the same up to rounding.
#[test]
fn both_precisions_agree() {
    let rest = format!(
        "[materials.pane]\ntype = \"glass\"\nior = 1.5\n[[shapes]]\ntype = \"sphere\"\n\
         center = [1.0, 2.0, 0.0]\n\
         radius = 0.7\nmaterial = \"pane\"\n{WALL}"
    );
    let loaded = loaded("", &rest);
    let single = Seen::of("", &rest, 2);
    let packed = double::pilots::prepare(&loaded.scene, 24, 16).unwrap();
    let plan = double::plan::Plan::probed(&packed, &loaded.settings).on(&loaded.scene.film);
    let double = Seen::by(double::cpu::CpuEngine::new(packed, plan), 2);
    for (a, b) in single.layers.iter().zip(&double.layers).filter(|(a, _)| a.name != "photons.Y") {
        let unlike =
            a.plane.values.iter().zip(&b.plane.values).filter(|(a, b)| (*a - *b).abs() > 1e-3);
        let unlike = unlike.count();
        assert!(unlike <= 6, "{}: {unlike} pixels", a.name);
    }
}

/// Bits of the pixels and layers of a window.
fn window_of(seen: &Seen, [x0, y0, x1, y1]: [u32; 4]) -> Vec<u64> {
    let width = seen.picture.width;
    let places = || (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y * width + x) as usize));
    let pixels = places().flat_map(|i| seen.picture.rgb[i]).map(|value| u64::from(value.to_bits()));
    let layers =
        seen.layers.iter().flat_map(|layer| places().map(|i| layer.plane.values[i].to_bits()));
    pixels.chain(layers).collect()
}

#[test]
fn a_window_has_the_bits_of_the_whole() {
    let rest = format!(
        "[materials.pane]\ntype = \"glass\"\nior = 1.5\n[[shapes]]\ntype = \"sphere\"\n\
         center = [1.0, 2.0, 0.0]\n\
         radius = 0.7\nmaterial = \"pane\"\n{WALL}"
    );
    let window = [5, 3, 16, 14];
    for (settings, software) in [
        ("", true),
        ("method = \"ppm\"\neye_samples = 4\nradius_rule = \"local\"", true),
        ("method = \"path\"", false),
    ] {
        let mut loaded = loaded(settings, &rest);
        let (packed, plan) = planned(&loaded);
        let whole = Seen::by(CpuEngine::new(packed, plan), 3);
        loaded.scene.film.window = Some(window);
        let (packed, plan) = planned(&loaded);
        // the same in several chunks
        let cut = Plan { chunk_points: plan.eye_samples * 40, ..plan.clone() };
        let expected = window_of(&whole, window);
        let alone = [0, 0, 11, 11];
        for plan in [&plan, &cut] {
            let part = Seen::by(CpuEngine::new(packed.clone(), plan.clone()), 3);
            assert_eq!((part.picture.width, part.picture.height), (11, 11));
            assert!(window_of(&part, alone) == expected, "{settings}");
        }
        if software {
            let engine = GpuEngine::new(&crate::support::software(), &packed, cut).unwrap();
            assert!(window_of(&Seen::by(engine, 3), alone) == expected, "{settings}");
        }
        assert!(
            window_of(&whole, [6, 3, 17, 14]) != expected,
            "the comparison sees a column's shift"
        );
    }
}
