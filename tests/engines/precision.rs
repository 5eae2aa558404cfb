//! The CPU engine in f64 against reference images, against the engine in f32, and against exact
//! answers.
//!
//! Theory: both engines share one source and the same random numbers. So their images differ by
//! rounding: by about 1e-7 relative per operation in nearly every pixel, and by a whole path's
//! light in the few pixels where rounding changed a decision (an edge hit, a roulette, a photon
//! inside the disc). The median over pixels measures the first, the mean over the image the second.

use caustica::low_level::device::Wanted;
use caustica::low_level::film::metrics::{Comparison, compare};
use caustica::low_level::film::{Picture, luminance};
use caustica::low_level::scene::settings::{Direct, Method, Radius, RenderSettings};
use caustica::low_level::scene::{self, Scene};
use caustica::low_level::validation::{BlockTruth, hold, render_parts};

use crate::support::{data, render_on, shipped as shipped_scene};

/// Largest median difference over pixels.
const MEDIAN: f64 = 5e-5;
/// Largest difference of the means in a channel.
const MEAN: f64 = 2e-3;

/// The same under a sky: there are few passes, and light from far away arrives in bright photons
/// whose paths a rounding can separate. After 200 passes the means differ by 1e-4.
const MEAN_UNDER_SKY: f64 = 2e-2;

/// Compares f32 with f64.
fn cost(scene: &Scene, settings: &RenderSettings, of: impl Fn(Picture) -> Picture) -> Comparison {
    let double = render_on(&Wanted::CpuDouble, scene, settings);
    compare(&of(render_on(&Wanted::Cpu, scene, settings)), &double).unwrap()
}

fn rounding_alone(c: &Comparison) -> bool {
    c.median <= MEDIAN && c.mean_error() <= MEAN
}

fn shipped(name: &str) -> (Scene, RenderSettings) {
    let mut loaded = scene::load(shipped_scene(&format!("{name}.toml")).as_ref()).unwrap();
    let film = &mut loaded.scene.film;
    (film.width, film.height) = (80, 80 * film.height / film.width);
    (loaded.scene, RenderSettings { passes: 3, photons: 30_000, eye_samples: 2, ..loaded.settings })
}

#[test]
fn f64_agrees_with_the_truth() {
    let mut scene = scene::load(&data("reference/cornell.toml")).unwrap().scene;
    let truth = BlockTruth::read(&data("truth/cornell.exr")).unwrap();
    let size = (truth.mean.width, truth.mean.height);
    (scene.film.width, scene.film.height) = (2 * size.0, 2 * size.1);
    let settings = RenderSettings {
        passes: 4,
        photons: 16_384,
        radius: Radius::Pixels(0.5),
        ..RenderSettings::default()
    };
    let mut rendered = render_parts(&Wanted::CpuDouble, &scene, &settings, 16, size).unwrap();
    let a = hold(&rendered.parts, &truth, 0.01);
    println!("mean {:?} +- {:?}, worst block {}", a.mean_ratio, a.ratio_error, a.blocks.worst());
    assert!(a.faults().is_empty(), "{:?}", a.faults());
    // 5 % more light is detected.
    for rgb in rendered.parts.iter_mut().flat_map(|part| &mut part.rgb) {
        *rgb = rgb.map(|value| 1.05 * value);
    }
    assert!(hold(&rendered.parts, &truth, 0.01).faults().contains(&"mean"));
}

#[test]
fn shipped_scenes_differ_by_rounding() {
    for name in
        ["caustics", "cornell", "depth-of-field", "soft-shadows", "still-life", "water-drop"]
    {
        let (scene, settings) = shipped(name);
        for method in [Method::Sppm, Method::Ppm, Method::Path] {
            let c = cost(&scene, &RenderSettings { method, ..settings.clone() }, |picture| picture);
            println!("{name} {method:?}: median {:.1e}, means {:.1e}", c.median, c.mean_error());
            let most = if scene.environment.is_some() { MEAN_UNDER_SKY } else { MEAN };
            assert!(c.median <= MEDIAN && c.mean_error() <= most, "{name} {method:?}: {c:?}");
            // Identical bits would mean that both are the same engine.
            assert!(2 * c.pixels_differing > c.pixels, "{name} {method:?}: {c:?}");
        }
    }
}

/// The comparison rejects one part in a thousand more light everywhere, more in a corner, and other
/// random numbers.
#[test]
fn the_comparator_sees_planted_errors() {
    let (scene, settings) = shipped("cornell");
    let brighter = |share: f32, rows: usize| {
        move |mut picture: Picture| {
            let pixels = rows * picture.width as usize;
            picture.rgb[..pixels].iter_mut().flatten().for_each(|value| *value *= 1.0 + share);
            picture
        }
    };
    assert!(rounding_alone(&cost(&scene, &settings, brighter(0.0, 80))));
    assert!(!rounding_alone(&cost(&scene, &settings, brighter(0.001, 80))));
    assert!(!rounding_alone(&cost(&scene, &settings, brighter(0.1, 20))));
    let double = render_on(&Wanted::CpuDouble, &scene, &settings);
    let other = render_on(&Wanted::Cpu, &scene, &RenderSettings { seed: 1, ..settings });
    assert!(!rounding_alone(&compare(&other, &double).unwrap()));
}

/// Theory: a floor under a spherical lamp of radius r at distance d receives `pi L (r / d)^2`, so
/// its radiance is `reflectance L (r / d)^2`, less 3.4e-5 because the image shows some floor around
/// the centre.
#[test]
fn a_small_lamp_loses_no_light() {
    let d = 9.0;
    for r in [0.3, 0.03, 0.003, 9e-5] {
        let text = format!(
            r#"
            version = 1
            camera = {{ position = [0.0, 3.0, 0.01], target = [0.0, 0.0, 0.0], fov = 2.0 }}
            film = {{ width = 32, height = 32 }}
            materials.floor = {{ type = "diffuse", reflectance = 0.5 }}
            materials.black = {{ type = "diffuse", reflectance = 0.0 }}
            shapes = [
                {{ type = "rectangle", origin = [-1.0, 0.0, 1.0], u = [2.0, 0.0, 0.0], v = [0.0, 0.0, -2.0], material = "floor" }},
                {{ type = "sphere", center = [0.0, {d:?}, 0.0], radius = {r:?}, material = "black", emission = 100.0 }},
            ]"#
        );
        let scene = scene::parse("lamp.toml".as_ref(), text.as_bytes()).unwrap().scene;
        let settings = RenderSettings {
            passes: 16,
            photons: 1,
            direct: Direct::Sampled,
            ..RenderSettings::default()
        };
        for device in [Wanted::Cpu, Wanted::CpuDouble] {
            let picture = render_on(&device, &scene, &settings);
            let mean = picture.rgb.iter().map(|rgb| luminance(*rgb)).sum::<f64>()
                / picture.rgb.len() as f64;
            let ratio = mean / (0.5 * 100.0 * (r / d) * (r / d));
            println!("{device:?}, r = {r}: {ratio}");
            assert!((ratio - 1.0 + 3.4e-5).abs() < 3e-6, "{device:?}, r = {r}: {ratio}");
        }
    }
}

/// One problem in both precisions, with inputs and answers that both represent exactly.
macro_rules! problems {
    ($name:ident, $core:path) => {
        mod $name {
            use bytemuck::Zeroable;
            use caustica::low_level::accel::profile::Placement;
            use core::accel::revolution::{Attributes, RevolutionTables};
            use core::real::{Real, Vec3};
            use core::shapes::ray::{Hit, Ray};
            use core::shapes::revolution::intersect_patch;
            use core::shapes::sphere::intersect_sphere;
            use core::tables::Sphere;
            use glam::DVec2;
            use $core as core;

            /// First hit with a surface of revolution.
            fn revolution(profile: &[[f64; 2]], origin: Vec3, direction: Vec3) -> f64 {
                let mut tables = RevolutionTables::default();
                let points = profile.iter().map(|p| DVec2::from(*p)).collect();
                tables.push(&[points], &Placement::default(), Attributes::default()).unwrap();
                let hits = tables.patches.iter().map(|patch| {
                    let points = &tables.profile_points;
                    intersect_patch(
                        points,
                        &tables.revolutions[0],
                        patch,
                        origin,
                        direction,
                        0.0,
                        1e4,
                    )
                    .t
                });
                hits.fold(Real::MAX, Real::min) as f64
            }

            /// A ray that grazes the cylinder of radius one at 1 - 2^-20 from its axis.
            pub fn grazed_cylinder() -> f64 {
                let origin = Vec3::new(1.0 - (0.5 as Real).powi(20), 0.25, 4.0);
                4.0 - revolution(&[[1.0, -1.0], [1.0, 1.0]], origin, Vec3::NEG_Z)
            }

            /// A ray that grazes the paraboloid y = r^2 / 4, level at y = 1/4.
            pub fn grazed_paraboloid() -> f64 {
                let origin = Vec3::new(1.0 - (0.5 as Real).powi(20), 0.25, 4.0);
                4.0 - revolution(&[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]], origin, Vec3::NEG_Z)
            }

            /// A ray of length `5 scale` to the point (3, -1) on a sphere of radius 5 about (0,
            /// -5).
            pub fn sphere(scale: f64) -> f64 {
                let s = scale as Real;
                let ball = Sphere {
                    normal: Vec3::Y,
                    curvature: 1.0 / (5.0 * s),
                    radius: 5.0 * s,
                    ..Sphere::zeroed()
                };
                let origin = Vec3::new(0.0, 3.0 * s, 0.0);
                let ray =
                    Ray { origin, t_min: 0.0, direction: Vec3::new(0.6, -0.8, 0.0), t_max: 1e30 };
                let mut hit = Hit::none(&ray);
                intersect_sphere(&ball, 0, &ray, &mut hit);
                hit.t as f64 / scale
            }
        }
    };
}
problems!(single, caustica::low_level);
problems!(double, caustica::low_level::double);

/// Theory: at 1 - e from the axis half the chord is sqrt(2 e - e^2), and an error x in the distance
/// from the axis becomes x / sqrt(2 e) in the chord: 724 roundings. The sphere's legs are 3, 4, 5.
#[test]
fn f64_is_nearer_to_exact_answers() {
    let e = 0.5_f64.powi(20);
    let half = (2.0 * e - e * e).sqrt();
    let answers = [
        ("cylinder", single::grazed_cylinder(), double::grazed_cylinder(), half, 724.0),
        ("paraboloid", single::grazed_paraboloid(), double::grazed_paraboloid(), half, 724.0),
        ("sphere", single::sphere(1.0), double::sphere(1.0), 5.0, 5.0),
        ("sphere of radius 5e6", single::sphere(1048576.0), double::sphere(1048576.0), 5.0, 5.0),
    ];
    for (name, single, double, exact, condition) in answers {
        let (f32_error, f64_error) = ((single - exact).abs(), (double - exact).abs());
        println!("{name}: f32 off by {f32_error:.1e}, f64 by {f64_error:.1e}");
        // A few roundings of 1.1e-16 each, a bound that the f32 result must exceed.
        let bound = 64.0 * 1.1e-16 * condition;
        assert!(f64_error < bound, "{name}: {double} {exact}");
        assert!(f32_error > bound, "{name}: f32 is as exact as f64");
    }
}
