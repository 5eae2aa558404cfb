//! Limits of single precision: warnings before the render, at the place in the file.
//!
//! Theory: each case changes one number of a sound scene. Just inside the limit there is no
//! warning; just beyond it there is one, with the number that is out of range, at the value that
//! causes it.

use caustica::low_level::prepare::limits::warnings;
use caustica::low_level::scene::{Finding, load, parse};

/// The scene's radius is half the diagonal of the box around camera, target and floor: sqrt(4 +
/// 1 + 4) = 3.
const SOUND: &str = r#"version = 1
[camera]
position = [0.0, 2.0, 0.0]
target = [0.0, 0.0, 0.0]
up = [0.0, 0.0, 1.0]
fov = 40.0
[film]
width = 64
height = 64
[render]
radius = { units = 0.01 }
[materials.grey]
type = "metal"
reflectance = 0.5
roughness = 0.5
[[shapes]]
type = "rectangle"
origin = [-2.0, 0.0, 2.0]
u = [4.0, 0.0, 0.0]
v = [0.0, 0.0, -4.0]
material = "grey"
[[shapes]]
type = "sphere"
center = [0.0, 0.5, 0.0]
radius = 0.25
material = "grey"
[[lights]]
type = "point"
position = [0.0, 1.5, 1.0]
intensity = 1.0
[[lights]]
type = "point"
position = [1.0, 1.5, 1.0]
intensity = 2.0
"#;

fn reported(text: &str) -> Vec<Finding> {
    let loaded = parse("scene.toml".as_ref(), text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
    warnings(&loaded.scene, &loaded.settings, &loaded.places)
}

/// Checks that the scene with one text replaced gives no warning with `inside`, and with `beyond`
/// one that contains `words` and stands at the line of `at`.
fn limit(from: &str, inside: &str, beyond: &str, at: &str, words: &[&str]) {
    assert_eq!(SOUND.matches(from).count(), 1, "{from}");
    let with = |to: &str| SOUND.replace(from, to);
    let quiet = reported(&with(inside));
    assert!(quiet.is_empty(), "{inside}: {quiet:?}");
    let text = with(beyond);
    let found = reported(&text);
    assert_eq!(found.len(), 1, "{beyond}: {found:?}");
    let said = format!("{} | {}", found[0].message(), found[0].label());
    for word in words {
        assert!(said.contains(word), "{beyond}: {said}");
    }
    let (line, column) = found[0].line_column().expect("a place");
    let line = text.lines().nth(line - 1).unwrap();
    assert!(line[column - 1..].starts_with(at), "{beyond}: column {column} of {line}");
}

#[test]
fn a_sound_scene_says_nothing() {
    assert!(reported(SOUND).is_empty());
    for name in [
        "caustics",
        "cornell",
        "depth-of-field",
        "materials",
        "soft-shadows",
        "still-life",
        "table",
        "water-drop",
    ] {
        let file = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let loaded = load(file.as_ref()).unwrap();
        let found = warnings(&loaded.scene, &loaded.settings, &loaded.places);
        assert!(found.is_empty(), "{name}: {found:?}");
    }
}

#[test]
fn gather_radius() {
    limit(
        "units = 0.01",
        "units = 3.1e-6",
        "units = 2.9e-6",
        "{ units",
        &["gather radius", "9.7e-7", "1e-6"],
    );
    // two pixels of 2 tan(fov / 2) / 64 at distance 2
    let beyond = "pixels = 2e-6";
    limit("units = 0.01", "pixels = 2e-3", beyond, "{ pixels", &["camera's target", "1e-6"]);
}

#[test]
fn camera_and_field_of_view() {
    // without a radius in the file the warning stands at the narrow view
    let narrow = |fov: &str| {
        let text =
            SOUND.replace("[render]\nradius = { units = 0.01 }\n", "").replace("fov = 40.0", fov);
        reported(&text).len()
    };
    assert_eq!((narrow("fov = 0.01"), narrow("fov = 0.001")), (0, 1));
    let found = reported(
        &SOUND
            .replace("[render]\nradius = { units = 0.01 }\n", "")
            .replace("fov = 40.0", "fov = 0.001"),
    );
    assert_eq!(found[0].line_column(), Some((6, 7)), "{found:?}");
    // half the distance to the camera over half the diagonal of the shapes
    let from = "position = [0.0, 2.0, 0.0]";
    let words = ["camera's distance", "times the width", "1e4"];
    let radius =
        SOUND.replace("units = 0.01", "units = 10.0").replace("radius = 0.25", "radius = 2.0");
    let at = |y: &str| reported(&radius.replace(from, &format!("position = [0.0, {y}, 0.0]")));
    assert!(at("4e4").is_empty(), "{:?}", at("4e4"));
    let found = at("8e4");
    assert_eq!(found.len(), 1, "{found:?}");
    let said = format!("{} | {}", found[0].message(), found[0].label());
    assert!(words.iter().all(|word| said.contains(word)), "{said}");
    assert_eq!(found[0].line_column(), Some((3, 12)));
}

#[test]
fn small_and_giant_shapes() {
    limit(
        "radius = 0.25",
        "radius = 1.6e-5",
        "radius = 1.4e-5",
        "1.4e-5",
        &["shapes[1]", "9.3e-6", "1e-5"],
    );
    limit(
        "radius = 0.25",
        "radius = 2.9e9",
        "radius = 3.1e9",
        "3.1e9",
        &["shapes[1]", "1.0e9", "1e9"],
    );
    let floor = "u = [4.0, 0.0, 0.0]";
    limit(floor, "u = [4e-5, 0.0, 0.0]", "u = [1e-5, 0.0, 0.0]", "[1e-5", &["shapes[0]", "1e-5"]);
    // a needle is judged by its radius; a thin plate is not
    let revolution = |profile: &str| {
        format!(
            "type = \"revolution\"\nprofile = {profile}\nmaterial = \"grey\"\n[[shapes]]\n\
             type = \"sphere\""
        )
    };
    let needle = revolution("[[1e-5, 0.0], [0.0, 1.0]]");
    limit(
        "type = \"sphere\"",
        &revolution("[[1e-4, 0.0], [0.0, 1.0]]"),
        &needle,
        "[[1e-5",
        &["shapes[1]"],
    );
    assert!(
        reported(&SOUND.replace("type = \"sphere\"", &revolution("[[1.0, 0.0], [0.0, 1e-7]]")))
            .is_empty()
    );
}

#[test]
fn far_from_the_origin() {
    let moved = |x: f64| {
        let mut text = SOUND.to_owned();
        for (key, v) in [
            ("position", [0.0, 2.0, 0.0]),
            ("target", [0.0, 0.0, 0.0]),
            ("origin", [-2.0, 0.0, 2.0]),
            ("center", [0.0, 0.5, 0.0]),
        ] {
            let line = |v: [f64; 3]| format!("{key} = {v:?}");
            assert!(text.contains(&line(v)), "{key}");
            text = text.replace(&line(v), &line([v[0] + x, v[1], v[2]]));
        }
        reported(&text)
    };
    assert!(moved(2.9e8).is_empty(), "{:?}", moved(2.9e8));
    let found = moved(3.1e8);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].message().contains("from the origin is 1.0e8 times its radius"), "{found:?}");
}

#[test]
fn lights_and_lamps() {
    limit(
        "intensity = 1.0",
        "intensity = 1.3e-7",
        "intensity = 1.1e-7",
        "1.1e-7",
        &["lights[0]", "5.5e-8", "6e-8"],
    );
    // a square lamp at height 1 over the camera's target: its diagonal over its distance
    let lamp = |side: f64| {
        format!(
            "[[shapes]]\ntype = \"rectangle\"\norigin = [{0:?}, 3.0, {0:?}]\n\
             u = [{side:?}, 0.0, 0.0]\nv = [0.0, 0.0, {side:?}]\nmaterial = \"grey\"\n\
             emission = 1.0\n[[lights]]\ntype = \"point\"\nposition = [0.0, 1.5, 1.0]",
            -0.5 * side
        )
    };
    let from = "[[lights]]\ntype = \"point\"\nposition = [0.0, 1.5, 1.0]";
    limit(from, &lamp(200.0), &lamp(220.0), "1.0", &["shapes[2] is a lamp", "1e2"]);
}

#[test]
fn smooth_metal() {
    limit(
        "roughness = 0.5",
        "roughness = 0.032",
        "roughness = 0.031",
        "0.031",
        &["materials.grey", "0.031", "0.0316"],
    );
}

/// Theory: the signed volume of a closed body is positive if its surface faces outward. A
/// tetrahedron wound inward, a drop drawn from the top down and a ring drawn the wrong way round
/// have their glass outside. The same bodies the right way round, open ones, the inner wall of a
/// hollow body, and bodies on which it does not matter give no warning.
#[test]
fn closed_bodies_that_face_inward() {
    let folder = std::env::temp_dir().join(format!("caustica-inward-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let corners = |scale: f64| format!("v 0 0 0\nv {scale} 0 0\nv 0 {scale} 0\nv 0 0 {scale}\n");
    let outward = |first: i32| {
        let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
        format!("f {a} {c} {b}\nf {a} {b} {d}\nf {a} {d} {c}\nf {b} {c} {d}\n")
    };
    let inward = |first: i32| {
        let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
        format!("f {a} {b} {c}\nf {a} {d} {b}\nf {a} {c} {d}\nf {b} {d} {c}\n")
    };
    // the inner tetrahedron, a fifth as large, lies within the outer one
    let inner = "v 0.1 0.1 0.1\nv 0.3 0.1 0.1\nv 0.1 0.3 0.1\nv 0.1 0.1 0.3\n";
    let meshes = [
        ("outward", corners(1.0) + &outward(1), false),
        ("inward", corners(1.0) + &inward(1), true),
        ("hollow", corners(1.0) + inner + &outward(1) + &inward(5), false),
        ("open", corners(1.0) + "f 1 2 3\nf 1 4 2\nf 1 3 4\n", false),
    ];
    let drop = "[[0, 0], [0.6, 0], [0.5, 0.6], [0, 1]]";
    let turned = "[[0, 1], [0.5, 0.6], [0.6, 0], [0, 0]]";
    let ring = "segments = [[[1, 0], [2, 0], [2, 1]], [[2, 1], [1, 1], [1, 0]]]";
    let wrong_ring = "segments = [[[1, 0], [1, 1], [2, 1]], [[2, 1], [2, 0], [1, 0]]]";
    let mut shapes: Vec<(String, bool)> = vec![
        (format!("type = \"revolution\"\nprofile = {drop}"), false),
        (format!("type = \"revolution\"\nprofile = {turned}"), true),
        (format!("type = \"revolution\"\n{ring}"), false),
        (format!("type = \"revolution\"\n{wrong_ring}"), true),
        ("type = \"revolution\"\nprofile = [[0.5, 1], [0.5, 0]]".to_owned(), false),
    ];
    for (name, text, warns) in meshes {
        // far from the origin as well
        let far = text.lines().map(|line| match line.strip_prefix("v ") {
            None => format!("{line}\n"),
            Some(place) => {
                let place: Vec<f64> = place.split(' ').map(|x| x.parse().unwrap()).collect();
                format!("v {:?} {:?} {:?}\n", place[0] + 5e5, place[1] + 2e5, place[2] + 3e5)
            }
        });
        let file = folder.join(format!("{name}-far.obj"));
        std::fs::write(&file, far.collect::<String>()).unwrap();
        shapes.push((
            format!("type = \"mesh\"\nfile = {:?}\nsmooth = false", file.display().to_string()),
            warns,
        ));
        let file = folder.join(format!("{name}.obj"));
        std::fs::write(&file, text).unwrap();
        shapes.push((
            format!("type = \"mesh\"\nfile = {:?}\nsmooth = false", file.display().to_string()),
            warns,
        ));
    }
    let glass = "type = \"glass\"\nior = 1.5";
    let grey = "type = \"diffuse\"\nreflectance = 0.5";
    for (shape, warns) in shapes {
        for (material, matters) in [(glass, true), (grey, false)] {
            let text = SOUND.replace(
                "[[lights]]\ntype = \"point\"\nposition = [0.0",
                &format!(
                    "[materials.body]\n{material}\n[[shapes]]\n{shape}\nmaterial = \"body\"\n\
                 [[lights]]\ntype = \"point\"\nposition = [0.0"
                ),
            );
            let found: Vec<_> = reported(&text)
                .into_iter()
                .filter(|finding| finding.to_string().contains("inward"))
                .collect();
            assert_eq!(found.len(), usize::from(warns && matters), "{shape} {material}: {found:?}");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
