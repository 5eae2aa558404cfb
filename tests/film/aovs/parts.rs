//! The image split by the light's path.
//!
//! Theory: each path to the eye belongs to one part, so the parts sum to the image.

use super::{Seen, WALL};

pub const PARTS: [[&str; 3]; 4] = [
    ["emission.R", "emission.G", "emission.B"],
    ["direct.R", "direct.G", "direct.B"],
    ["caustic.R", "caustic.G", "caustic.B"],
    ["indirect.R", "indirect.G", "indirect.B"],
];

/// An area lamp, a glass ball, a metal wall and a white floor, which together produce every kind of
/// path.
const WAYS: &str = r#"
[materials.pane]
type = "glass"
ior = 1.5
[materials.gold]
type = "metal"
reflectance = [0.9, 0.7, 0.3]
roughness = 0.4
[[shapes]]
type = "sphere"
center = [1.0, 2.0, 0.5]
radius = 0.4
material = "pane"
[[shapes]]
type = "rectangle"
origin = [-2.0, 1.2, 2.0]
u = [6.0, 0.0, 0.0]
v = [0.0, 0.0, -6.0]
material = "red"
[[shapes]]
type = "rectangle"
origin = [-0.6, 1.2, -3.0]
u = [0.0, 0.0, 6.0]
v = [0.0, 4.0, 0.0]
material = "gold"
[[shapes]]
type = "sphere"
center = [1.9, 2.6, -0.5]
radius = 0.15
material = "red"
emission = [8.0, 9.0, 10.0]
"#;

/// Largest difference in any channel between the sum of the parts and the image, relative to the
/// image where it exceeds 0.01.
fn off(seen: &Seen, parts: &[[&str; 3]]) -> f64 {
    let pixels = seen.picture.rgb.iter().enumerate().flat_map(|(i, rgb)| {
        (0..3).map(move |c| {
            let sum: f64 = parts.iter().map(|part| seen.plane(part[c]).values[i]).sum();
            (sum - f64::from(rgb[c])).abs() / f64::from(rgb[c]).max(0.01)
        })
    });
    pixels.fold(0.0, f64::max)
}

/// The metal gathers photons in the first scene; in the others its lobe is narrow, so that paths
/// continue there, with and without a light that they cannot find, and a sky.
#[test]
fn the_parts_are_all_of_the_picture() {
    let wide = format!("{WALL}{WAYS}");
    let narrow = wide.replace("roughness = 0.4", "roughness = 0.2");
    let point = "[[lights]]\ntype = \"point\"\nposition = [1.0, 2.6, 1.5]\nintensity = 3.0\n\
                 [environment]\nradiance = 0.3\n";
    assert_ne!(wide, narrow);
    are_all(&wide);
    are_all(&narrow);
    are_all(&format!("{narrow}{point}"));
}

fn are_all(wall: &str) {
    for settings in [
        "",
        "radius = { pixels = 2.0 }",
        "radius_rule = \"local\"\nindirect_radius = 3.0",
        "method = \"ppm\"\neye_samples = 4\nradius_rule = \"local\"",
        "direct = \"photons\"",
    ] {
        let seen = Seen::of(settings, wall, 6);
        // each part is a mean in f32 over six passes
        assert!(off(&seen, &PARTS) < 2e-5, "{settings}: {}", off(&seen, &PARTS));
        for missing in PARTS {
            let others: Vec<[&str; 3]> =
                PARTS.into_iter().filter(|part| *part != missing).collect();
            let empty = missing[0] == "direct.R" && settings.contains("\"photons\"");
            assert_eq!(off(&seen, &others) < 2e-5, empty, "{settings}: without {}", missing[0]);
        }
    }
}

/// A wall alone receives direct light only, and a glass ball casts its caustic inside its shadow.
#[test]
fn light_is_told_by_its_way() {
    let alone = Seen::of("", WALL, 3);
    assert!(off(&alone, &PARTS[1..2]) < 2e-5);
    let ball = WAYS
        .split("[[shapes]]")
        .nth(1)
        .unwrap()
        .replace("0.5]", "1.6]")
        .replace("2.0, 1.6", "2.4, 1.6");
    let materials = WAYS.split("[[shapes]]").next().unwrap();
    // photons scattered by the wall are indirect, even if they meet the ball afterwards
    let rest = format!("{materials}[[shapes]]{ball}{WALL}");
    let rest = rest.replace(
        "[materials.gold]\ntype = \"metal\"\nreflectance = [0.9, 0.7, 0.3]\nroughness = 0.4\n",
        "",
    );
    let seen = Seen::of("photons = 20000\nradius = { pixels = 2.0 }", &rest, 3);
    let sum = |part: usize| seen.plane(PARTS[part][1]).values.iter().sum::<f64>();
    assert!(sum(0) == 0.0 && sum(1) > 0.0 && sum(2) > 0.0, "{} {} {}", sum(0), sum(1), sum(2));
    assert!(sum(3) < 0.2 * sum(2), "{} and {}", sum(3), sum(2));
    // where no shadow ray reaches the lamp, only the caustic remains
    let (direct, caustic) = (&seen.plane(PARTS[1][1]).values, &seen.plane(PARTS[2][1]).values);
    let shadow: Vec<usize> = (0..direct.len()).filter(|i| direct[*i] == 0.0).collect();
    let inside = shadow.iter().map(|i| caustic[*i]).sum::<f64>();
    assert!(
        shadow.len() > 5 && inside > 0.3 * sum(2),
        "{} pixels, {inside} of {}",
        shadow.len(),
        sum(2)
    );
}
