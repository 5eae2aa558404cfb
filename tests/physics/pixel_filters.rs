//! Pixel filters: densities and weights of their samples, and their images.

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::Engine;
use caustica::low_level::kernels::eye_trace::eye_trace;
use caustica::low_level::math::pixel_filter::{
    in_lobe, sample_box, sample_cubic, sample_gaussian, sample_tent,
};
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use caustica::low_level::scene::{Aovs, Film};
use glam::Vec2;

use super::lab::*;

/// The filter of Mitchell & Netravali 1988, eq. 8.
fn cubic(x: f64, b: f64, c: f64) -> f64 {
    let x = x.abs();
    let value = if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x * x + 6.0
            - 2.0 * b
    } else if x < 2.0 {
        (-b - 6.0 * c) * x.powi(3)
            + (6.0 * b + 30.0 * c) * x * x
            + (-12.0 * b - 48.0 * c) * x
            + 8.0 * b
            + 24.0 * c
    } else {
        0.0
    };
    value / 6.0
}

/// Integral of `f` from `a` to `b`, by Simpson's rule.
fn integral(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 2000;
    let h = (b - a) / f64::from(n);
    let weight = |k: i32| if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
    (0..=n).map(|k| weight(k) * f(a + h * f64::from(k))).sum::<f64>() * h / 3.0
}

/// Half the integral of six times the cubic filter's absolute value, which the tables hold.
fn half(b: f64, c: f64) -> f64 {
    6.0 * integral(0.0, 2.0, |x| cubic(x, b, c).abs())
}

/// Largest difference between the distribution of `sample` and that of the density `f` on
/// [-reach, reach].
fn off(sample: impl Fn(f32) -> f32, reach: f64, f: impl Fn(f64) -> f64) -> f64 {
    let whole = integral(-reach, reach, &f);
    let n = 200;
    (0..n)
        .map(|k| {
            let u = (f64::from(k) + 0.5) / f64::from(n);
            (integral(-reach, f64::from(sample(u as f32)), &f) / whole - u).abs()
        })
        .fold(0.0, f64::max)
}

/// Theory: the sample for u is where the cumulative distribution of |filter| is u.
#[test]
fn samples_have_the_density_of_the_filter() {
    let boxes = off(|u| sample_box(u, 1.5), 1.5, |_| 1.0);
    let tents = off(|u| sample_tent(u, 1.25), 1.25, |x| 1.25 - x.abs());
    assert!(boxes < 1e-4 && tents < 1e-4, "{boxes} {tents}");
    let third = 1.0 / 3.0;
    for (b, c) in [(third, third), (1.0, 0.0), (0.0, 0.5), (0.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let sample = |u| sample_cubic(u, b as f32, c as f32, half(b, c) as f32);
        let found = off(sample, 2.0, |x| cubic(x, b, c).abs());
        assert!(found < 2e-4, "{b} {c}: {found}");
    }
    // a filter that is off by a hundredth is noticed
    assert!(off(|u| sample_tent(u, 1.2625), 1.25, |x| (1.25 - x.abs()).max(0.0)) > 1e-3);
}

/// Theory: the weights have the mean one, and weighted second moments are those of the filter:
/// b / 3 for the cubics with b + 2 c = 1, among them the B-spline, radius^2 / 6 for the tent, and
/// sigma^2 (1 - k e^-k / (1 - e^-k)) with k = radius^2 / (2 sigma^2) for the Gaussian in a circle.
#[test]
fn moments() {
    let n = 4096;
    let mean = |f: &dyn Fn(f32) -> f64| {
        (0..n).map(|k| f((k as f32 + 0.5) / n as f32)).sum::<f64>() / f64::from(n)
    };
    let third = 1.0 / 3.0;
    for (b, c, second) in [(third, third, third * third), (0.0, 0.5, 0.0), (1.0, 0.0, third)] {
        let whole = half(b, c) as f32;
        let weight = |u| f64::from(whole) / 3.0 * if in_lobe(u, whole) { -1.0 } else { 1.0 };
        let x = |u| f64::from(sample_cubic(u, b as f32, c as f32, whole));
        let found =
            [mean(&weight), mean(&|u| weight(u) * x(u)), mean(&|u| weight(u) * x(u) * x(u))];
        for (found, truth) in found.into_iter().zip([1.0, 0.0, second]) {
            assert!((found - truth).abs() < 2e-3, "{b} {c}: {found}, {truth}");
        }
    }
    let tent = mean(&|u| f64::from(sample_tent(u, 1.5)).powi(2));
    assert!((tent - 1.5 * 1.5 / 6.0).abs() < 1e-3, "{tent}");
    let (sigma, radius) = (0.7f64, 1.4f64);
    let k = 0.5 * (radius / sigma).powi(2);
    let inside = 1.0 - (-k).exp();
    let truth = sigma * sigma * (1.0 - k * (-k).exp() / inside);
    let sample = |u: f32, v: f32| sample_gaussian(Vec2::new(u, v), sigma as f32, inside as f32);
    let along = mean(&|u| {
        (0..16).map(|v| f64::from(sample(u, (v as f32 + 0.5) / 16.0).x).powi(2)).sum::<f64>() / 16.0
    });
    assert!((along - truth).abs() < 1e-3, "{along}, {truth}");
    let farthest = f64::from(sample(1.0 - 1.0 / 16_777_216.0, 0.3).length());
    assert!((farthest - radius).abs() < 1e-3, "{farthest}");
}

const FILTERS: [&str; 5] = [
    "\"box\"",
    "{ type = \"box\", radius = 1.25 }",
    "\"tent\"",
    "{ type = \"gaussian\", sigma = 0.6, radius = 1.5 }",
    "\"mitchell\"",
];

/// Share of a filter on the side x < `edge` of a vertical edge.
fn response(filter: &str, edge: f64) -> f64 {
    let share = |reach: f64, f: &dyn Fn(f64) -> f64| {
        integral(-reach, edge.clamp(-reach, reach), f) / integral(-reach, reach, f)
    };
    match filter {
        "\"box\"" => share(0.5, &|_| 1.0),
        "\"tent\"" => share(1.0, &|x| 1.0 - x.abs()),
        "\"mitchell\"" => share(2.0, &|x| cubic(x, 1.0 / 3.0, 1.0 / 3.0)),
        other if other.contains("box") => share(1.25, &|_| 1.0),
        _ => {
            // the profile across a circle
            let profile = |x: f64| {
                let reach = (1.5f64 * 1.5 - x * x).max(0.0).sqrt();
                let across = integral(0.0, reach, |y| (-0.5 * (y / 0.6).powi(2)).exp());
                (-0.5 * (x / 0.6).powi(2)).exp() * across
            };
            share(1.5, &profile)
        }
    }
}

/// A wall that emits left of x = 0.75, seen by an orthographic camera with one pixel per unit,
/// whose column x begins at x - 8.
fn edge(filter: &str) -> String {
    format!(
        "version = 1\n[camera]\ntype = \"orthographic\"\nposition = [0, 0, 1]\n\
         target = [0, 0, 0]\nsize = 16\n\
         [film]\nwidth = 16\nheight = 16\nfilter = {filter}\n[materials.m]\ntype = \"diffuse\"\n\
         reflectance = 0.0\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-30.25, -40, 0]\nu = [31, 0, 0]\n\
         v = [0, 80, 0]\n\
         material = \"m\"\nemission = 1.0\n"
    )
}

fn with(method: Method, passes: u32) -> RenderSettings {
    RenderSettings { method, passes, eye_samples: 64, photons: 64, ..settings(0.1) }
}

/// Theory: a column at the distance d from an edge shows the integral of the filter up to d, which
/// is negative or above one next to the edge for a filter with negative lobes.
#[test]
fn edges_spread_by_the_profile() {
    let mut overshoot = 0.0f64;
    for filter in FILTERS {
        for (method, passes, bound) in
            [(Method::Path, 256, 0.01), (Method::Sppm, 256, 0.01), (Method::Ppm, 1, 0.03)]
        {
            let picture = grey(&render(&parse(&edge(filter)), &with(method, passes)));
            for column in 0..16 {
                let found = (0..16).map(|row| picture[row * 16 + column]).sum::<f64>() / 16.0;
                let truth = response(filter, 0.75 - (column as f64 - 7.5));
                overshoot = overshoot.max(truth - 1.0);
                assert!(
                    (found - truth).abs() < bound,
                    "{filter}, {method:?}, column {column}: {found}, {truth}"
                );
            }
        }
    }
    assert!(overshoot > 0.01, "{overshoot}");
}

/// Theory: every filter integrates to one, so a constant image stays constant: exactly for filters
/// without negative lobes and, since their weights are divided by their mean, for fixed visible
/// points. Fresh points with signed weights approach it like the share of a region of the unit
/// square that Sobol points fill, faster than independent ones.
#[test]
fn constants_stay_constant() {
    for filter in FILTERS {
        for (method, passes) in [(Method::Path, 256), (Method::Sppm, 64), (Method::Ppm, 1)] {
            let text = format!(
                "version = 1\n[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 40\n\
                 [film]\nwidth = 16\n\
                 height = 16\nfilter = {filter}\n[environment]\nradiance = 2.0\n"
            );
            let picture = grey(&render(&parse(&text), &with(method, passes)));
            let signed = filter.contains("mitchell") && method != Method::Ppm;
            let worst = picture.iter().map(|p| (0.5 * p - 1.0).abs()).fold(0.0, f64::max);
            let square = picture.iter().map(|p| (0.5 * p - 1.0).powi(2)).sum::<f64>() / 256.0;
            println!(
                "{filter} {method:?}: worst pixel {worst:.1e}, root mean {:.1e}",
                square.sqrt()
            );
            if !signed {
                assert!(worst < 1e-6, "{filter}, {method:?}: {worst}");
                continue;
            }
            // a weight z or -z of mean one has the variance z^2 - 1
            let variance = (half(1.0 / 3.0, 1.0 / 3.0) / 3.0).powi(4) - 1.0;
            let share = square / (variance / f64::from(passes));
            assert!(share < 0.4, "{method:?}: {share} of the variance of independent points");
        }
    }
}

/// Theory: what a visible point gathers has the same weight as the light that it sees: here the
/// reflectance over pi times a weight of mean one, negative in a lobe.
#[test]
fn photons_have_the_weights() {
    let text = "version = 1\n[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 40\n\
                [film]\nwidth = 32\n\
                height = 32\nfilter = \"mitchell\"\n[materials.m]\ntype = \"diffuse\"\n\
                reflectance = 0.5\n\
                [[shapes]]\ntype = \"rectangle\"\norigin = [-9, -9, 0]\nu = [18, 0, 0]\n\
                v = [0, 18, 0]\n\
                material = \"m\"\n[[lights]]\ntype = \"point\"\nposition = [0, 0, 2]\n\
                intensity = 1.0\n";
    let settings = RenderSettings { photons: 64, ..settings(0.1) };
    let packed = prepare(&parse(text), 32, 32).unwrap();
    let plan = Plan::probed(&packed, &settings);
    let weights: Vec<f64> = (0..16)
        .map(|pass| plan.dispatch(pass))
        .flat_map(|dispatch| (0..1024).map(move |id| (dispatch, id)))
        .map(|(dispatch, id)| eye_trace(&packed.tables, &dispatch, false, id).0.weight)
        .map(|weight| f64::from(weight.x) * std::f64::consts::PI / 0.5)
        .collect();
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    let size = (half(1.0 / 3.0, 1.0 / 3.0) / 3.0).powi(2);
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
    assert!(weights.iter().all(|weight| (weight.abs() - size).abs() < 1e-4), "{size}");
    assert!(weights.iter().any(|weight| *weight < 0.0));
}

/// A floor with a mirror under a lamp.
fn room(filter: &str) -> String {
    format!(
        "version = 1\n[camera]\nposition = [0, 1.5, 2]\ntarget = [0, 0, 0]\nfov = 50\n[film]\n\
         width = 16\nheight = 12\n\
         filter = {filter}\n[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[materials.c]\n\
         type = \"mirror\"\n\
         reflectance = 0.9\n[[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\n\
         v = [0, 0, -4]\n\
         material = \"m\"\n[[shapes]]\ntype = \"sphere\"\ncenter = [0.3, 0.3, 0]\nradius = 0.3\n\
         material = \"c\"\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-0.5, 1.2, -0.5]\nu = [1, 0, 0]\n\
         v = [0, 0, 1]\nmaterial = \"m\"\n\
         emission = 3.0\n"
    )
}

/// Theory: each pixel draws its own samples, also beyond the image's edge, so a crop has the bits
/// of the same part of the whole image.
#[test]
fn crops_have_the_same_bits() {
    for filter in FILTERS {
        let scene = parse(&room(filter));
        let settings = RenderSettings { passes: 2, photons: 500, ..settings(0.1) };
        let packed = prepare(&scene, 16, 12).unwrap();
        let picture = |film: &Film| {
            let mut engine =
                CpuEngine::new(packed.clone(), Plan::probed(&packed, &settings).on(film));
            for _ in 0..2 {
                engine.pass().unwrap();
            }
            engine.picture().unwrap()
        };
        let whole = picture(&scene.film);
        let crop = picture(&Film { window: Some([3, 2, 9, 8]), ..scene.film });
        for (i, found) in crop.rgb.iter().enumerate() {
            let (x, y) = (3 + i % 6, 2 + i / 6);
            assert_eq!(*found, whole.rgb[y * 16 + x], "{filter}: {x} {y}");
        }
    }
}

/// Theory: light that arrives directly, direct light, caustics and indirect light add up to the
/// image, so each of these layers has the image's weights.
#[test]
fn layers_add_up_with_signed_weights() {
    for (method, direct) in [(Method::Sppm, Direct::Sampled), (Method::Ppm, Direct::Photons)] {
        let mut scene = parse(&room("\"mitchell\""));
        scene.film.aovs = Aovs::parse("all").unwrap();
        let settings =
            RenderSettings { direct, method, eye_samples: 5, photons: 4000, ..settings(0.2) };
        let packed = prepare(&scene, 16, 12).unwrap();
        let plan = Plan::probed(&packed, &settings).on(&scene.film);
        let mut engine = CpuEngine::new(packed, plan);
        for _ in 0..3 {
            engine.pass().unwrap();
        }
        let picture = engine.picture().unwrap();
        let layers = engine.layers().unwrap();
        let red = ["emission.R", "direct.R", "caustic.R", "indirect.R"]
            .map(|name| layers.iter().find(|layer| layer.name == name).unwrap());
        let mut negative = false;
        for (i, pixel) in picture.rgb.iter().enumerate() {
            let sum: f64 = red.iter().map(|layer| layer.plane.values[i]).sum();
            negative |= red.iter().any(|layer| layer.plane.values[i] < 0.0);
            let scale = red.iter().map(|layer| layer.plane.values[i].abs()).sum::<f64>();
            assert!(
                (sum - f64::from(pixel[0])).abs() < 1e-4 * scale + 1e-5,
                "{method:?} {i}: {sum} {pixel:?}"
            );
        }
        assert!(negative || method == Method::Ppm, "some weight is negative");
    }
}
