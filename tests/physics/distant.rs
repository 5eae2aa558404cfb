//! Theory: distant geometry does not affect the image or its noise: neither wide floors, nor
//! distant objects, nor the distance of the camera, its target and its focus.

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::settings::{Method, Radius, RenderSettings};
use caustica::low_level::validation::{NoisyTruth, Promise, promises};

use super::lab::*;

const SIZE: u32 = 24;
/// Largest ratio of the noise with distant objects to the noise without.
const MOST: f64 = 1.5;

/// Distances in a scene around the origin.
#[derive(Clone, Copy)]
struct Far {
    name: &'static str,
    /// Half the width of the floor.
    floor: f64,
    /// Distance of the camera from the origin; it sees the same part of the floor from everywhere.
    camera: f64,
    /// Distance of the camera's target, which lies on the same line as the origin.
    target: f64,
    /// Further camera settings.
    lens: &'static str,
    /// Centre of a ball out of sight.
    stray: Option<[f64; 3]>,
}

const HERE: Far = Far { name: "here", floor: 3.0, camera: 4.0, target: 4.0, lens: "", stray: None };

/// A wide floor, a distant camera, a distant focus or target, a distant object: each alone and all
/// together.
fn far() -> Vec<Far> {
    vec![
        Far { name: "floor 100", floor: 1e2, ..HERE },
        Far { name: "floor 1e4", floor: 1e4, ..HERE },
        Far { name: "camera 100", camera: 1e2, target: 1e2, ..HERE },
        Far { name: "camera 1e4", camera: 1e4, target: 1e4, ..HERE },
        Far { name: "focus", lens: "focus = 1000.0", ..HERE },
        Far { name: "target", target: 5e3, ..HERE },
        Far { name: "stray ball", stray: Some([0.0, 0.0, -2000.0]), ..HERE },
        Far { name: "stray ball above", stray: Some([3e3, 9e3, 1e4]), ..HERE },
        Far {
            name: "all",
            floor: 1e4,
            camera: 400.0,
            target: 2e3,
            lens: "focus = 1000.0",
            stray: Some([-5e3, 20.0, 800.0]),
        },
    ]
}

/// The scene file of these distances and of `near`, on a floor of reflectance 1/2.
fn scene(far: &Far, near: &str) -> String {
    let Far { floor, camera, target, lens, stray, .. } = *far;
    // looking at the origin from above
    let (y, z) = (0.8 * camera, 0.6 * camera);
    let (ty, tz) = (0.8 * (camera - target), 0.6 * (camera - target));
    let fov = 2.0 * (0.8f64 / camera).atan().to_degrees();
    let stray = stray.map_or(String::new(), |[x, y, z]| {
        format!(
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{x:?}, {y:?}, {z:?}]\nradius = 0.5\n\
             material = \"floor\"\n"
        )
    });
    format!(
        "version = 1\n[camera]\nposition = [0.0, {y:?}, {z:?}]\ntarget = [0.0, {ty:?}, {tz:?}]\n\
         fov = {fov:?}\n{lens}\n[film]\nwidth = {SIZE}\nheight = {SIZE}\n\
         [materials.floor]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [materials.glass]\ntype = \"glass\"\nior = 1.5\n\
         [materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [{0:?}, 0.0, {floor:?}]\n\
         u = [{1:?}, 0.0, 0.0]\n\
         v = [0.0, 0.0, {2:?}]\nmaterial = \"floor\"\n{near}\n{stray}",
        -floor,
        2.0 * floor,
        -2.0 * floor
    )
}

/// Root mean square over the pixels of the deviation between runs, relative as in relMSE.
fn noise(runs: &Runs) -> f64 {
    let pixels = runs.pixels[0].len();
    let sum: f64 = (0..pixels)
        .map(|i| {
            let values: Vec<f64> = runs.pixels.iter().map(|p| p[i]).collect();
            let Estimate { mean, error } = Estimate::of(&values);
            error * error * RUNS as f64 / (mean * mean + 0.01)
        })
        .sum();
    (sum / pixels as f64).sqrt()
}

fn some_passes(method: Method) -> RenderSettings {
    RenderSettings { method, passes: 8, photons: 1 << 14, ..settings(0.04) }
}

/// A sun over a ball of glass.
const SUN: &str = "[[shapes]]\ntype = \"sphere\"\ncenter = [0.0, 0.45, 0.0]\nradius = 0.2\n\
                   material = \"glass\"\n[[lights]]\ntype = \"sun\"\ndirection = [0.3, -1.0, 0.2]\n\
                   irradiance = 3.0";
/// A small lamp and a dim sky.
const LAMP_AND_SKY: &str = "[[shapes]]\ntype = \"sphere\"\ncenter = [0.0, 0.3, 0.0]\nradius = 0.3\n\
                            material = \"floor\"\n[[shapes]]\ntype = \"sphere\"\n\
                            center = [0.6, 1.8, -0.5]\nradius = 0.05\nmaterial = \"black\"\n\
                            emission = 100.0\n[environment]\nradiance = 0.1";

/// Theory: a sun over a wide floor gives E = irradiance * cos everywhere, and the ball of glass
/// moves light from its shadow to the caustic. None of this depends on distant geometry, so neither
/// do the mean of the image (except for the camera's weak perspective) and the noise.
#[test]
fn caustic_of_a_sun() {
    compare(SUN, Method::Sppm, 0.01);
}

/// Theory: the same holds for a small lamp and a dim sky. Shares by power would depend on how much
/// of the sky the world catches; the lights' contributions to the image do not.
#[test]
fn lamp_and_dim_sky() {
    for method in [Method::Sppm, Method::Path] {
        compare(LAMP_AND_SKY, method, 0.03);
    }
}

fn compare(near: &str, method: Method, power: f64) {
    let here = runs(&scene(&HERE, near), &some_passes(method));
    let (least, mean) = (noise(&here), here.region(|_, _| true));
    println!("{method:?} here: noise {least:.4}, mean {:.5}", mean.mean);
    for far in far() {
        let there = runs(&scene(&far, near), &some_passes(method));
        let ratio = noise(&there) / least;
        println!("{method:?} {}: noise {ratio:.2} of that here", far.name);
        assert!(ratio < MOST, "{}: {ratio:.2} times the noise", far.name);
        assert!(ratio > 1.0 / MOST, "{}: {ratio:.2} times the noise: another picture?", far.name);
        // a wide floor hides a little of the sky below, and perspective moves the ball's outline
        let found = there.region(|_, _| true);
        let off = (found.mean / mean.mean - 1.0).abs();
        assert!(
            off < power + 5.0 * (found.error + mean.error) / mean.mean,
            "{}: mean off by {off}",
            far.name
        );
    }
}

/// Theory: the error stated after 16 passes is at least the true error for nine of ten seeds,
/// wherever the camera stands and whatever is distant. The reference has six times the photons in
/// discs a tenth as wide.
#[test]
fn promises_with_distant_objects() {
    let distant = [HERE].into_iter().chain(far());
    for (far, near) in distant.flat_map(|far| [(far, SUN), (far, LAMP_AND_SKY)]) {
        let loaded = parse(&scene(&far, near));
        let exact = RenderSettings { passes: 12, photons: 1 << 17, ..settings(0.01) };
        let halves =
            [900, 901].map(|seed| render(&loaded, &RenderSettings { seed, ..exact.clone() }));
        let truth = NoisyTruth::Halves(halves);
        let packed = prepare(&loaded, SIZE, SIZE).unwrap();
        let promise = |seed| {
            let settings = RenderSettings {
                seed,
                photons: 1 << 14,
                radius: Radius::Pixels(2.0),
                ..RenderSettings::default()
            };
            let mut engine = CpuEngine::new(packed.clone(), Plan::probed(&packed, &settings));
            promises(&mut engine, &truth, &[16]).unwrap().remove(0)
        };
        let found: Vec<Promise> = (0..10).map(promise).collect();
        let kept = found.iter().filter(|promise| promise.kept()).count();
        let ratio = found.iter().map(|p| p.said.stated / p.truth).sum::<f64>() / 10.0;
        println!(
            "{}: {kept} of 10 kept, stated over true {ratio:.2}, true {:.4}",
            far.name, found[0].truth
        );
        assert!(kept >= 9, "{}: {found:?}", far.name);
        // an estimate that is always too large would be useless
        assert!(ratio < 4.0, "{}: {ratio}", far.name);
    }
}
