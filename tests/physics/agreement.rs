//! All methods on one scene with every shape, material and light.

use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::invariance::everything;
use super::lab::*;

pub type Case = (Method, Direct, RadiusRule);

const PATH: Case = (Method::Path, Direct::Sampled, RadiusRule::Fixed);

/// Renders `text` in every case and compares all pairs: the whole image to `power`, tiles to four
/// times that.
pub fn pairwise(name: &str, text: &str, cases: &[Case], power: f64) {
    let found: Vec<(String, Runs)> = cases
        .iter()
        .map(|&(method, direct, radius_rule)| {
            let settings = RenderSettings {
                method,
                direct,
                radius_rule,
                passes: 4,
                photons: 1 << 14,
                max_bounces: 24,
                // independent random numbers, or the methods would agree too well
                seed: 100 * (method as u64 * 9 + direct as u64 * 3 + radius_rule as u64),
                ..settings(0.02)
            };
            (format!("{method:?} {direct:?} {radius_rule:?}"), runs_to(power, text, &settings))
        })
        .collect();
    for (i, (one, a)) in found.iter().enumerate() {
        for (other, b) in &found[..i] {
            assert_regions(&format!("{name}: {one} and {other}"), a, b, power);
        }
    }
}

/// Theory: PPM and SPPM with every radius rule, with direct light sampled or by photons, estimate
/// one integral, so their images agree pairwise and region by region. Discs of radius 0.02 blur and
/// lose light at edges and corners, all alike at first and less under rules that shrink them; that
/// bias lies within the required noise.
#[test]
fn photon_mapping_agrees_pairwise() {
    let cases = [
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Ppm, Direct::Photons, RadiusRule::Fixed),
        (Method::Ppm, Direct::Sampled, RadiusRule::Local),
        (Method::Sppm, Direct::Photons, RadiusRule::Local),
    ];
    pairwise("everything", &everything(1.0, DVec3::ZERO, 24), &cases, 0.06);
}

/// Theory: path tracing finds all light except that of a point, a spot or a sun via mirrors and
/// glass. With matte bodies instead, it agrees with photon mapping under all lights.
#[test]
fn path_tracing_agrees_on_matte_bodies() {
    let full = everything(1.0, DVec3::ZERO, 24);
    let (from, to) =
        (full.find("[materials.chrome]").unwrap(), full.find("[materials.black]").unwrap());
    let matte = "[materials.chrome]\ntype = \"diffuse\"\nreflectance = 0.5\n[materials.glass]\n\
                 type = \"metal\"\nreflectance = 0.8\nroughness = 0.7\n";
    let text = format!("{}{matte}{}", &full[..from], &full[to..]);
    let cases = [
        PATH,
        (Method::Path, Direct::Photons, RadiusRule::Fixed),
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Ppm, Direct::Photons, RadiusRule::Global),
    ];
    // without shadow rays a path never meets a point, a spot or a sun
    pairwise("matte", &text, &[cases[0], cases[2], cases[3]], 0.06);
    let lamps = &text[..text.find("[[lights]]").unwrap()];
    let sky = &text[text.find("[environment]").unwrap()..];
    pairwise("matte, lamp and sky", &format!("{lamps}{sky}"), &cases[..3], 0.06);
}

/// Theory: the same with mirrors and glass under lights that have an extent.
#[test]
fn path_tracing_agrees_under_lamp_and_sky() {
    let full = everything(1.0, DVec3::ZERO, 24);
    let text = format!(
        "{}{}",
        &full[..full.find("[[lights]]").unwrap()],
        &full[full.find("[environment]").unwrap()..]
    );
    let cases = [
        PATH,
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Ppm, Direct::Photons, RadiusRule::Local),
    ];
    pairwise("lamp and sky", &text, &cases, 0.06);
}

/// Theory: path tracing with shadow rays combines both ways to reach a light with weights that sum
/// to one, so it gives the image of path tracing without shadow rays. The weights contain the
/// probability of the light at that point, which differs between the floor below a wide lamp and
/// the floor below the sky.
#[test]
fn weights_follow_the_light_probabilities_of_each_place() {
    let text = "version = 1\n[camera]\nposition = [0, 9, 0.01]\ntarget = [0, 0, 0]\nfov = 40.0\n\
                [film]\nwidth = 12\n\
                height = 12\n[materials.floor]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                [materials.black]\n\
                type = \"diffuse\"\nreflectance = 0.0\n[[shapes]]\ntype = \"rectangle\"\n\
                origin = [-4, 0, 4]\n\
                u = [8, 0, 0]\nv = [0, 0, -8]\nmaterial = \"floor\"\n[[shapes]]\n\
                type = \"rectangle\"\n\
                origin = [0.3, 1.0, -4]\nu = [0, 0, 8]\nv = [0, 3, 0]\nmaterial = \"black\"\n\
                emission = 2.0\n\
                [environment]\nradiance = 0.5\n";
    let by = |direct| {
        let path = RenderSettings { method: Method::Path, direct, passes: 1500, ..settings(1.0) };
        runs(text, &RenderSettings { seed: 1000 * direct as u64, ..path })
    };
    let [shadow_rays, scattering] = DIRECT.map(by);
    for (side, columns) in [("sky", 8..12), ("lamp", 0..4)] {
        let [a, b] =
            [&shadow_rays, &scattering].map(|runs| runs.region(|x, _| columns.contains(&x)));
        assert_same(side, a, b, 0.015);
    }
}

/// A metal floor on which a glass ball focuses light, two balls of narrow metal, and a mirror.
const NARROW: &str = r#"version = 1
[camera]
position = [0.0, 1.6, 3.0]
target = [0.0, 0.3, 0.0]
fov = 36.0
[film]
width = 24
height = 24
[materials.floor]
type = "metal"
reflectance = 0.8
roughness = 0.28
[materials.polished]
type = "metal"
reflectance = [0.9, 0.7, 0.4]
roughness = 0.2
[materials.wall]
type = "diffuse"
reflectance = [0.4, 0.5, 0.6]
[materials.glass]
type = "glass"
ior = 1.5
[materials.mirror]
type = "mirror"
reflectance = 0.9
[[shapes]]
type = "rectangle"
origin = [-1.5, 0.0, 1.5]
u = [3.0, 0.0, 0.0]
v = [0.0, 0.0, -3.0]
material = "floor"
[[shapes]]
type = "rectangle"
origin = [-1.5, 0.0, -1.5]
u = [3.0, 0.0, 0.0]
v = [0.0, 3.0, 0.0]
material = "wall"
[[shapes]]
type = "rectangle"
origin = [-1.5, 0.0, 1.5]
u = [0.0, 0.0, -3.0]
v = [0.0, 1.5, 0.0]
material = "mirror"
[[shapes]]
type = "sphere"
center = [0.0, 0.75, 0.0]
radius = 0.3
material = "glass"
[[shapes]]
type = "sphere"
center = [-0.7, 0.35, 0.2]
radius = 0.35
material = "polished"
[[shapes]]
type = "sphere"
center = [0.7, 0.35, 0.2]
radius = 0.35
material = "polished"
[[shapes]]
type = "rectangle"
origin = [-0.4, 2.8, -0.4]
u = [0.8, 0.0, 0.0]
v = [0.0, 0.0, 0.8]
material = "wall"
emission = 6.0
"#;

/// Theory: eye paths that continue at narrow lobes, together with the photons that only they gather
/// there, estimate the integral of path tracing, and under a point light, whose caustics path
/// tracing cannot find, that of PPM, which gathers all photons at the first rough surface.
#[test]
fn narrow_lobes_agree() {
    let sppm = |direct, rule| (Method::Sppm, direct, rule);
    let cases =
        [PATH, sppm(Direct::Sampled, RadiusRule::Global), sppm(Direct::Photons, RadiusRule::Local)];
    pairwise("narrow lobes, lamp", NARROW, &cases, 0.05);
    let point = "[[lights]]\ntype = \"point\"\nposition = [0.3, 2.2, 0.4]\nintensity = 4.0\n";
    let cases = [
        (Method::Ppm, Direct::Sampled, RadiusRule::Fixed),
        sppm(Direct::Sampled, RadiusRule::Global),
        sppm(Direct::Photons, RadiusRule::Fixed),
    ];
    pairwise("narrow lobes, point", &format!("{NARROW}{point}"), &cases, 0.05);
}
