//! Convergence of the global rule: variance as N^-alpha, squared bias as N^-2(1 - alpha) (Knaus &
//! Zwicker 2011).

use std::f64::consts::PI;

use caustica::low_level::plan::global_scale_sq;
use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::lab::*;

const ALBEDO: f64 = 0.5;
const HEIGHT: f64 = 0.5;
/// Pass counts at which the image is evaluated.
const COUNTS: [u32; 6] = [8, 16, 32, 64, 128, 256];

/// A floor under a point light, with one fixed visible point per pixel.
fn scene(fov: f64, size: u32) -> String {
    Camera { position: DVec3::new(0.0, 1.4, 0.4), target: DVec3::ZERO, fov, size }.toml()
        + &format!(
            "[materials.floor]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 2\n\
             material = \"floor\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {HEIGHT}, 0]\nintensity = 1\n"
        )
}

/// `RUNS` pictures at each of [`COUNTS`].
fn pictures(text: &str, alpha: f64, radius: f64, photons: u32) -> Vec<Runs> {
    let scene = parse(text);
    let mut all = COUNTS.map(|_| Runs { size: scene.film.width, pixels: Vec::new() });
    let common = RenderSettings {
        method: Method::Ppm,
        eye_samples: 1,
        direct: Direct::Photons,
        radius_rule: RadiusRule::Global,
        alpha,
        photons,
        ..settings(radius)
    };
    let prepared = Prepared::new(&scene, &common);
    for seed in 0..RUNS {
        let settings = RenderSettings { seed, ..common.clone() };
        for (runs, picture) in all.iter_mut().zip(prepared.snapshots(&settings, &COUNTS)) {
            runs.pixels.push(grey(&picture));
        }
    }
    all.into()
}

/// Slope of a straight line through (ln x, ln y).
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (mx, my) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let sxy: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    let sxx: f64 = logs.iter().map(|(x, _)| (x - mx).powi(2)).sum();
    sxy / sxx
}

/// [`slope`] of `figure` of all runs, and its standard error by leaving out one run at a time
/// (jackknife).
fn fitted(runs: usize, figure: impl Fn(u32, Option<usize>) -> f64) -> Estimate {
    let fit = |left_out| {
        let points: Vec<(f64, f64)> =
            COUNTS.iter().map(|&n| (f64::from(n), figure(n, left_out))).collect();
        slope(&points)
    };
    let parts: Vec<f64> = (0..runs).map(|k| fit(Some(k))).collect();
    let k = runs as f64;
    let middle = parts.iter().sum::<f64>() / k;
    let spread = parts.iter().map(|p| (p - middle).powi(2)).sum::<f64>();
    Estimate { mean: fit(None), error: ((k - 1.0) / k * spread).sqrt() }
}

/// Mean of a function of the squared radius, relative to the start, over the first `n` passes.
fn means(n: u32, alpha: f64, of: impl Fn(f64) -> f64) -> f64 {
    (1..=n).map(|i| of(global_scale_sq(u64::from(i), alpha))).sum::<f64>() / f64::from(n)
}

/// Compares with the slope of the exact curve at these counts, and limits its distance from the
/// asymptotic slope.
fn assert_slope(what: &str, found: Estimate, exact: f64, limit: f64) {
    println!(
        "{what}: slope {:.3} +- {:.3}, exact {exact:.3}, in the limit {limit:.3}",
        found.mean, found.error
    );
    assert!((exact - limit).abs() < 0.1, "{what}: the counts are too small for the limit");
    assert!(found.admits(exact, 0.0), "{what}: {found:?}, exact {exact}");
    // the test rejects the other law and a fixed radius
    assert!(5.0 * found.error < 0.2, "{what}: too noisy, {found:?}");
}

/// Theory: under a point light at height h the mean irradiance over a disc of radius r below it is
/// E(r) = (2 I / r^2) (1 - h / sqrt(h^2 + r^2)), and E(0) = I / h^2. So the bias after N passes is
/// the mean of E(r_i) - E(0), which falls as N^-(1 - alpha).
#[test]
fn bias_of_the_global_rule() {
    const RADIUS: f64 = 0.22;
    const ALPHA: f64 = 0.8;
    let found = pictures(&scene(0.5, 4), ALPHA, RADIUS, 1 << 13);
    let disc = |scale_sq: f64| {
        let r2 = RADIUS * RADIUS * scale_sq;
        2.0 / r2 * (1.0 - HEIGHT / (HEIGHT * HEIGHT + r2).sqrt())
    };
    let at_point = 1.0 / (HEIGHT * HEIGHT);
    let bias = |n: u32| means(n, ALPHA, disc) - at_point;
    for (runs, n) in found.iter().zip(COUNTS) {
        let truth = ALBEDO / PI * (at_point + bias(n));
        assert_agrees(&format!("{n} passes"), runs.region(|_, _| true), truth, 0.06);
    }
    let figure = |n: u32, left_out: Option<usize>| {
        let runs = &found[COUNTS.iter().position(|c| *c == n).expect("a count")];
        let kept: Vec<f64> = (0..runs.pixels.len())
            .filter(|k| Some(*k) != left_out)
            .map(|k| runs.pixels[k].iter().sum::<f64>() / runs.pixels[k].len() as f64)
            .collect();
        (kept.iter().sum::<f64>() / kept.len() as f64 * PI / ALBEDO - at_point).powi(2)
    };
    let exact: Vec<(f64, f64)> = COUNTS.iter().map(|n| (f64::from(*n), bias(*n).powi(2))).collect();
    let fit = fitted(found[0].pixels.len(), figure);
    assert_slope("squared bias", fit, slope(&exact), -2.0 * (1.0 - ALPHA));
}

/// Theory: the variance of one pass is proportional to 1 / r_i^2, so that of the mean of N passes
/// is sum 1 / r_i^2 over N^2, which falls as N^-alpha.
#[test]
fn variance_of_the_global_rule() {
    const ALPHA: f64 = 2.0 / 3.0;
    let found = pictures(&scene(30.0, 16), ALPHA, 0.03, 1 << 11);
    let figure = |n: u32, left_out: Option<usize>| {
        let runs = &found[COUNTS.iter().position(|c| *c == n).expect("a count")];
        let kept: Vec<&Vec<f64>> = (0..runs.pixels.len())
            .filter(|k| Some(*k) != left_out)
            .map(|k| &runs.pixels[k])
            .collect();
        let count = kept.len() as f64;
        (0..runs.pixels[0].len())
            .map(|i| {
                let mean = kept.iter().map(|p| p[i]).sum::<f64>() / count;
                kept.iter().map(|p| (p[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
            })
            .sum::<f64>()
    };
    let exact: Vec<(f64, f64)> = COUNTS
        .iter()
        .map(|n| (f64::from(*n), means(*n, ALPHA, |s| 1.0 / s) / f64::from(*n)))
        .collect();
    let fit = fitted(found[0].pixels.len(), figure);
    assert_slope("variance", fit, slope(&exact), -ALPHA);
}
